"""The key of machine code on disk covers every file the code comes from, found by following the imports."""

from __future__ import annotations

import json
import shutil

import pytest
from support.processes import printed_by

from cube_sim.native import object_cache
from cube_sim.native.sources import PACKAGE, source_digest, source_files
from cube_sim.vehicle.plugin import hook

CALLBACKS = "cube_sim.vehicle.plugin.callbacks"
COMPILED = (CALLBACKS, "cube_sim.vehicle.plugin.user_force_code", "cube_sim.native.object_cache")
LATER = {CALLBACKS: ["cube_sim.native.dispatching"]}
"""What their functions import when something is compiled."""


def names(files, package=PACKAGE):
    return {file.relative_to(package).as_posix() for file in files}


@pytest.fixture
def copy(tmp_path):
    """The package's sources, to be edited."""
    return shutil.copytree(PACKAGE, tmp_path / "cube_sim", ignore=shutil.ignore_patterns("__pycache__"))


@pytest.mark.parametrize("module", COMPILED)
def test_they_are_the_files_that_python_runs(module):
    program = """
import importlib, json, sys
for module in sys.argv[1:]:
    importlib.import_module(module)
print(json.dumps([m.__file__ for name, m in sys.modules.items() if name.partition(".")[0] == "cube_sim"]))
"""
    assert {str(file) for file in source_files(module)} == set(
        json.loads(printed_by(program, module, *LATER.get(module, ())))
    )


@pytest.mark.parametrize("module", COMPILED)
def test_an_edit_of_any_of_them_gives_another_key(module, copy):
    before = source_digest(module, copy)
    assert before == source_digest(module)
    for name in names(source_files(module)):
        content = (copy / name).read_bytes()
        (copy / name).write_bytes(content + b"# edited\n")
        assert source_digest(module, copy) != before, name
        (copy / name).write_bytes(content)
    assert before == source_digest(module, copy)


def test_an_edit_of_another_file_changes_nothing(copy):
    before = source_digest(CALLBACKS, copy)
    others = names(copy.rglob("*.py"), copy) - names(source_files(CALLBACKS))
    assert {"simulation.py", "vehicle/loading.py", "vehicle/mjcf/parameters.py"} <= others
    for name in others:
        (copy / name).write_text("import nothing_of_the_kind\n")
    assert source_digest(CALLBACKS, copy) == before


def test_the_water_is_named_by_it(monkeypatch):
    """And by the versions of what else has a part in its code."""
    keys = []
    monkeypatch.setattr(object_cache, "addresses", lambda key, build, roles: keys.append(key) or {})
    hook._callbacks.__wrapped__()
    assert source_digest(CALLBACKS) in keys[0]
    for target, name in ((hook, "source_digest"), (hook, "version"), (hook.mujoco, "__version__")):
        with monkeypatch.context() as patch:
            patch.setattr(target, name, "other" if name == "__version__" else lambda asked: "other")
            hook._callbacks.__wrapped__()
    assert len(set(keys)) == 4


def test_every_way_to_import_is_seen(tmp_path):
    ship = tmp_path / "ship"
    (ship / "deck").mkdir(parents=True)
    (ship / "__init__.py").write_text(
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from ship.unseen import x\n\n    import ship.unseen\n"
    )
    (ship / "deck" / "__init__.py").write_text("")
    (ship / "top.py").write_text(
        "import os, ship.mast as m, ship.sail\nimport numpy\n"
        "from ship.deck import (  # and why\n    rail,\n    cabin,\n)\n"
        "def late():\n    from ship.keel import (lead)\n"
    )
    (ship / "sail.py").write_text("from ship import top, rudder\nfrom ship.deck.rail import HEIGHT as h\n")
    for name in ("mast", "unseen", "keel", "rudder", "deck/rail", "deck/cabin", "deck/spare"):
        (ship / f"{name}.py").write_text("HEIGHT = 1.0\n")
    found = names(source_files("ship.top", ship), ship)
    assert found == {"__init__.py", "deck/__init__.py"} | {
        f"{name}.py" for name in ("top", "mast", "sail", "rudder", "keel", "deck/rail", "deck/cabin")
    }
    with pytest.raises(ModuleNotFoundError, match=r"holds ship\.hold"):
        source_digest("ship.hold", ship)
