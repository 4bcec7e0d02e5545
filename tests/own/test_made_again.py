"""Own code flown again from its record: with its neighbours, with its arguments, or not, and then it says why."""

from __future__ import annotations

import dataclasses
import sys
from functools import partial

import numpy as np
import pytest
from support.own_code import scenario_with

import cube_sim
from cube_sim.errors import RecordingError
from cube_sim.guidance.helix import Helix
from cube_sim.runs.replay import replay

LAW = {"control": "{law: {python: 'own.py:make'}}"}
SOURCE = """
from gains import KP
from shapes.round import TWICE

def make(setup):
    M = setup.dynamics.total_mass
    return lambda aim: TWICE * KP * (M @ aim.velocity_error)
"""
SHORT = {"duration_s": 1.0, "checks": [{"kind": "allowed_forces"}]}


@dataclasses.dataclass
class Ring(Helix):
    """A path with arguments of its own."""

    radius: float = 2.0

    def __post_init__(self):
        super().__init__(np.array([0.0, 0.0, -5.0]), self.radius, 1.0, 0.5)


class Counted(Helix):
    """One that does not tell what it was made with."""

    def __init__(self, size=2.0):
        super().__init__(np.array([0.0, 0.0, -5.0]), size, 1.0, 0.5)


def hold(setup, gain=1.0, at=None):
    """A law."""
    return lambda aim: gain * aim.velocity_error


class Holder:
    """An object that is a factory."""

    def __call__(self, setup):
        return hold(setup)


@pytest.fixture
def neighbours(tmp_path):
    (tmp_path / "gains.py").write_text("KP = 2.0\n")
    (tmp_path / "shapes").mkdir()
    (tmp_path / "shapes" / "__init__.py").write_text("")
    (tmp_path / "shapes" / "round.py").write_text("TWICE = 2.0\n")
    yield tmp_path
    for name in [name for name in sys.modules if name.split(".")[0] in ("gains", "shapes")]:
        del sys.modules[name]


@pytest.mark.flight
def test_what_a_law_imports_from_its_folder_is_flown_again(neighbours):
    path = scenario_with(neighbours, SOURCE, **LAW)
    run = cube_sim.run(path, out=neighbours / "run")
    (neighbours / "gains.py").unlink()
    recorded = cube_sim.load_run(neighbours / "run")
    names = [name for name in recorded.header.inputs if name.startswith("python/")]
    assert names == [f"python/control.law/{name}" for name in ("gains.py", "shapes/__init__.py", "shapes/round.py")]
    assert replay(recorded).identical
    assert not any("again" in line.text for line in run.log)
    assert str(neighbours) not in sys.path


@pytest.mark.flight
def test_a_neighbour_that_has_changed_is_read_anew_and_that_of_another_folder_is_another(neighbours):
    path, flown = scenario_with(neighbours, SOURCE, **LAW), []
    other = neighbours / "other"
    other.mkdir()
    (other / "gains.py").write_text("KP = 9.0\n")
    (other / "shapes").mkdir()
    for name in ("__init__.py", "round.py"):
        (other / "shapes" / name).write_text((neighbours / "shapes" / name).read_text())

    def first_wrench(scenario):
        flight = cube_sim.Flight(scenario)
        flight.step()
        return np.linalg.norm(flight.signals["wrench.demanded"][0, 1:])

    flown.append(first_wrench(path))
    (neighbours / "gains.py").write_text("KP = 40.0\n")
    flown += [first_wrench(path), first_wrench(scenario_with(other, SOURCE, **LAW))]
    assert np.allclose(flown, flown[0] * np.array([1.0, 20.0, 4.5]))


@pytest.mark.flight
@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"path": Ring(radius=2.5)}, ""),
        ({"path": Counted(2.5)}, "it is an object, and what it was made with is not known"),
        ({"controller": partial(hold, gain=3.0)}, ""),
        ({"controller": partial(hold, at=object())}, "a scenario cannot hold what it is called with"),
        ({"controller": lambda setup: hold(setup)}, "it is made within a function"),
        ({"controller": Holder()}, "it is an object, and what it was made with is not known"),
    ],
)
def test_what_a_program_hands_over_is_flown_again_or_says_why_not(tmp_path, given, reason):
    run = cube_sim.fly(scenario_with(tmp_path, ""), SHORT, out=tmp_path / "run", **given)
    said = [line for line in run.log if "cannot be flown again from its record" in line.text]
    recorded = cube_sim.load_run(tmp_path / "run")
    if not reason:
        assert not said
        assert replay(recorded).identical
        return
    (line,) = said
    assert line.text.endswith(f": {reason}")
    with pytest.raises(RecordingError, match=reason):
        replay(recorded)
