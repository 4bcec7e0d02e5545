"""``cube-sim examples``: what it copies, what it refuses, and that a wheel holds the same."""

from __future__ import annotations

import tomllib
import zipfile

import pytest
from support.command_line import call
from support.places import MODEL_FILES, REPO

from cube_sim.commands.examples import SCENARIOS, copy_examples, example_files
from cube_sim.scenario import load


def contents(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_every_vehicle_has_a_scenario_that_loads_where_it_is_copied_to(tmp_path, monkeypatch, capsys):
    target = tmp_path / "a new" / "folder"
    code, stdout, stderr = call(monkeypatch, capsys, "examples", target)
    assert (code, stderr) == (0, "")
    copied = contents(target)
    assert stdout.splitlines()[: len(copied)] == [str(target / name) for name in example_files()]
    assert stdout.splitlines()[-1] == f"fly one:  cube-sim run '{target}/scenarios/{SCENARIOS[0]}.yaml'"
    flown = {load(path).scenario.model for path in (target / "scenarios").glob("*.yaml")}
    # The CUBE as built differs from the CUBE by its thrusters' numbers only, and is there to be analysed.
    named = {path.name for path in MODEL_FILES} - {"cube_as_built.xml"}
    assert flown == {str(target / "models" / name) for name in named}
    assert {path.name for path in (target / "models").iterdir()} == {path.name for path in (REPO / "models").iterdir()}
    for name, content in copied.items():
        assert content == (REPO / name).read_bytes()


def test_copying_again_is_no_mistake(tmp_path):
    assert copy_examples(tmp_path) == copy_examples(tmp_path)


@pytest.mark.parametrize("other", ["mine.txt", "logs/run.mcap", "scenarios/cube_helix.yaml"])
def test_a_folder_with_anything_else_is_left_as_it_is(tmp_path, monkeypatch, capsys, other):
    copy_examples(tmp_path)
    (tmp_path / "models" / "jack.xml").unlink()
    (tmp_path / other).parent.mkdir(exist_ok=True)
    (tmp_path / other).write_text("mine")
    before = contents(tmp_path)
    code, stdout, stderr = call(monkeypatch, capsys, "examples", tmp_path)
    assert (code, stdout) == (2, "")
    assert stderr == f"{tmp_path}: holds {other}, which is not an unchanged example: give a new or empty folder\n"
    assert contents(tmp_path) == before


def test_a_file_is_no_folder(tmp_path, monkeypatch, capsys):
    (tmp_path / "taken").touch()
    code, stdout, stderr = call(monkeypatch, capsys, "examples", tmp_path / "taken")
    assert (code, stdout, stderr) == (2, "", f"{tmp_path}/taken: cannot hold the examples: Not a directory\n")


def test_the_wheel_takes_in_the_same_files():
    """What `pyproject.toml` maps into the wheel is what the command copies from a checkout."""
    hatch = tomllib.loads((REPO / "pyproject.toml").read_text())["tool"]["hatch"]["build"]["targets"]["wheel"]
    mapped = {}
    for source, target in hatch["force-include"].items():
        path = REPO / source
        for file in path.rglob("*") if path.is_dir() else [path]:
            inside = target if file == path else f"{target}/{file.relative_to(path)}"
            mapped[inside.removeprefix("cube_sim/examples/")] = file
    assert mapped == example_files(REPO / "cube_sim")


def test_a_wheel_alone_has_something_to_fly(tmp_path):
    """A wheel as pip builds it; unpacked, it finds its examples in itself."""
    from hatchling.builders.wheel import WheelBuilder

    (wheel,) = WheelBuilder(str(REPO)).build(directory=str(tmp_path / "dist"), versions=["standard"])
    zipfile.ZipFile(wheel).extractall(tmp_path / "installed")
    files = example_files(tmp_path / "installed" / "cube_sim")
    assert files.keys() == example_files().keys()
    assert all((tmp_path / "installed") in path.parents for path in files.values())
    copy_examples(tmp_path / "examples", files)
    for name in SCENARIOS:
        load(tmp_path / "examples" / "scenarios" / f"{name}.yaml")
