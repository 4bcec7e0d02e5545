"""Modules, functions and files of the package that a document or a docstring names are there."""

from __future__ import annotations

import re
from pkgutil import resolve_name

import pytest
from support.places import REPO

# The recipes of extending.md name what they add; they are run (test_extending.py).
DOCUMENTS = [p for p in [*REPO.glob("*.md"), *REPO.glob("docs/*.md")] if p.name != "extending.md"]
SOURCES = sorted(path for room in ("cube_sim", "benchmarks", "examples") for path in (REPO / room).rglob("*.py"))
NAME = re.compile(r"(?<![\w./-])cube_sim\.[a-z_]\w*(?:\.\w+)*")  # cube_sim.PathError is a recorded message's
FILE = re.compile(r"(?<![\w./-])(?:cube_sim|tests|docs|examples|benchmarks)/[\w/]+\.(?:py|md)\b")


def missing(text):
    """Names and files in a text that nobody would find, each with what it comes to."""
    for name in sorted(set(NAME.findall(text))):
        path = REPO.joinpath(*name.split("."))
        if path.with_suffix(".py").is_file() or (path / "__init__.py").is_file():
            continue
        try:
            resolve_name(name)
        except (ImportError, AttributeError) as error:
            yield f"{name}: {error}"
    yield from (name for name in sorted(set(FILE.findall(text))) if not (REPO / name).is_file())


@pytest.mark.parametrize("path", sorted(DOCUMENTS), ids=lambda path: path.name)
def test_what_a_document_names_exists(path):
    assert list(missing(path.read_text(encoding="utf-8"))) == []


def test_what_the_code_names_in_prose_exists():
    said = {str(path.relative_to(REPO)): list(missing(path.read_text(encoding="utf-8"))) for path in SOURCES}
    assert {path: names for path, names in said.items() if names} == {}


def test_a_wrong_name_is_seen():
    wrong = "see `cube_sim.vehicle.condition`, cube_sim.vehicle.faults.mend() and cube_sim/vehicle/callbacks.py"
    assert [text.partition(":")[0] for text in missing(wrong)] == [
        "cube_sim.vehicle.condition",
        "cube_sim.vehicle.faults.mend",
        "cube_sim/vehicle/callbacks.py",
    ]
    assert list(missing("cube_sim.vehicle, `cube_sim.vehicle.faults.set_stuck`, docs/physics.md")) == []
