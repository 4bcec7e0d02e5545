"""The compiled law for all axes is the readable one: run by the interpreter, its source gives the same numbers."""

from __future__ import annotations

import numpy as np
import pytest
from support.flights import FORCES_ONLY, thruster_event
from support.places import HELIX, SCENARIOS
from support.plain_callbacks import plain
from support.vehicles import random_hull, random_rotation

from cube_sim.control import (
    along_path,
    balancing,
    current,
    disturbance,
    following,
    force_first,
    free_attitude,
    look_at,
    oscillation_centre,
    path_follower,
    refuge,
)
from cube_sim.control.asked import MEMORY as ASKED
from cube_sim.control.attitude_mode import DESIRED
from cube_sim.control.authority import CAPABILITY
from cube_sim.control.loops import LOOPS
from cube_sim.flight import Flight
from cube_sim.guidance.view_record import VIEW
from cube_sim.spatial import quaternion_from_rotation, rotation_about

FACETS = 9


def readable(record):
    """The same memory, its fields attributes for the interpreter, too."""
    return record.view(np.recarray) if isinstance(record, np.ndarray) and record.dtype.names else record


def filled(rng, dtype):
    """A record whose numbers are drawn and whose flags are set."""
    record = np.zeros(1, dtype)
    for name in dtype.names:
        kind = record[name].dtype.kind
        if kind == "f":
            record[name] = rng.normal(size=record[name].shape)
        elif kind == "b":
            record[name] = True
    return record


def same(name, stage, arguments, records):
    """Call both with copies of the records; what they leave in them must be equal."""
    compiled, interpreted = [r.copy() for r in records], [r.copy() for r in records]
    stage(*arguments(*compiled))
    function = getattr(plain(stage.__module__), stage.__name__)
    assert not hasattr(function, "py_func")
    function(*(readable(argument) for argument in arguments(*(readable(r) for r in interpreted))))
    for fast, slow, before in zip(compiled, interpreted, records, strict=True):
        assert fast.tobytes() != before.tobytes(), name
        for field in fast.dtype.names or ():
            np.testing.assert_allclose(fast[field], slow[field], rtol=1e-11, atol=1e-11, err_msg=f"{name}.{field}")
        if not fast.dtype.names:
            np.testing.assert_allclose(fast, slow, rtol=1e-11, atol=1e-11, err_msg=name)


@pytest.fixture(params=range(4))
def rng(request):
    return np.random.default_rng(request.param)


@pytest.fixture
def hull(rng):
    return random_hull(rng).record


def moving(rng):
    R = random_rotation(rng)
    return R, quaternion_from_rotation(R), rng.normal(size=3), rng.normal(size=3)


def desired(rng):
    """A desired attitude and how it turns."""
    record = filled(rng, DESIRED)
    record["quaternion"] = quaternion_from_rotation(random_rotation(rng))
    return record


def seen(rng):
    """A vehicle's view from its target."""
    record = filled(rng, VIEW)
    record["frame"] = random_rotation(rng)
    return record


def facets(rng, room):
    """Normals, bounds and held shares; the more room, the fewer wrenches exceed them."""
    return rng.normal(size=(FACETS, 6)), room * np.ones(FACETS), 0.1 * rng.normal(size=FACETS)


@pytest.mark.parametrize("room", [1e-3, 30.0, 1e4])
@pytest.mark.parametrize(
    "flags", [(False, False, 1.0, False), (True, True, 1.0, False), (True, True, 1.0, True), (True, True, 0.2, False)]
)
def test_the_law(rng, hull, room, flags):
    R, q, v, w = moving(rng)
    loops, left, of_facets = (
        np.array([(1.0, 0.8, 0.3, 0.5, (0.0, 1.0, 0.0))], LOOPS),
        filled(rng, CAPABILITY),
        facets(rng, room),
    )
    velocity, acceleration, flow = rng.normal(size=(3, 3))
    unknown, applied = rng.normal(size=(2, 6))
    wanted, view = desired(rng), seen(rng)

    def arguments(memory, answer):
        told = hull, loops, left, *of_facets, memory, answer, R, q, v, w, velocity, acceleration, wanted
        return *told, unknown, flow, view, applied, 0.9, np.array([5.0, 2.0]), *flags, 2.0

    same("follow", following.follow, arguments, [filled(rng, ASKED), np.zeros(1, following.FOLLOWED)])


