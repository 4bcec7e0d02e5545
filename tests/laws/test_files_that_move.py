"""Every key that names a file survives a move of the run; keys are found by the schema, so new ones are among them."""

from __future__ import annotations

import re
import shutil
from functools import reduce
from pathlib import Path
from typing import Literal, get_args, get_origin

import numpy as np
import pytest
from pydantic import BaseModel
from support.places import CUBE

import cube_sim
from cube_sim.scenario import Scenario, load
from cube_sim.scenario.file_names import FileKind, file_kind

SAMPLES = {
    FileKind.MODEL: "files/cube.xml",
    FileKind.TABLE: "files/points.csv",
    FileKind.CODE: "files/own.py:make",
    FileKind.RECORD: "files/earlier.npy",
}
"""A file of every kind, as the scenario below names it."""

REQUIRED = {"name": "mine", "noise": 0.1, "signal": "pose.position", "tolerance": 1e6}

SCENARIO = """\
schema_version: 1
name: carried
model: files/cube.xml
duration_s: 0.1
path: {type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}
guidance: {speed_m_s: 0.4}
checks:
  - {kind: allowed_forces}
"""


OWN = """\
import numpy as np
from cube_sim.guidance.line import Line


class Making(Line):
    # a path, and a sensor: both are made of nothing
    def reading(self, motion):
        return motion.position[2]


def make(setup=None):
    if setup is None:
        return Making([0, 0, -5], [4, 0, -5])
    return {
        "LawSetup": lambda aim: 20.0 * aim.velocity_error,
        "AllocationSetup": lambda wrench: np.linalg.pinv(setup.A) @ wrench,
        "PartSetup": lambda seen, dt=None: [0.3, 0.0, 0.0] if dt is None else [1.0, 0.0, 0.0, 0.0],
    }[type(setup).__name__]
"""
"""What is asked of code, in whatever place."""


def blocks(annotation):
    """(block, whether it stands in a list) of every block an annotation speaks of, at any depth of lists and unions."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation, False
    for inner in get_args(annotation):
        for block, listed in blocks(inner):
            yield block, listed or get_origin(annotation) is tuple


def tags(block):
    """The keys by which a block is told from others in its place: ``{"type": "csv"}``."""
    fields = block.model_fields.items()
    return {name: get_args(field.annotation)[0] for name, field in fields if get_origin(field.annotation) is Literal}


def required(block):
    """The keys that a block cannot be without, where it stands in a list."""
    return {
        name: REQUIRED[name] for name, field in block.model_fields.items() if field.is_required() and name in REQUIRED
    }


def naming_files(block=Scenario):
    """(dotted path, values) for every key below a block that names a file: the least that has to be written for it."""
    for name, field in block.model_fields.items():
        if (kind := file_kind(field)) is not None:
            yield name, {name: SAMPLES[kind]}
        for inner, listed in blocks(field.annotation):
            for path, values in naming_files(inner):
                if listed or inner.model_fields.keys() & {"type", "kind", "mode"}:
                    value = {**tags(inner), **required(inner), **values}
                    yield f"{name}.{path}", {name: [value] if listed else value}
                else:
                    yield f"{name}.{path}", {f"{name}.{key}": value for key, value in values.items()}


# A run is of one flight: the samples of its scenario, and what draws them, do not go with it. Phases take the place of
# the path, and have a test of their own.
KEYS = {path: values for path, values in naming_files() if not path.startswith(("samples.", "phases."))}

PHASED = """\
phases:
  - name: surveyed
    path: {type: csv, file: files/points.csv}
    guidance: {law: {python: files/own.py:make}}
  - name: drawn
    path: {type: line, start_m: [6, 0, -4], end_m: [8, 0, -4]}
