"""Two forces with the same digest compile to the same code; what numba freezes into it is part of the digest."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from types import ModuleType

import mujoco
import numba
import numpy as np
import pytest

from cube_sim.native.fingerprint import fingerprint

SCALE = 2.0
TABLE = np.arange(4.0)
settings = ModuleType("settings")
vars(settings)["gain"] = 3.0


@numba.njit
def doubled(x):
    return SCALE * x


def force(x, offset=1.0):
    def inner(y):
        return y + TABLE[1]

    return doubled(x) + offset + math.sin(inner(x)) + np.sum(TABLE) + settings.gain


def made(constant):
    return lambda x: x + constant


def recursive(x):
    return recursive(x - 1.0) if x > 0.0 else doubled(0.0)


def changed(target, name, value):
    """A change of one thing outside, and of it alone."""

    def change(patch):
        patch.setattr(target, name, value) if not isinstance(target, dict) else patch.setitem(target, name, value)

    return change


@pytest.mark.parametrize(
    "change",
    [
        changed(globals(), "SCALE", 2.5),  # reached through a function it calls
        changed(globals(), "TABLE", np.array([0.0, 1.0, 2.0, 3.1])),
        changed(globals(), "TABLE", np.arange(4)),
        changed(globals(), "TABLE", np.arange(8.0)[::2]),
        changed(settings, "gain", 3.5),
        changed(force, "__defaults__", (2.0,)),
        changed(globals(), "doubled", numba.njit(fastmath=True)(doubled.py_func)),
        changed(globals(), "math", np),
    ],
    ids=["number", "value", "dtype", "layout", "module", "default", "option", "library"],
)
def test_what_is_frozen_is_in_the_digest(change, monkeypatch):
    before = fingerprint(force)
    assert before is not None
    assert before == fingerprint(force)
    change(monkeypatch)
    assert fingerprint(force) not in (before, None)


def test_an_array_changed_in_place():
    anchor = np.zeros(3)
    f = made(anchor)
    before = fingerprint(f)
    anchor[2] = -1e-12
    assert fingerprint(f) not in (before, None)


def test_closures_by_what_they_hold():
    assert fingerprint(made(1.0)) == fingerprint(made(1.0)) != fingerprint(made(1.5))
    assert fingerprint(made(1)) != fingerprint(made(1.0)) != fingerprint(made((1.0,)))
    assert fingerprint(made(True)) != fingerprint(made(1))
    assert fingerprint(recursive) is not None


def test_code_is_in_the_digest():
    assert fingerprint(lambda x: x + 1.0) == fingerprint(lambda x: x + 1.0) != fingerprint(lambda x: x + 2.0)
    assert fingerprint(lambda x: x + 1.0) != fingerprint(lambda x: x - 1.0)


@pytest.mark.parametrize("outside", [{"a": 1.0}, [1.0], mujoco.MjSpec(), np.random.default_rng(0), object()])
def test_what_nobody_can_tell_has_no_digest(outside):
    assert fingerprint(made(outside)) is None


def test_something_that_is_no_function_has_no_digest():
    class Force:
        def __call__(self, x):
            return x

    assert fingerprint(Force()) is None


def test_the_same_in_every_process():
    """Not a matter of addresses or of the order in which sets are walked."""
    program = "import test_fingerprint as t; print(t.fingerprint(t.force), t.fingerprint(t.recursive))"
    told = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.path.dirname(__file__)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(told) == 1
    assert "None" not in told.pop()