def test_the_force_before_the_torque(rng):
    normals, bounds, held_shares = facets(rng, 0.1)
    limits = np.outer([-1.0, 1.2], rng.uniform(5.0, 50.0, size=7))
    first = force_first.ForceFirst(bounds, rng.normal(size=(6, 7)), limits, rng.normal(size=6), np.eye(6), False)

    def arguments(wrench):
        return first, normals, held_shares, 0.9, wrench

    same("serve_force_first", force_first.serve_force_first, arguments, [30.0 * rng.normal(size=6)])


@pytest.mark.parametrize(("room", "short"), [(1e-3, False), (1e4, False), (1e-3, True)])
def test_looking_back_from_a_refuge(rng, hull, room, short):
    of_facets, flow = facets(rng, room), rng.normal(size=3)
    wished, memory = quaternion_from_rotation(random_rotation(rng)), filled(rng, refuge.REFUGE)
    memory["quaternion"] = quaternion_from_rotation(random_rotation(rng))

    def arguments(memory):
        return memory, hull, *of_facets, 0.9, flow, wished, short

    same("look_back", refuge.look_back, arguments, [memory])
    assert refuge.look_back(memory, hull, *of_facets, 0.9, flow, wished, short) == (room > 1.0)


@pytest.mark.parametrize("room", [1e-3, 1e4])
@pytest.mark.parametrize("level", [False, True])
@pytest.mark.parametrize("started", [False, True])
def test_the_balanced_attitude(rng, hull, room, level, started):
    R, of_facets = random_rotation(rng), facets(rng, room)
    parameters = filled(rng, balancing.BALANCE)
    parameters["count"], parameters["level"] = 2, level
    parameters["time"], parameters["wish_time"], parameters["most_rate"] = 0.5, 2.0, 0.4
    memory = filled(rng, balancing.MEMORY)
    memory["rotation"], memory["started"] = random_rotation(rng), started
    asked, flow, view = filled(rng, ASKED), rng.normal(size=3), seen(rng)

    def arguments(memory, wanted):
        return hull, parameters, *of_facets, memory, wanted, view, R, asked, flow, 0.02, 0.9

    same("balance", balancing.balance, arguments, [memory, desired(rng)])


@pytest.mark.parametrize("started", [False, True])
def test_the_observers(rng, hull, started):
    R, _, v, w = moving(rng)
    memory, applied, residual = filled(rng, disturbance.MEMORY), rng.normal(size=6), rng.normal(size=6)
    memory["started"] = started

    def of_disturbance(memory):
        return hull, 0.8, memory, R, v, w, applied, residual[:3].copy(), 0.02

    same("disturbance", disturbance.observe_disturbance, of_disturbance, [memory])

    def of_current(estimate):
        return hull, 2.0, 0.01, estimate, R, v, w, residual

    same("current", current.observe_current, of_current, [rng.normal(size=3)])


def test_the_centre_of_oscillation(rng):
    R, _, _, w = moving(rng)
    left, view = filled(rng, CAPABILITY), seen(rng)

    def arguments(memory):
        return left, memory, R, w, view, 0.02, 1.5

    same("watch_centre", oscillation_centre.watch_centre, arguments, [filled(rng, oscillation_centre.CENTRE)])


@pytest.mark.parametrize("started", [False, True])
def test_the_nose_along_the_path(rng, started):
    memory, view = filled(rng, along_path.MEMORY), seen(rng)
    memory["started"] = started

    def arguments(memory, answer):
        return 2.0, memory, answer, view, 0.02

    same("nose_along", along_path.nose_along, arguments, [memory, np.zeros(1, DESIRED)])


@pytest.mark.parametrize("place", ["far", "near", "at the point", "opposite"])
@pytest.mark.parametrize("started", [False, True])
def test_looking_at_a_point(rng, started, place):
    R, parameters, view = random_rotation(rng), filled(rng, look_at.LOOK), seen(rng)
    parameters["axis"], parameters["side"] = np.eye(3)[:2]
    parameters["near"], parameters["time"], parameters["levelling_time"] = 0.3, 1.0, 2.0
    memory = filled(rng, look_at.MEMORY)
    memory["rotation"], memory["started"] = random_rotation(rng), started
    here = view["row"][0, :3] + view["frame"][0] @ view["error"][0]
    held = memory["rotation"][0] if started else R
    away = {
        "far": [3.0, 1.0, -2.0],
        "near": [0.1, 0.0, 0.1],
        "at the point": np.zeros(3),
        "opposite": -2.0 * held[:, 0],
    }
    parameters["point"] = here + away[place]

    def arguments(memory, answer):
        return parameters, memory, answer, view, R, 0.02

    same("look_at", look_at.look_at, arguments, [memory, np.zeros(1, DESIRED)])