"""


def checkout(folder: Path) -> Path:
    """A folder with a scenario and files of every kind, which nothing outside is needed for."""
    (folder / "scenarios" / "files").mkdir(parents=True)
    shutil.copy(CUBE, folder / "scenarios" / "files")
    (folder / "scenarios" / "files" / "points.csv").write_text("x_m,y_m,z_m\n0,0,-5\n3,1,-5\n6,0,-4\n")
    (folder / "scenarios" / "files" / "own.py").write_text(OWN)
    np.save(folder / "scenarios" / "files" / "earlier.npy", np.column_stack([np.arange(6) * 0.02, np.zeros((6, 3))]))
    path = folder / "scenarios" / "carried.yaml"
    path.write_text(SCENARIO)
    return path


def value_at(block, path):
    """The value at a dotted path; of a list, its first item's."""
    return reduce(lambda at, key: getattr(at[0] if isinstance(at, tuple) else at, key), path.split("."), block)


def test_the_keys_known_to_name_files_are_found():
    assert {
        "model",
        "knowledge.model",
        "path.file",
        "path.python",
        "control.law.python",
        "control.attitude.python",
        "guidance.law.python",
        "allocation.method.python",
        "navigation.own.python",
        "checks.record",
    } <= set(KEYS)


def test_every_key_that_speaks_of_a_file_is_marked():
    def every_field(block, seen):
        for field in block.model_fields.values():
            yield field
            for inner, _ in blocks(field.annotation):
                if inner not in seen:
                    yield from every_field(inner, seen | {inner})

    speaking = [
        field
        for field in every_field(Scenario, frozenset())
        if re.search(r"[A-Z]+ file|relative to the scenario", field.description or "")
    ]
    assert len(speaking) >= len(KEYS)
    assert [field.description for field in speaking if file_kind(field) is None] == []


@pytest.mark.parametrize(("key", "values"), KEYS.items(), ids=KEYS)
def test_what_a_key_names_is_found_again_after_a_move(key, values, tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    written = load(checkout(here), values)
    logs = here / "logs" / "a"
    logs.mkdir(parents=True)
    (logs / "resolved.yaml").write_text(written.resolved_yaml(logs))
    assert Path(value_at(written.scenario, key)).is_relative_to(here)

    here.rename(there)
    found = load(there / "logs" / "a" / "resolved.yaml").scenario
    assert Path(value_at(found, key)) == there / Path(value_at(written.scenario, key)).relative_to(here)
    assert str(tmp_path) not in (there / "logs" / "a" / "resolved.yaml").read_text()


def test_what_a_phase_names_is_found_again_after_a_move(tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    path = checkout(here)
    lines = [line for line in SCENARIO.splitlines() if not line.startswith("path:")]
    path.write_text("\n".join([*lines, PHASED]))
    written, logs = load(path), here / "logs" / "a"
    logs.mkdir(parents=True)
    (logs / "resolved.yaml").write_text(written.resolved_yaml(logs))
    here.rename(there)
    found, files = load(there / "logs" / "a" / "resolved.yaml").scenario, there / "scenarios" / "files"
    assert Path(value_at(found, "phases.path.file")) == files / "points.csv"
    assert Path(value_at(found, "phases.guidance.law.python")) == files / "own.py:make"
    assert str(tmp_path) not in (there / "logs" / "a" / "resolved.yaml").read_text()


@pytest.mark.flight
@pytest.mark.parametrize("order", [list, reversed])
def test_a_run_that_names_files_by_every_key_gives_the_same_bytes_wherever_they_stand(order, tmp_path):
    """And its own resolved scenario, carried elsewhere with them, flies the same."""
    # Of blocks that exclude each other one is named, the last.
    values = {key: value for changes in map(KEYS.get, order(KEYS)) for key, value in changes.items()}
    here, there = tmp_path / "here", tmp_path / "deeper" / "down" / "there"
    first = cube_sim.run(checkout(here), values, here / "logs" / "a")
    second = cube_sim.run(checkout(there), values, there / "logs" / "a")
    recorded = (first.directory / "run.mcap").read_bytes()
    assert (second.directory / "run.mcap").read_bytes() == recorded

    shutil.rmtree(there)
    here.rename(there)
    again = cube_sim.run(there / "logs" / "a" / "resolved.yaml", None, there / "logs" / "b")
    assert again.signals.keys() == first.signals.keys()
    for name, rows in first.signals.items():
        assert again.signals[name].tobytes() == rows.tobytes(), name
