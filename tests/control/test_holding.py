"""Beside a thruster that is stuck a place is held where something holds it, and never much worse than doing nothing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from support.catalogue.mjcf import Layout, Thruster, box_hull, mjcf
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY, thruster_event
from support.vehicles import vehicle

import cube_sim
from cube_sim.control.holding import PAUSE_S, ROOM_M, TRIED_M, Holding, Stuck
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.left_alone import carried_m
from cube_sim.control.resting import Rest, nearest_rest
from cube_sim.control.safe_mode import LossOfTargetMonitor, SafeMode
from cube_sim.control.yielding import WaterHold
from cube_sim.vehicle.loading import load_model
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.health import Health

SURVEY = Layout(
    box_hull(62.0, (1.6, 0.35, 0.35), 0.06, drag_coefficient=0.7, added_share=0.6),
    [
        Thruster((-0.75, 0.2, 0.0), (1, 0, 0)),
        Thruster((-0.75, -0.2, 0.0), (1, 0, 0)),
        Thruster((0.55, 0.0, 0.0), (0, 1, 0)),
        Thruster((-0.55, 0.0, 0.0), (0, 1, 0)),
        Thruster((0.65, 0.0, 0.0), (0, 0, 1)),
        Thruster((-0.45, 0.15, 0.0), (0, 0, 1)),
        Thruster((-0.45, -0.15, 0.0), (0, 0, 1)),
    ],
)
"""Seven thrusters: two astern, two to the sides, a vertical one far ahead and two near the stern."""
STILL = np.zeros(3)


@pytest.fixture(scope="module")
def survey(tmp_path_factory):
    file = tmp_path_factory.mktemp("survey") / "survey.xml"
    file.write_text(mjcf("survey", SURVEY))
    return file


def left_beside(hull, thruster, force):
    A, limits = hull.actuation_matrix, hull.thrusters.limits
    health = Health.whole(len(limits)).with_thruster(thruster, 0.0, force)
    return remaining_capability(A, limits, health, hold=WaterHold.of(hull.dynamics, 0.3))


def test_at_rest_the_thrusters_make_all_that_is_missing_beside_what_is_stuck(survey):
    hull = Vehicle.from_model(load_model(survey, {}), None)
    for thruster, force in ((5, 40.0), (5, -39.0), (4, 25.0)):
        left = left_beside(hull, thruster, force)
        rest = nearest_rest(hull.dynamics.record, left.budget, 1.0, STILL, np.eye(3))
        assert rest.held
        wanted = hull.dynamics.steady_wrenches(np.zeros((1, 3)), rest.attitude[2:])[0] - left.held
        made = lsq_linear(left.budget.matrix, wanted, bounds=tuple(left.budget.limits))
        assert np.sqrt(2.0 * made.cost) < 0.05 * np.linalg.norm(left.held)


def test_where_no_attitude_holds_it_the_best_is_no_worse_than_any_that_is_drawn(survey):
    hull = Vehicle.from_model(load_model(survey, {}), None)
    left, record = left_beside(hull, 3, 51.4), hull.dynamics.record
    best = nearest_rest(record, left.budget, 1.0, STILL, np.eye(3))
    assert not best.held
    wanted = hull.dynamics.steady_wrenches(np.zeros((1, 3)), best.attitude[2:])[0] - left.held
    np.testing.assert_allclose(  # what is missing is what the others do not make
        lsq_linear(left.budget.matrix, wanted - best.missing, bounds=tuple(left.budget.limits)).cost, 0.0, atol=1e-3
    )


def test_a_whole_cube_holds_level_what_its_others_hold():
    left = left_beside(vehicle("cube"), 0, 10.0)
    rest = nearest_rest(vehicle("cube").dynamics.record, left.budget, 1.0, STILL, np.eye(3))
    assert rest.held
    np.testing.assert_allclose(rest.attitude, np.eye(3), atol=1e-12)


def stuck(alone_m, held_m=np.inf, points=False):
    rest = Rest(np.eye(3), np.zeros(6), held_m == 0.0)
    return Stuck(rest, held_m, np.asarray(alone_m, float), points)


DRIFTS, STAYS = 0.3 * np.arange(1, 61), np.minimum(3.0, np.arange(1, 61))


def test_one_that_stays_when_left_alone_and_has_nowhere_to_rest_is_left_alone():
    assert Holding.first(stuck(STAYS), 0.0).left_alone
    assert not Holding.first(stuck(STAYS, points=True), 0.0).left_alone
    assert not Holding.first(stuck(DRIFTS), 0.0).left_alone
    held = Holding.first(stuck(STAYS, held_m=0.0), 0.0)
    assert not held.left_alone
    assert held.attitude is not None


def test_an_attempt_that_is_worse_than_nothing_is_followed_by_nothing_then_tried_again_later_and_later():
    now, pauses = Holding.first(stuck(DRIFTS), 0.0), []
    for _ in range(3):
        now.watch(ROOM_M + 1.0, 1.0)
        assert now.over
        now = now.next(stuck(DRIFTS), 0.0)
        assert now.left_alone
        while not now.over:
            now.watch(0.0, 1.0)
        pauses.append(now.time)
        now = now.next(stuck(DRIFTS), 0.0)
        assert not now.left_alone
    assert pauses == pytest.approx([PAUSE_S * 2.0**k for k in range(3)], abs=1.5)


def test_one_that_only_wanders_off_is_followed_by_another_in_the_attitude_to_rest_in():
    now = Holding.first(stuck(DRIFTS, held_m=0.0, points=True), 1.0)
    assert now.attitude is None
    now.time = 50.0
    now.watch(1.0 + ROOM_M + TRIED_M + 0.1, 0.02)
    assert now.over
    now = now.next(stuck(DRIFTS, held_m=0.0, points=True), 5.0)
    assert not now.left_alone
    assert now.attitude is not None


def test_the_watch_is_closer_only_while_asked_and_never_where_no_limit_is_wanted():
    monitor = LossOfTargetMonitor(SafeMode(limit=10.0, patience=10.0))
    monitor.look_closely(1.5)
    assert tuple(monitor.memory[0])[:2] == (1.5, 3.0)
    monitor.look_closely(None)
    assert tuple(monitor.memory[0])[:2] == (10.0, 10.0)
    never = LossOfTargetMonitor(SafeMode())
    never.look_closely(1.5)
    assert never.memory["limit"][0] == np.inf


def beside(model, force, others):
    """65 s beside the stern's thruster to the side, stuck: largest distance [m] and the authority at the end."""
    events = [thruster_event(5.0, ["T4"], "stuck", force_N=force)]
    events += [thruster_event(5.0, [f"T{i}" for i in (1, 2, 3, 5, 6, 7)])] if others == "dead" else []
    scenario = {
        "schema_version": 1,
        "name": "beside",
        "description": "A thruster to the side sticks, and nothing makes up for it.",
        "model": str(model),
        "duration_s": 70.0,
        "path": {"type": "point", "position_m": [0.0, 0.0, -20.0]},
        "initial": {"position_m": [0.0, 0.0, -20.0]},
        "guidance": {"speed_m_s": 0.3},
        "control": {"faults": "told"},
        "events": events,
        "checks": FORCES_ONLY,
    }
    (flown,) = cube_sim.fly_many(scenario, [{}], signals=["pose.position", "health.authority"])
    place = flown.signals["pose.position"][:, 1:]
    return float(np.linalg.norm(place - place[0], axis=1).max()), flown.signals["health.authority"][-1, 1]