@pytest.mark.parametrize("tilt", [0.0, 2.0, np.pi])
@pytest.mark.parametrize("started", [False, True])
def test_the_attitude_of_least_effort(rng, hull, started, tilt):
    R, parameters, view = random_rotation(rng), filled(rng, free_attitude.EFFORT), seen(rng)
    parameters["time"], parameters["lift"], parameters["righting"] = 1.5, 3.0, (0.0, 0.0, 3.0)
    memory = filled(rng, free_attitude.MEMORY)
    memory["rotation"], memory["started"] = rotation_about(np.eye(3)[0], tilt), started
    force, flow = tuple(rng.normal(size=3).tolist()), tuple(rng.normal(size=3).tolist())

    def arguments(memory, answer):
        return hull, parameters, memory, answer, view, R, force, flow, 0.02

    same("least_effort", free_attitude.least_effort, arguments, [memory, np.zeros(1, DESIRED)])


LOOKING = {"control.attitude": {"mode": "look_at", "point_m": [1.0, -0.5, -4.0]}}
FREE = {"control.attitude": {"mode": "free"}}
LOST = {
    "control.faults": "told",
    "events": [thruster_event(1.0, ["T6", "T2", "T3"])],
    "guidance.speed_m_s": 1.5,
    "current_m_s": [0.3, 0.2, 0.0],
}
WHOLE = {
    "along the path": (HELIX, {}),
    "attitude pointed": (SCENARIOS / "torpedo_helix.yaml", {}),
    "at trim": (SCENARIOS / "bluerov2_vectored_helix.yaml", {}),
    "at a point": (SCENARIOS / "cube_hover.yaml", {}),
    "by the clock": (SCENARIOS / "cube_track.yaml", {}),
    "one attitude": (HELIX, {"control.attitude": {"mode": "fixed", "attitude_deg": [10.0, 20.0, 30.0]}}),
    "looking at a point": (HELIX, LOOKING),
    "of least effort": (SCENARIOS / "bluerov2_free.yaml", {}),
    "looking at trim": (SCENARIOS / "bluerov2_vectored_helix.yaml", LOOKING),
    "of least effort at trim": (SCENARIOS / "bluerov2_vectored_helix.yaml", FREE),
    "looking, lost and too fast": (SCENARIOS / "cube_lose_one.yaml", LOST | LOOKING),
    "of least effort, lost and too fast": (SCENARIOS / "cube_lose_one.yaml", LOST | FREE),
    "no estimates": (HELIX, {"control.disturbance_time_s": None}),
    "stuck": (
        SCENARIOS / "cube_lose_one.yaml",
        {"control.faults": "told", "events": [thruster_event(1.0, ["T6"], "stuck", force_N=51.0)], "duration_s": 15.0},
    ),
    "stuck at full force": (
        HELIX,
        {"control.faults": "told", "events": [thruster_event(1.0, ["T1"], "stuck", force_N=51.0)]},
    ),
    "lost and too fast": (SCENARIOS / "cube_lose_one.yaml", LOST),
    "too fast": (HELIX, {"guidance.speed_m_s": 1.5}),
}


@pytest.mark.flight
@pytest.mark.parametrize("name", WHOLE)
def test_one_call_a_tick_is_the_law_part_by_part_to_the_bit(name, monkeypatch):
    path, settings = WHOLE[name]
    settings = {"duration_s": 8.0, "checks": FORCES_ONLY, "events": []} | settings
    whole = Flight(path, settings)
    assert whole.mission.controller._compiled is not None
    flown = [whole.step() for _ in range(whole.mission.scenario.ticks)]
    monkeypatch.setattr(path_follower, "compiled_parts", lambda *_: None)
    parts = Flight(path, settings)
    for one in flown:
        other = parts.step()
        assert one.state.position.tobytes() == other.state.position.tobytes(), one.time_s
        assert one.wrench.tobytes() == other.wrench.tobytes(), one.time_s
    assert parts.mission.controller._compiled is None
