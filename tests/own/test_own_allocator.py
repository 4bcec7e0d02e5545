"""An allocator of the user's own: flown, told of faults, saved, and refused where it is none."""

from __future__ import annotations

import numpy as np
import pytest
from support.command_line import call
from support.flights import thruster_event
from support.own_code import scenario_with
from support.places import HELIX

import cube_sim
from cube_sim.allocation import Status, make_allocator
from cube_sim.errors import ScenarioError

SHORT = {"duration_s": 2.0, "checks": [{"kind": "allowed_forces"}]}
WEIGHTS = np.array([1.0, 1.0, 1.0, 30.0, 30.0, 30.0])
METHOD = "{method: {python: 'own.py:make'}}"


def least_squares(setup, share=1.0):
    """The pseudo-inverse, or a share of its forces."""
    inverse = share * np.linalg.pinv(setup.A)
    return lambda wrench: inverse @ wrench


class Named:
    """One of cube_sim's own, as an object."""

    def __new__(cls, setup, method="search"):
        """Make it."""
        return make_allocator(method, setup.A, setup.limits, {"wrench_weights": WEIGHTS, "dwell_calls": 50.0})


def flown(flight):
    """All signals of a flight to its end."""
    while not flight.over:
        flight.step()
    return flight.signals


def assert_same(one, other):
    """Two flights are the same bits."""
    assert one.keys() == other.keys()
    assert [name for name, rows in one.items() if rows.tobytes() != other[name].tobytes()] == []


@pytest.mark.flight
def test_a_function_is_the_pseudo_inverse_it_computes():
    own = flown(cube_sim.Flight(HELIX, SHORT, allocator=least_squares))
    named = flown(cube_sim.Flight(HELIX, {**SHORT, "allocation.method": "pseudo_inverse"}))
    assert own["allocation.status"][:, 1].tolist() == named["allocation.status"][:, 1].tolist()
    np.testing.assert_allclose(own["thrusters.force"], named["thrusters.force"], atol=1e-6)
    np.testing.assert_allclose(own["pose.position"], named["pose.position"], atol=1e-9)


@pytest.mark.flight
def test_a_whole_allocator_is_asked_as_our_own_is():
    settings = {**SHORT, "allocation.reversal_penalty_N2": 0.0, "allocation.switching_penalty_N2": 0.0}
    own = flown(cube_sim.Flight(HELIX, settings, allocator=Named))
    assert_same(own, flown(cube_sim.Flight(HELIX, {**settings, "allocation.method": "search"})))


@pytest.mark.flight
def test_another_one_is_made_for_the_thrusters_that_respond():
    seen = []

    def make(setup):
        seen.append(setup)
        return least_squares(setup)

    settings = {**SHORT, "events": [thruster_event(0.5, ["T3"])], "control.faults": "told"}
    flight = cube_sim.Flight(HELIX, settings, allocator=make)
    signals = flown(flight)
    assert len(seen[0].names) == 8
    assert seen[-1].names == tuple(f"T{i}" for i in (1, 2, 4, 5, 6, 7, 8))
    assert seen[-1].which.tolist() == [0, 1, 3, 4, 5, 6, 7]
    assert seen[-1].A.shape == (6, 7)
    assert signals["thrusters.force"][:20, 3].any()
    assert not signals["thrusters.force"][-50:, 3].any()


def test_what_is_missed_is_said():
    flight = cube_sim.Flight(HELIX, {**SHORT, "allocation.method.options.share": 0.5}, allocator=least_squares)
    asked = np.array([30.0, 0.0, 10.0, 0.0, 0.0, 2.0])
    made = flight.step(wrench=asked).wrench
    np.testing.assert_allclose(made, 0.5 * asked, atol=1e-9)
    assert flight.signals["allocation.status"][0, 1] in (Status.MISSED, Status.FORBIDDEN_FORCE)
    assert flight.signals["allocation.residual"][0, 1] > 10.0


@pytest.mark.flight
def test_what_an_allocator_remembers_is_saved():
    def slow(setup):
        force = np.zeros(len(setup.which))

        def allocate(wrench):
            nonlocal force
            force = force + 0.2 * (np.linalg.pinv(setup.A) @ wrench - force)
            return force

        return allocate

    flight = cube_sim.Flight(HELIX, SHORT, allocator=slow)
    for _ in range(20):
        flight.step()
    middle = flight.snapshot()
    first = flown(flight)
    other = cube_sim.Flight(HELIX, SHORT, allocator=slow)
    other.restore(middle)
    assert flown(other)["thrusters.force"].tobytes() == first["thrusters.force"][20:].tobytes()
    flight.reset()
    assert_same(flown(flight), first)


@pytest.mark.parametrize(
    ("source", "told"),
    [
        ("def make(): pass", "own.py:make: too many positional arguments"),
        ("def make(setup): return setup.B", "own.py:1: AttributeError: "),
        ("def make(setup): return 1", "own.py:make makes a int; it takes a function of a wrench, or an object with"),
        ("class make:\n def __init__(self, s): pass\n def allocate(self, w): pass",
         "own.py:make makes a make without the method allocate_by_priority and reset and resume"),
        ("def make(setup): return lambda wrench: wrench", "answers forces of shape (6,); it takes 8 numbers"),
        ("def make(setup): return lambda wrench: [float('inf')] * 8", "every number must be finite"),
        ("def make(setup): return lambda wrench: wrench @ setup.A.T", "own.py:1: ValueError: "),
        ("class make:\n def __init__(self, s): pass\n def allocate(self, w): return w\n"
         " allocate_by_priority = reset = resume = allocate", "answers a ndarray to allocate; it takes an Allocation"),
    ],
)  # fmt: skip
def test_what_is_no_allocator_is_one_line(source, told, tmp_path, monkeypatch, capsys):
    path = scenario_with(tmp_path, source, allocation=METHOD)
    code, out, err = call(monkeypatch, capsys, "run", path, "--out", tmp_path / "out", "--quiet")
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert err.startswith(f"{path}:11:31: allocation.method.python: "), err
    assert told in err
    assert not (tmp_path / "out").exists()


def test_code_of_ones_own_is_told_of_no_objective():
    with pytest.raises(ScenarioError, match=r"allocation\.objective: code of your own is told of no objective"):
        cube_sim.Flight(HELIX, {"allocation.objective": "reactivity"}, allocator=least_squares)


@pytest.mark.flight
def test_an_allocator_that_fails_when_a_thruster_does_ends_the_flight():
    def make(setup):
        return least_squares(setup) if len(setup.which) == 8 else 1 / 0

    settings = {**SHORT, "events": [thruster_event(0.5, ["T3"])], "control.faults": "told"}
    flight = cube_sim.Flight(HELIX, settings, allocator=make)
    flown(flight)
    assert flight.time_s == pytest.approx(0.5)
    assert flight.ended.startswith("allocation.method: test_own_allocator.py:")
    assert flight.ended.endswith("ZeroDivisionError: division by zero")
