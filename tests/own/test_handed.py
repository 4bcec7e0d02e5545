"""Code of the user's own writes into all it is given, and later into all it has answered: the flight is the same."""

from __future__ import annotations

import numpy as np
import pytest
from support.own_code import scenario_with

import cube_sim
from cube_sim.mission.own.handed import handed
from cube_sim.spatial import State

SCRIBBLE = """
import dataclasses
import numpy as np
from cube_sim.allocation import Allocation, Allocator
from cube_sim.control.controller import Decision

WRITES = {writes}


def scribble(thing):
    if not WRITES:
        return
    if isinstance(thing, np.ndarray) and thing.dtype.kind == "f":
        thing[...] = 123.0
    elif isinstance(thing, tuple):
        for part in thing:
            scribble(part)
    elif dataclasses.is_dataclass(thing):
        for field in dataclasses.fields(thing):
            scribble(getattr(thing, field.name))
        for value in vars(thing).values():
            scribble(value)


"""
LAW = """
def make(setup):
    M = setup.dynamics.total_mass.copy()
    for part in (setup.dynamics, setup.A, setup.limits, setup.capability):
        scribble(part)

    def law(aim):
        wrench = M @ (aim.error + aim.velocity_error)
        scribble(aim)
        return wrench

    return law
"""
CONTROLLER = """
class make:
    def __init__(self, setup):
        self.setup, self.last = setup, None

    def view(self, state):
        view = self.setup.target.view(state.position, state.rotation @ state.velocity)
        scribble(state)
        return view

    def reconfigure(self, left):
        scribble(left)

    def decide(self, state, applied, dt, force_ratio=1.0):
        scribble(self.last)
        view = self.setup.target.view(state.position, state.rotation @ state.velocity)
        wrench = 20.0 * np.concatenate([-state.rotation.T @ view.point.rotation @ view.error, -state.rates]) - applied
        self.last = Decision(
            wrench=wrench, secondary=np.zeros(6), disturbance=np.zeros(6), current=np.zeros(3), view=view,
            remaining=view.remaining, velocity=np.zeros(3), rates=np.zeros(3), quaternion=state.quaternion.copy(),
            attitude_error=0.0, authority=self.setup.capability.authority,
        )
        scribble(state)
        scribble(applied)
        return self.last
"""
MOTION = """
def make(setup):
    scribble(setup.dynamics)
    scribble(setup.capability)

    def motion(view):
        velocity = view.point.rotation @ (np.array([view.speed, 0.0, 0.0]) - 0.3 * view.error)
        scribble(view)
        return velocity

    return motion
"""
ATTITUDE = """
def make(setup):
    scribble(setup.dynamics)
    scribble(setup.capability)

    def attitude(situation, dt):
        scribble(situation)
        return [1.0, 0.0, 0.0, 0.0]

    return attitude
"""
FORCES = """
def make(setup):
    inverse = np.linalg.pinv(setup.A)
    scribble(setup.A)
    scribble(setup.limits)

    def forces(wrench):
        answer = inverse @ wrench
        scribble(wrench)
        return answer

    return forces
"""
ALLOCATOR = """
class make:
    def __init__(self, setup):
        self.inner, self.last = Allocator(setup.A.copy(), setup.limits.copy()), None
        scribble(setup.A)
        scribble(setup.limits)

    def allocate(self, wrench):
        return self.kept(self.inner.allocate(wrench), wrench)

    def allocate_by_priority(self, primary, secondary):
        return self.kept(self.inner.allocate_by_priority(primary, secondary), primary, secondary)

    def kept(self, answer, *given):
        scribble(given)
        scribble(self.last)
        self.last = answer
        return answer

    def reset(self):
        self.inner.reset()

    def resume(self, previous):
        scribble(previous)
"""
SENSOR = """
def make():
    def reading(motion):
        depth = motion.position[2]
        scribble(motion)
        return depth

    return reading
"""
MAKE = {"python": "own.py:make"}
KINDS = {
    "law": (LAW, {"control.law": MAKE}),
    "controller": (CONTROLLER, {"control.law": MAKE}),
    "motion": (MOTION, {"guidance.law": MAKE}),
    "attitude": (ATTITUDE, {"control.attitude": {"mode": "python"} | MAKE}),
    "forces": (FORCES, {"allocation.method": MAKE}),
    "allocator": (ALLOCATOR, {"allocation.method": MAKE}),
    "sensor": (SENSOR, {"navigation": {"own": [{"name": "z", "noise": 0.1, "rate_hz": 10} | MAKE]}}),
}


@pytest.mark.flight
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_written_into_what_was_given_changes_nothing(tmp_path, kind):
    source, overrides = KINDS[kind]
    flown = []
    for writes in (False, True):
        path = scenario_with(tmp_path, SCRIBBLE.replace("{writes}", str(writes)) + source)
        flight = cube_sim.Flight(path, overrides)
        flight.fly(10**6)
        assert not flight.ended
        flown.append(flight.signals)
    clean, scribbled = flown
    assert len(clean["pose.position"]) > 10
    for name, rows in clean.items():
        assert rows.tobytes() == scribbled[name].tobytes(), name


@pytest.mark.flight
def test_an_observation_is_ones_own(tmp_path):
    """Whoever writes into one does not find it in the next."""
    path = scenario_with(tmp_path, "", navigation="{}")
    flight = cube_sim.Flight(path)
    before = flight.step()
    wanted, position = before.wanted.copy(), before.estimate.position.copy()
    before.wanted[:] = before.estimate.position[:] = 9.0
    after = flight.observation()
    assert after.wanted.tobytes() == wanted.tobytes()
    assert after.estimate.position.tobytes() == position.tobytes()


def test_handed_copies_arrays_however_deep():
    state = State(np.zeros(3), np.zeros(4), np.eye(3), np.zeros(3), np.zeros(3))
    nested = (state, [1], "text", (np.ones(2), 3.0))
    copy = handed(nested)
    assert type(copy[0]) is State
    assert copy[1] is nested[1]
    assert copy[3][1] == 3.0
    copy[0].position[:] = copy[3][0][:] = 5.0
    assert not state.position.any()
    assert nested[3][0].tolist() == [1.0, 1.0]
