"""Machine code kept on disk is used again, and never after what it was made from has changed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from numba import types

from cube_sim.native.compiled import compiled

INTRINSIC = """
from numba.core import types
from numba.extending import intrinsic

@intrinsic
def offset(typingctx):
    def codegen(context, builder, signature, args):
        return context.get_constant(types.float64, {offset})

    return types.float64(), codegen
"""
CALLEE = """
from cube_sim.native.compiled import compiled
from offset import offset

FACTOR = {factor}

@compiled
def inner(x):
    return {inner} + offset()
"""
MIDDLE = """
from callee import FACTOR, inner
from cube_sim.native.compiled import compiled

@compiled
def middle(x):
    return FACTOR * inner(x)
"""
CALLER = """
from cube_sim.native.compiled import compiled
from middle import middle

@compiled
def outer(x):
    return middle(x) + 1.0

print(outer(1.0), sum(outer.stats.cache_hits.values()))
"""


def printed(folder, package=Path(__file__).parents[2]):
    """What a fresh process says, with a cache of its own."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(folder / "cache"), "PYTHONPATH": str(package)}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    done = subprocess.run(
        [sys.executable, "caller.py"], cwd=folder, env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout.split()


def outer(folder, package=Path(__file__).parents[2]):
    """What a fresh process computes, and how many functions it took from the disk."""
    value, hits = printed(folder, package)
    return float(value), int(hits)


@pytest.mark.flight
def test_cached_code_follows_functions_constants_and_intrinsics_of_other_files(tmp_path):
    callee, offset = tmp_path / "callee.py", tmp_path / "offset.py"
    offset.write_text(INTRINSIC.format(offset=0.0))
    (tmp_path / "middle.py").write_text(MIDDLE)
    (tmp_path / "caller.py").write_text(CALLER)
    callee.write_text(CALLEE.format(factor=2.0, inner="x + 3.0"))
    assert outer(tmp_path) == (9.0, 0)
    assert outer(tmp_path) == (9.0, 1)
    callee.write_text(CALLEE.format(factor=2.0, inner="x + 4.00"))
    assert outer(tmp_path) == (11.0, 0)
    callee.write_text(CALLEE.format(factor=5.0, inner="x + 4.00"))
    assert outer(tmp_path) == (26.0, 0)
    offset.write_text(INTRINSIC.format(offset=1.0))
    assert outer(tmp_path) == (31.0, 0)


@pytest.mark.flight
def test_cached_code_follows_the_way_it_is_compiled(tmp_path):
    package, here = tmp_path / "package", Path(__file__).parents[2] / "cube_sim"
    (package / "cube_sim").mkdir(parents=True)
    shutil.copy(here / "__init__.py", package / "cube_sim")
    shutil.copytree(here / "native", package / "cube_sim" / "native", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "offset.py").write_text(INTRINSIC.format(offset=0.0))
    (tmp_path / "middle.py").write_text(MIDDLE)
    (tmp_path / "caller.py").write_text(CALLER)
    (tmp_path / "callee.py").write_text(CALLEE.format(factor=2.0, inner="x + 3.0"))
    assert outer(tmp_path, package) == (9.0, 0)
    assert outer(tmp_path, package) == (9.0, 1)
    compiled = package / "cube_sim" / "native" / "compiled.py"
    compiled.write_text(compiled.read_text().replace("fastmath=False", "fastmath=True "))
    assert outer(tmp_path, package) == (9.0, 0)


@compiled
def _added(x, step):
    return x + step


COUNTING = """
from cube_sim.native.compiled import compiled

@compiled
def added(x, step):
    return x + step

@compiled
def counted(n):
    total = 0
    for _ in range(n):  # `total` is the constant 0 until numba knows what is added
        total = added(total, 1)
        total = added(total, 2)
    return total

print(counted(4), counted.py_func(4), len(added.called().signatures))
"""


@pytest.mark.flight
def test_a_function_is_compiled_once_for_constants_and_variables(tmp_path):
    (tmp_path / "caller.py").write_text(COUNTING)
    assert printed(tmp_path) == ["12", "12", "1"]


@pytest.mark.flight
def test_what_compiled_code_calls_has_no_machine_code_of_its_own_and_is_kept_for_other_callers():
    again = compiled(_added.py_func)

    @compiled
    def twice(x):
        return again(again(x, 1.5), 0.5)

    assert twice(2.0) == 4.0
    assert not again.signatures
    once_more = compiled(_added.py_func)
    once_more.called().compile((types.float64, types.float64))
    assert sum(once_more.called().stats.cache_hits.values()) == 1
    assert not once_more.called().stats.cache_misses
