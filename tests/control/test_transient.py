"""How far a hull leaves its path after a fault: bounded from the model, and no flight goes beyond."""

from __future__ import annotations

import json
from math import inf

import numpy as np
import pytest
from support.flights import FORCES_ONLY, thruster_event
from support.places import MODELS
from support.vehicles import vehicle

import cube_sim
from cube_sim.commands.stuck_flight import ReadModel
from cube_sim.commands.stuck_report import Fault, fault_cases
from cube_sim.control.authority import Authority
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.thrown import LoopSpeeds, Thrown, share_asked, thrown_by
from cube_sim.control.transient import braking_m, keeps, transient
from cube_sim.control.yielding import WaterHold
from cube_sim.vehicle.loading import load_model
from cube_sim.wrench.health import Health

LOOPS = LoopSpeeds(velocity=0.5, attitude=0.5, rate=0.15, observer=1.0, delay=0.05)
OPEN = LoopSpeeds(velocity=1e9, attitude=1e9, rate=1e9, observer=1e9, delay=0.05)
STILL = np.zeros(3)
REST = Thrown(0.0, STILL, STILL, STILL, np.zeros(6))


def moving(speed, off=0.0):
    """Thrown off by so much, sideways."""
    return REST._replace(off_m=off, velocity=np.array([0.0, speed, 0.0]))


def left_beside(name, thruster, force=None):
    hull = vehicle(name)
    A, limits = hull.actuation_matrix, hull.thrusters.limits
    health = Health.whole(len(limits)).with_thruster(thruster, 0.0, np.nan if force is None else force)
    return remaining_capability(A, limits, health, hold=WaterHold.of(hull.dynamics, 0.3))


@pytest.mark.parametrize(("speed", "brake"), [(0.1, 1.0), (0.5, 1.0), (0.5, 0.2), (2.0, 0.3)])
def test_a_loop_that_saturates_brakes_within_the_distance_that_is_said(speed, brake):
    v, x, dt, time = speed, 0.0, 1e-4, 0.5
    for _ in range(400_000):
        x += dt * v
        v -= dt * min(v / time, brake)
    assert braking_m(speed, brake, time) == pytest.approx(x, rel=1e-3)


def test_while_nothing_answers_a_push_throws_a_hull_as_far_as_it_does_in_free_space():
    hull = vehicle("cube")
    A, limits, mass = hull.actuation_matrix, hull.thrusters.limits[:, (0, 3)], hull.dynamics.total_mass
    thrown = thrown_by(mass, A, limits, np.eye(6), 2, (0.0, 20.0), OPEN, 0.4)
    motion = np.linalg.solve(mass, 20.0 * A[:, 2])
    np.testing.assert_allclose(thrown.velocity, 0.4 * motion[:3], rtol=1e-6)
    np.testing.assert_allclose(thrown.rates, 0.4 * motion[3:], rtol=1e-6)
    assert thrown.off_m == pytest.approx(0.08 * np.linalg.norm(motion[:3]), rel=0.05)


def test_loops_that_answer_bring_the_push_of_a_redundant_thruster_to_an_end():
    hull = vehicle("cube")
    A, limits, mass = hull.actuation_matrix, hull.thrusters.limits[:, (0, 3)], hull.dynamics.total_mass

    def speed(loops, time):
        return np.linalg.norm(thrown_by(mass, A, limits, np.eye(6), 2, (0.0, 5.0), loops, time).velocity)

    assert speed(LOOPS, 8.0) < 0.2 * speed(LOOPS, 0.5)
    assert speed(OPEN, 8.0) == pytest.approx(16.0 * speed(OPEN, 0.5), rel=1e-6)


def test_a_push_goes_on_until_the_others_have_made_up_for_it():
    motion = np.array([0.2, 0.0, 0.0, 0.0, 0.0, -1.0])
    later = REST.pushed_on(motion, 0.1).pushed_on(motion, 0.1)
    once = REST.pushed_on(motion, 0.2)
    for a, b in zip(later, once, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-15)
    assert once.off_m == pytest.approx(0.2 * 0.2**2 / 2.0)
    np.testing.assert_allclose(once.turned, [0.0, 0.0, -(0.2**2) / 2.0])


def test_what_is_asked_of_thrusters_makes_the_wrench():
    A = vehicle("bluerov2_heavy").actuation_matrix
    np.testing.assert_allclose(A @ share_asked(A), np.eye(6), atol=1e-12)


