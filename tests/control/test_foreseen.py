"""How far a hull will leave its path after a fault: the law flown ahead, and flights that do what was foreseen."""

from __future__ import annotations

import numpy as np
import pytest
from flights.faulted import said_and_flown, said_of
from scipy.integrate import solve_ivp
from scipy.optimize import linprog, lsq_linear
from support.both_loops import assert_same_flight
from support.flights import FORCES_ONLY, thruster_event
from support.places import MODELS
from support.vehicles import vehicle

import cube_sim
from cube_sim.control.foreseen import LEAST_M, MARGIN, Ahead, Foreseen, foreseen, in_metres
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.left_thrusters import LeftThrusters, make_wrench, spin_up
from cube_sim.control.transient import Transient
from cube_sim.control.yielding import WaterHold
from cube_sim.flight import Flight
from cube_sim.mission import fault_response
from cube_sim.spatial import State, skew
from cube_sim.vehicle.laws.hull_motion import inverse_dynamics_of_arrays
from cube_sim.wrench.health import Health

AT_REST = State(np.zeros(3), np.array([1.0, 0, 0, 0]), np.eye(3), np.zeros(3), np.zeros(3))


def left_of(name, thruster=0, force=np.nan):
    """What is left of a vehicle whose thruster is dead or stuck."""
    one = vehicle(name)
    health = Health.whole(len(one.thrusters.names)).with_thruster(thruster, 0.0, force)
    A, limits = one.actuation_matrix, one.thrusters.limits
    return remaining_capability(A, limits, health, hold=WaterHold.of(one.dynamics, 0.3))


def thrusters_of(left, lag_s=0.02):
    return LeftThrusters.of(left.budget, np.full(left.budget.matrix.shape[1], lag_s))


class _Asks:
    """A law that asks for nothing but what its thrusters hold."""

    def __init__(self, hull, current):
        class _Loops:
            dynamics = hull

        self.loops, self.current = _Loops, np.array(current)

    def decide(self, state, applied, dt, ratio):
        class _Decision:
            wrench, secondary = np.zeros(6), np.zeros(6)

            class view:  # noqa: N801 - stands for one
                error = state.position

        return _Decision


@pytest.mark.parametrize("name", ["cube", "bluerov2_heavy", "rov6"])
def test_a_hull_that_is_pushed_moves_as_its_equations_of_motion_say(name):
    """Against an independent integration of the same equations, tumbling: to 2 % of the way after two seconds."""
    hull, current = vehicle(name).dynamics, np.array([0.2, -0.1, 0.05])
    push = hull.total_mass @ np.array([0.3, -0.1, 0.1, 0.4, 0.2, -0.5])
    none = thrusters_of(left_of(name))._replace(held=push)
    none = none._replace(low=0.0 * none.low, high=0.0 * none.high)
    off = Ahead(_Asks(hull, current), none, AT_REST, 0.0 * none.low, np.zeros(6), 0.02, in_place=True).fly(2.04)

    def slope(t, y):
        R, nu = y[:9].reshape(3, 3), y[12:]
        motion = np.linalg.solve(
            hull.total_mass, push - inverse_dynamics_of_arrays(hull.record, R, nu, np.zeros(6), current)
        )
        return np.concatenate([(R @ skew(nu[3:])).ravel(), R @ nu[:3], motion])

    start = np.concatenate([np.eye(3).ravel(), np.zeros(9)])
    exact = solve_ivp(slope, (0.0, 2.0), start, rtol=1e-9, atol=1e-12).y[9:12, -1]
    assert off[-1] == pytest.approx(np.linalg.norm(exact), rel=0.02)


def test_thrusters_make_a_wrench_that_they_can_and_the_nearest_of_one_that_they_cannot():
    rng, left = np.random.default_rng(3), left_of("bluerov2_heavy", 2)
    thrusters, nothing = thrusters_of(left), np.zeros(6)
    for _ in range(20):
        forces = rng.uniform(thrusters.low, thrusters.high)
        wrench, asked, applied = thrusters.matrix @ forces, np.zeros(7), np.zeros(6)
        make_wrench(thrusters, wrench, nothing, asked, applied)
        np.testing.assert_allclose(applied, wrench, atol=1e-3)
        make_wrench(thrusters, 4.0 * wrench, nothing, asked, applied)
        scaled = thrusters.scale[:, None] * thrusters.matrix
        exact = lsq_linear(scaled, 4.0 * thrusters.scale * wrench, (thrusters.low, thrusters.high), tol=1e-12)
        missed = np.linalg.norm(thrusters.scale * (applied - 4.0 * wrench))
        assert missed == pytest.approx(np.sqrt(2.0 * exact.cost), rel=1e-4)


