"""Own code called package.module:name, flown again from its record alone, whatever lies on Python's path by then."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.scenario_files import FLIGHT

import cube_sim

LAW = """
import numpy as np
from .gains import KP
from beside import SCALE

def pid(setup):
    from mypkg.parts import late
    M = setup.dynamics.total_mass
    return lambda aim: np.asarray(late.ONE * SCALE * KP * (M @ aim.velocity_error))
"""
FILES = {
    "mypkg/__init__.py": "",
    "mypkg/law.py": LAW,
    "mypkg/gains.py": "KP = 2.0\n",
    "mypkg/unused.py": "KP = 3.0\n",
    "mypkg/parts/late.py": "ONE = 1.0\n",
    "beside.py": "SCALE = 1.5\n",
}
TAKEN = {f"python/modules/{name}" for name in {*FILES, "mypkg/parts/__init__.py"} - {"mypkg/unused.py"}}


@pytest.fixture
def place(tmp_path):
    lay(tmp_path / "pp", FILES)
    (tmp_path / "own.yaml").write_text(f"{FLIGHT}control: {{law: {{python: 'mypkg.law:pid'}}}}\n")
    return tmp_path


def lay(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def command(place: Path, *words: str, path: str = "") -> subprocess.CompletedProcess[str]:
    """A command in a process of its own, with a folder of the place on Python's path."""
    root = str(Path(cube_sim.__file__).parents[1])
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(place / path), root] if path else [root])}
    line = [sys.executable, "-m", "cube_sim", *words]
    return subprocess.run(line, cwd=place, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.flight
def test_a_package_is_flown_again_from_its_record_whatever_lies_on_pythons_path(place):
    run = command(place, "run", "own.yaml", "--out", "run", path="pp")
    assert "cannot be flown again" not in run.stdout + run.stderr
    recorded = cube_sim.load_run(place / "run")
    assert {name for name in recorded.header.inputs if name.startswith("python/modules/")} == TAKEN
    shutil.move(place / "pp", place / "gone")
    lay(place / "other", {**FILES, "mypkg/gains.py": "KP = 70.0\n", "beside.py": "SCALE = 80.0\n"})
    for path in ("", "other"):
        again = command(place, "replay", "run", path=path)
        assert (again.returncode, again.stdout[:9]) == (0, "identical"), again.stdout + again.stderr
    assert command(place, "export", "run", "inputs", "--format", "inputs").returncode == 0
    assert command(place, "run", "inputs/resolved.yaml", "--out", "next", path="other").returncode == run.returncode
    assert cube_sim.load_run(place / "next").header.inputs == recorded.header.inputs


@pytest.mark.flight
@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("import importlib\nimportlib.import_module('my' + 'pkg.gains')\n", "line 2 what its text does not name"),
        ("from mypkg import compiled\n", "mypkg.compiled is no text of Python: compiled.pyc"),
    ],
)
def test_what_cannot_be_taken_into_the_record_is_said_at_the_run_and_by_replay(place, text, reason):
    (place / "pp/mypkg/gains.py").write_text(f"{text}KP = 2.0\n")
    (place / "pp/compiled.py").write_text("")
    compiling = [sys.executable, "-c", "import py_compile; py_compile.compile('compiled.py', 'mypkg/compiled.pyc')"]
    subprocess.run(compiling, cwd=place / "pp", check=True)
    command(place, "run", "own.yaml", "--out", "run", path="pp")
    said = [line for line in cube_sim.load_run(place / "run").log if "cannot be flown again" in line.text]
    assert len(said) == 1
    assert said[0].level == "WARNING"
    assert reason in said[0].text
    again = command(place, "replay", "run", path="pp")
    assert again.returncode == 2
    assert reason in again.stderr


@pytest.mark.flight
def test_a_replay_leaves_the_modules_of_its_process_as_they_were(place, monkeypatch):
    monkeypatch.syspath_prepend(str(place / "pp"))
    cube_sim.run(place / "own.yaml", out=place / "run")
    before = sys.modules["mypkg.gains"]
    before.KP = 50.0
    from cube_sim.runs.replay import replay

    try:
        assert replay(cube_sim.load_run(place / "run")).identical
        assert sys.modules["mypkg.gains"] is before
        assert not any(type(finder).__module__.startswith("cube_sim") for finder in sys.meta_path)
    finally:
        for name in [name for name in sys.modules if name.split(".")[0] in ("mypkg", "beside")]:
            del sys.modules[name]