def test_the_bound_grows_with_what_it_begins_with_and_with_what_is_stuck():
    hull, free = vehicle("cube").dynamics, left_beside("cube", 0)
    bounds = [
        transient(free, hull, LOOPS, moving(speed, off), np.eye(3), STILL, STILL).bound_m
        for off, speed in ((0.0, 0.0), (0.1, 0.0), (0.1, 0.1), (0.1, 0.5))
    ]
    assert bounds[0] == 0.01
    assert bounds == sorted(bounds)
    assert bounds[2] == pytest.approx(0.1 + 0.1 * 0.55)
    push = np.linalg.solve(hull.total_mass, vehicle("cube").actuation_matrix[:, 0])[:3]
    away = REST._replace(velocity=0.3 * push / np.linalg.norm(push))
    stuck = [left_beside("cube", 0, force) for force in (5.0, 25.0)]
    held = [transient(left, hull, LOOPS, away, np.eye(3), STILL, STILL) for left in stuck]
    assert 0.0 < held[0].bound_m < held[1].bound_m < inf


def test_no_bound_is_given_where_the_law_follows_none():
    hull, free = vehicle("cube").dynamics, left_beside("cube", 0)
    turns = transient(left_beside("cube", 4, 51.44), hull, LOOPS, moving(0.05), np.eye(3), STILL, STILL)
    assert turns.bound_m == inf
    assert turns.turns_rad > 0.5
    assert "it has to turn by" in turns.words
    spun = transient(free, hull, LOOPS, REST._replace(rates=np.array([0.0, 8.0, 0.0])), np.eye(3), STILL, STILL)
    assert "before it is stopped" in spun.reason
    assert transient(free, hull, LOOPS, moving(9.0), np.eye(3), STILL, STILL).bound_m == inf
    rov = vehicle("bluerov2_heavy")
    two_lost = Health(np.array([0.0, 0.0, 1, 1, 1, 1, 1, 1]), np.full(8, np.nan))
    hold = WaterHold.of(rov.dynamics, 0.3)
    pointing = remaining_capability(rov.actuation_matrix, rov.thrusters.limits, two_lost, hold=hold)
    assert pointing.authority in (Authority.PLANE, Authority.LINE)
    said = transient(pointing, rov.dynamics, LOOPS, moving(0.05), np.eye(3), STILL, STILL)
    assert said.words == "no bound of the transient: the attitude has to point the thrust that is left"
    assert keeps(free, hull, np.eye(3), STILL)
    assert not keeps(pointing, rov.dynamics, np.eye(3), STILL)


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "thruster", "force"),
    [("cube", "T1", 25.72), ("cube", "T6", -20.0), ("bluerov2_heavy", "T3", None), ("bluerov2_heavy", "T2", 25.0)],
)
def test_flights_leave_their_path_by_no_more_than_was_said_before_and_when_the_fault_was_found(name, thruster, force):
    """The fault comes on a level line; what the analysis said beforehand and what the log said both hold."""
    broken = {"state": "dead"} if force is None else {"state": "stuck", "force_N": force}
    scenario = {
        "schema_version": 1,
        "name": "fault",
        "model": str(MODELS / f"{name}.xml"),
        "duration_s": 40.0,
        "path": {"type": "line", "start_m": [0, 0, -5], "end_m": [30, 0, -5]},
        "initial": {"position_m": [0, 0, -5], "velocity_m_s": [0.3, 0, 0]},
        "guidance": {"speed_m_s": 0.3},
        "events": [thruster_event(12.0, [thruster], **broken)],
        "checks": FORCES_ONLY,
    }
    (flown,) = cube_sim.fly_many(scenario, [{}], threads=1, signals=["path_error.cross_track"])
    t, error = flown.signals["path_error.cross_track"].T
    worst = float(np.max(error[t >= 12.0]))
    file = MODELS / f"{name}.xml"
    read = ReadModel(file, load_model(str(file)))
    (case,) = fault_cases(vehicle(name), 0.3, faults=[Fault(thruster, force)], read=read)
    assert 1e-4 < worst <= case.transient.bound_m < 0.6
    assert worst <= case.foreseen.with_margin_m
    assert 0.5 * worst <= case.foreseen.farthest_m <= 3.0 * worst + 0.01
    assert not case.foreseen.going_on
    line = next(line for line in flown.log if "transient at most" in line.text)
    said = float(line.text.split("transient at most ")[1].split(" m")[0])
    assert float(np.max(error[t >= line.t])) <= said
    assert case.found_s >= line.t - 12.0


def test_every_single_fault_is_json(tmp_path):
    cases = fault_cases(vehicle("cube"), 0.3, faults=[Fault("T1"), Fault("T1", 51.44)])
    assert [case.follows for case in cases] == [True, True]
    assert [case.rest_m_s for case in cases] == [0.0, 0.0]
    assert cases[0].transient.bound_m < 0.1
    assert json.dumps([case.left for case in cases])