def test_of_what_yields_the_largest_share_is_made_that_there_is():
    """Against a linear programme over the forces."""
    rng, left = np.random.default_rng(5), left_of("cube", 1, 20.0)
    thrusters, cut = thrusters_of(left), 0
    for _ in range(20):
        secondary = np.concatenate([np.zeros(3), rng.uniform(-40.0, 40.0, 3)])
        primary = thrusters.held + thrusters.matrix @ (0.5 * rng.uniform(thrusters.low, thrusters.high))
        asked, applied = np.zeros(7), np.zeros(6)
        make_wrench(thrusters, primary + secondary, secondary, asked, applied)
        columns = np.column_stack([thrusters.matrix, -secondary])
        bounds = [*zip(thrusters.low, thrusters.high, strict=True), (0.0, 1.0)]
        best = linprog([0.0] * 7 + [-1.0], A_eq=columns, b_eq=primary - thrusters.held, bounds=bounds)
        np.testing.assert_allclose(applied, primary + best.x[-1] * secondary, atol=0.02)
        cut += best.x[-1] < 0.99
    assert cut > 5


def test_forces_follow_behind_their_lag():
    thrusters, forces, wrench = thrusters_of(left_of("cube"), 0.2), np.zeros(7), np.zeros(6)
    for _ in range(10):
        spin_up(thrusters, np.full(7, 3.0), forces, 0.05, wrench)
    np.testing.assert_allclose(forces, 3.0 * (1.0 - np.exp(-0.5 / 0.2)), rtol=1e-12)
    np.testing.assert_allclose(wrench, thrusters.held + thrusters.matrix @ forces)


def test_a_thruster_that_is_not_known_to_be_stuck_pushes_whatever_it_is_asked_for():
    left = left_of("cube")
    thrusters, wrench = thrusters_of(left, 0.0), np.zeros(6)
    asked, forces = np.arange(1.0, 8.0), np.zeros(7)
    spin_up(thrusters.with_fault(3, -9.0), asked, forces, 0.05, wrench)
    np.testing.assert_allclose(wrench, left.held + thrusters.matrix @ np.where(np.arange(7) == 3, -9.0, asked))


def test_what_is_said_of_a_flight_ahead():
    there_and_back, away = np.array([0.0, 0.2, 0.4, 0.2, 0.1]), np.linspace(0.0, 4.0, 50)
    assert foreseen(there_and_back) == Foreseen(0.4, MARGIN * 0.4 + LEAST_M)
    assert foreseen(there_and_back, 2.0 * there_and_back, 0.3) == Foreseen(0.4, MARGIN * 0.8 + LEAST_M + 0.3)
    assert foreseen(away).going_on
    assert foreseen(np.array([0.1, np.inf])).words.startswith("foreseen beyond what can be told")
    assert in_metres(1e-9) == "0.001"
    bounded, free = Transient(0.02, ""), Transient(np.inf, "it has to turn")
    assert bounded.words_with(None) == "transient at most 0.02 m"
    texts = [each.words_with(ahead) for each in (bounded, free) for ahead in (foreseen(there_and_back), foreseen(away))]
    assert texts == [
        "transient at most 0.81 m, 0.4 m foreseen",
        "transient at most 8 m, 4 m foreseen",
        "transient foreseen 0.4 m, 0.81 m with a margin; no bound: it has to turn",
        "transient foreseen 4 m, 8 m with a margin in 30 s, and farther later; no bound: it has to turn",
    ]
    assert [said_of(text) for text in texts] == [(0.81, 0.4), (8.0, 4.0), (0.81, 0.4), (8.0, 4.0)]
    assert said_of("no bound of the transient: it has to turn") == (None, None)


def line(model, events, **more):
    return {
        "schema_version": 1,
        "name": "fault",
        "model": str(MODELS / f"{model}.xml"),
        "duration_s": 26.0,
        "path": {"type": "line", "start_m": [0, 0, -5], "end_m": [30, 0, -5]},
        "initial": {"position_m": [0, 0, -5], "velocity_m_s": [0.3, 0, 0]},
        "guidance": {"speed_m_s": 0.3},
        "events": events,
        "checks": FORCES_ONLY,
    } | more