@pytest.mark.flight
@pytest.mark.parametrize("force", [51.4, -39.9])
def test_one_that_no_attitude_holds_at_rest_stays_in_its_place_as_it_is_turned(force, survey):
    hull = Vehicle.from_model(load_model(survey, {}), None)
    left = left_beside(hull, 3, force)
    alone, _ = beside(survey, force, "dead")
    foreseen = carried_m(hull.dynamics.record, left.held, np.eye(3), np.zeros(6), STILL, 65)[-1]
    assert alone == pytest.approx(foreseen, abs=0.05)
    farthest, authority = beside(survey, force, "whole")
    assert authority == 0
    assert farthest < 0.35  # 27 and 37 m with the torque before the force


def at_a_place(model, thruster, force, others):
    """The largest distance from a place [m] in 40 s beside a thruster that is stuck."""
    names = Vehicle.from_model(load_model(model, {}), None).thrusters.names
    events = [thruster_event(5.0, [thruster], "stuck", force_N=force)]
    events += [thruster_event(5.0, [name for name in names if name != thruster])] if others == "dead" else []
    scenario = {
        "schema_version": 1,
        "name": "place",
        "model": str(model),
        "duration_s": 45.0,
        "path": {"type": "point", "position_m": [0.0, 0.0, -20.0]},
        "initial": {"position_m": [0.0, 0.0, -20.0]},
        "guidance": {"speed_m_s": 0.3},
        "events": events,
        "checks": FORCES_ONLY,
    }
    (flown,) = cube_sim.fly_many(scenario, [{}], signals=["pose.position"])
    place = flown.signals["pose.position"][:, 1:]
    return float(np.linalg.norm(place - place[0], axis=1).max())


@pytest.mark.flight
@pytest.mark.parametrize(("name", "thruster"), [("seven_three_verticals", "T3"), ("five_vectored_one_up", "T2")])
def test_one_that_stays_with_its_thrusters_off_stays_nearer_with_them_on(name, thruster, tmp_path):
    file = tmp_path / f"{name}.xml"
    file.write_text(catalogue()[name].make())
    alone = at_a_place(file, thruster, 51.4, "dead")
    assert 0.8 < alone < 1.2
    assert at_a_place(file, thruster, 51.4, "whole") < 0.2  # 3.9 and 2.6 m with the torque before the force


@pytest.mark.parametrize("left_alone", [False, True])
def test_where_nothing_can_be_foretold_no_number_is_made_of_infinities(left_alone):
    alone_m = np.r_[np.arange(30.0), np.full(30, np.inf)]
    with np.errstate(invalid="raise"):
        now = Holding(None, alone_m, 0.0, 0, left_alone=left_alone)
        now.watch(2.0, PAUSE_S + 1.0)
        assert now.over is left_alone