STUCK, POINTS, TURNS, HANGS = (
    ("cube", [thruster_event(8.0, ["T1"], "stuck", force_N=51.44)]),
    ("bluerov2_heavy", [thruster_event(8.0, ["T1", "T2", "T3"])]),
    ("bluerov2_heavy", [thruster_event(8.0, ["T2"], "stuck", force_N=30.0), thruster_event(13.0, ["T3"])]),
    ("bluerov2_vectored", [thruster_event(8.0, ["T5"], "stuck", force_N=20.0)]),
)


@pytest.mark.flight
@pytest.mark.parametrize(("model", "events"), [STUCK, POINTS, TURNS, HANGS])
def test_flights_do_what_was_foreseen_when_the_fault_was_found(model, events):
    (flown,) = cube_sim.fly_many(line(model, events), [{}], threads=1, signals=["path_error.cross_track"])
    t, error = flown.signals["path_error.cross_track"].T
    lines = [line for line in flown.log if "transient" in line.text]
    assert lines
    for k, said in enumerate(lines):
        at_most, ahead = said_of(said.text)
        end = lines[k + 1].t if k + 1 < len(lines) else np.inf
        worst = float(np.max(error[(t >= said.t) & (t <= end)]))
        assert worst <= at_most
        assert ahead <= 3.0 * worst + LEAST_M
        assert ahead >= 0.5 * worst - LEAST_M


@pytest.mark.flight
def test_a_hull_that_nothing_drives_any_more_is_said_to_go_as_far_as_it_coasts():
    flight = Flight(line("torpedo", [thruster_event(8.0, ["propeller"])], duration_s=20.0))
    flight.fly(flight.mission.scenario.ticks)
    said = next(said for said in flight.log if "transient" in said.text)
    assert "SAFE" in said.text
    t, x, *_ = flight.signals["pose.position"].T
    coasted = float(x[-1] - x[np.searchsorted(t, said.t)])
    assert said_of(said.text)[0] > coasted > 0.3


@pytest.mark.flight
def test_both_loops_foresee_the_same_on_sensors(monkeypatch):
    sensors = {"dvl": {"rate_hz": 5.0, "noise_m_s": 0.01}, "position": {"rate_hz": 0.5, "noise_m": 0.3}}
    scenario = line("bluerov2_heavy", TURNS[1], duration_s=15.0, navigation=sensors)
    assert assert_same_flight(scenario, {}, monkeypatch) > 0.7


@pytest.mark.flight
def test_to_look_ahead_changes_no_bit_of_the_flight(monkeypatch):
    flights = []
    for looks in (True, False):
        if not looks:
            monkeypatch.setattr(fault_response, "transient_ahead", lambda *_: None)
        flight = Flight(line("bluerov2_heavy", TURNS[1], duration_s=18.0, control={"attitude": {"mode": "free"}}))
        flight.fly(flight.mission.scenario.ticks)
        flights.append(flight)
    assert any("foreseen" in said.text for said in flights[0].log)
    assert not any("foreseen" in said.text for said in flights[1].log)
    for name, rows in flights[0].signals.items():
        assert rows.tobytes() == flights[1].signals[name].tobytes(), name


@pytest.mark.flight
def test_sensors_that_know_less_of_the_place_leave_more_room(monkeypatch):
    def at_most(**navigation):
        scenario = line("cube", [thruster_event(8.0, ["T1"])], duration_s=10.0, **navigation)
        flight = Flight(scenario)
        flight.fly(flight.mission.scenario.ticks)
        return next(said_of(said.text)[0] for said in flight.log if "transient" in said.text)

    sensors = {"dvl": {"rate_hz": 5.0, "noise_m_s": 0.01}, "initial": {"position_m": 1.0}}
    assert at_most(navigation=sensors) > at_most() + 2.0


@pytest.mark.campaign
@pytest.mark.parametrize("first", range(3000, 3200, 25))
def test_no_drawn_flight_goes_beyond_what_was_said(first, tmp_path):
    """Two faults, sharp corners, sensors, ticks of 10 to 100 ms, free and looking attitudes, known wrongly."""
    rows = [row for seed in range(first, first + 25) for row in said_and_flown(seed, tmp_path)]
    assert len(rows) > 10
    beyond = [row for row in rows if row["beyond"]]
    assert len(beyond) <= 1, [(row["seed"], row["vehicle"], row["flown_m"], row["said"]) for row in beyond]
