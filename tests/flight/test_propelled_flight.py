"""A vehicle whose propeller works in its inflow: limits and commands follow it in both loops, and the pace waits."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.places import MODELS, SCENARIOS
from support.propelled_torpedo import FASTEST, drag, line_scenario, thrust

import cube_sim
from cube_sim.commands.analysis_report import ahead_limits, report_on
from cube_sim.control.moment_budget import RESERVE
from cube_sim.flight import Flight
from cube_sim.spatial import rotation_from_quaternion

pytestmark = pytest.mark.flight

REMUS = SCENARIOS / "remus100_propeller.yaml"
AHEAD = 4
"""Column of `actuation.limits` with the propeller's F_max+."""

STILL = {"control.current_time_s": None}
"""The water is known to be at rest, so that the inflow is the vehicle's own motion."""
WEAK = {"kind": "thrusters", "thrusters": ["propeller"], "state": "weak", "efficiency": 0.4}


def flown(path, settings=None):
    flight = Flight(path, settings or {})
    flight.fly_to_its_end()
    return flight


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"control.faults": "diagnosed", "events": [WEAK | {"at_s": 2.0}]},
        {"navigation": {}, "current_m_s": [0.1, 0.1, 0.0]},
        {"control.current_time_s": 4.0, "control.disturbance_time_s": 1.0, "current_m_s": [-0.2, 0.1, 0.0]},
        {"allocation.method": "clipped_pseudo_inverse"},
        {"allocation.method": "enumerate", "duration_s": 1.0},
    ],
    ids=["plain", "faults", "navigated", "current", "baseline", "enumerated"],
)  # fmt: skip
def test_both_loops_fly_the_same(tmp_path, monkeypatch, settings):
    share = assert_same_flight(line_scenario(tmp_path), {"duration_s": 6.0, **settings}, monkeypatch)
    if "allocation.method" not in settings and "navigation" not in settings:
        assert share > 0.65


def test_beside_fins_both_loops_fly_the_same(monkeypatch):
    """REMUS 100 with its propeller in its inflow: the sharing between fins and thrusters knows its limits."""
    settings = {"duration_s": 8.0, "checks": [{"kind": "allowed_forces"}]}
    assert assert_same_flight(REMUS, settings, monkeypatch) > 0.7


BATTERY = {"open_circuit_V": [24.0, 28.0], "resistance_ohm": 0.4, "capacity_Wh": 0.5, "charge": 0.9}


def test_on_a_battery_both_loops_fly_the_same(monkeypatch):
    settings = {"duration_s": 8.0, "checks": [{"kind": "allowed_forces"}], "battery": BATTERY}
    sheared = {"current_profile": {"depths_m": [0.0, 20.0], "velocities_m_s": [[0.1, 0.0, 0.0], [0.0, 0.2, 0.0]]}}
    for more in ({}, sheared):
        assert assert_same_flight(REMUS, settings | more, monkeypatch) > 0.7


def test_every_row_of_its_power_is_torque_times_speed():
    """In a current, on a battery that sags: by the recorded motion, and the table of K_Q as the file has it."""
    current = np.array([0.1, -0.2, 0.0])
    flight = flown(REMUS, {"duration_s": 20.0, "checks": [{"kind": "allowed_forces"}], "battery": BATTERY,
                           "current_m_s": current.tolist()})  # fmt: skip
    s = {name: rows[:, 1:] for name, rows in flight.signals.items()}
    R = np.array([rotation_from_quaternion(q) for q in s["pose.quaternion"]])
    v = s["velocity.linear"] - np.einsum("nji,j->ni", R, current)
    voltage = s["power.voltage"][:, 0]
    force, u_a = s["thrusters.force"][:, 0], (1.0 - 0.056) * v[:, 0]
    # delivered force and inflow say the rotation: T = rho D^3 n (a D n + b u_a), n > 0
    rho, D, (a, b), (a_Q, b_Q) = (
        1030.0,
        0.14,
        *((x[0], (x[1] - x[0]) / 0.6632) for x in ((0.4566, 0.1798), (0.07, 0.0312))),
    )
    pushes = force > 0.5  # it begins with its brakes on, where force and inflow have two answers
    assert pushes.mean() > 0.9
    half = b * u_a / (2.0 * a * D)
    n = (-half + np.sqrt(half**2 + np.maximum(force, 0.5) / (0.9 * rho * D**3) / (a * D)))[pushes]
    power = rho * D**4 * n * (a_Q * D * n + b_Q * u_a[pushes]) * 2.0 * np.pi * n / 0.7
    drawn, charge = s["power.motor"][:, 0], s["power.charge"][:, 0]
    np.testing.assert_allclose(drawn[pushes], power, rtol=1e-8)
    np.testing.assert_allclose(voltage, 24.0 + 4.0 * charge - 0.4 * drawn / voltage, rtol=1e-11)
    current_A = drawn / voltage
    drained = np.concatenate([[0.0], np.cumsum(0.02 * (drawn + 0.4 * current_A**2))])[:-1]
    np.testing.assert_allclose(charge, 0.9 - drained / 1800.0, rtol=1e-11)
    assert charge[0] - charge[-1] > 0.05
    assert voltage.min() < 27.4
    energy = np.trapezoid(drawn, flight.signals["power.motor"][:, 0])
    assert s["power.energy"][-1, 0] == pytest.approx(energy, rel=1e-11)


def test_a_flight_has_the_limits_that_the_analysis_tells():
    """The shipped scenario, once it is at its speed, and `analyze --speed`."""
    flight = flown(REMUS, {"duration_s": 40.0, "checks": [{"kind": "allowed_forces"}]})
    limits = flight.signals["actuation.limits"][-1, 1:]
    speed = flight.signals["velocity.linear"][-1, 1]
    told = report_on(MODELS / "remus100_propeller.xml", speed_m_s=float(speed))
    assert told.analysis.verdict.follows
    np.testing.assert_allclose(limits, ahead_limits(told.vehicle, told.speed_m_s).ravel(), rtol=2e-3)
    assert limits[3] < 0.75 * told.vehicle.thrusters.limits[0, 3]


def test_its_model_is_remus_100_but_for_propeller_and_ballast():
    given, taken = (cube_sim.load_model(MODELS / f"{name}.xml") for name in ("remus100_propeller", "remus100"))
    ours, theirs = (
        {(model.numeric(i).name, *model.numeric(i).data) for i in range(model.nnumeric)} for model in (given, taken)
    )
    changed = {name for name, *_ in ours ^ theirs if not name.startswith(("propeller:", "cube_sim:"))}
    assert changed == {"hull:volume"}
    for field in ("body_mass", "body_inertia", "body_ipos", "site_pos", "site_quat", "actuator_ctrlrange"):
        np.testing.assert_array_equal(getattr(given, field), getattr(taken, field))


def test_the_limits_are_those_of_the_inflow_at_every_tick(tmp_path):
    signals = flown(line_scenario(tmp_path, 0.8, 20.0), STILL).signals
    limits, velocity = signals["actuation.limits"], signals["velocity.linear"]
    assert np.array_equal(limits[:, 0], velocity[:, 0])
    expected = [max(thrust(FASTEST, u), 0.0) for u in velocity[:, 1].tolist()]
    np.testing.assert_allclose(limits[:, AHEAD], expected, rtol=1e-9)
    demanded = signals["thrusters.force_demanded"][:, 1]
    assert np.all(demanded <= limits[:, AHEAD] + 1e-9)
    assert np.all(demanded >= limits[:, 1] - 1e-9)


def test_the_force_asked_for_is_made_at_speed(tmp_path):
    """Once the rotor has come to its speed: the command for a force counts the inflow in."""
    signals = flown(line_scenario(tmp_path, 0.8, 40.0), STILL).signals
    late = slice(-200, None)
    asked, made = (signals[name][late, 1] for name in ("thrusters.force_demanded", "thrusters.force"))
    np.testing.assert_allclose(made, asked, rtol=1e-3)
    assert made[-1] == pytest.approx(drag(0.8), rel=1e-3)
    assert abs(signals["velocity.linear"][-1, 1] - 0.8) < 1e-3


def test_at_its_speed_limit_the_pace_waits_and_nothing_saturates(tmp_path):
    """Asked for 2 m/s it goes at the speed whose drag takes all that the inflow leaves but the reserve."""
    flight = flown(line_scenario(tmp_path, 2.0, 60.0))
    signals = flight.signals
    speeds = np.linspace(0.5, 2.0, 15001)
    spare = [(1.0 - RESERVE) * thrust(FASTEST, u) - drag(u) for u in speeds.tolist()]
    fastest = float(speeds[np.argmin(np.abs(spare))])
    late = signals["velocity.linear"][-1000:, 1]
    np.testing.assert_allclose(late, np.full(late.shape, fastest), rtol=0.01)
    made, most = signals["thrusters.force"][-1000:, 1], signals["actuation.limits"][-1000:, AHEAD]
    assert np.all(made < 0.98 * most)
    assert abs(signals["path_error.cross_track"][-1, 1]) < 0.05
    assert any("cannot keep 2 m/s along the path" in line.text for line in flight.log)


def test_no_fault_is_found_where_there_is_none(tmp_path):
    """What the propeller should give is reckoned in its inflow: half of its rest thrust is none missing."""
    signals = flown(line_scenario(tmp_path, 2.0, 30.0), {"control.faults": "diagnosed"}).signals
    np.testing.assert_array_equal(signals["health.believed"][:, 1:], 1.0)


def test_a_current_that_nobody_knows_is_no_fault():
    """The first seconds believe the water to be at rest, and a propeller gives another force in water that moves."""
    settings = {"duration_s": 12.0, "current_m_s": [0.0, 0.2, 0.0], "control.faults": "diagnosed"}
    signals = flown(REMUS, {**settings, "checks": [{"kind": "allowed_forces"}]}).signals
    np.testing.assert_array_equal(signals["health.believed"][:, 1:], 1.0)


def test_a_half_dead_propeller_is_found_at_speed(tmp_path):
    event = WEAK | {"at_s": 15.0}
    signals = flown(line_scenario(tmp_path, 0.8, 25.0), {"control.faults": "diagnosed", "events": [event]}).signals
    assert signals["health.believed"][-1, 1] == pytest.approx(0.4, abs=0.02)


def test_a_snapshot_goes_on_to_the_bit(tmp_path):
    path = line_scenario(tmp_path, 0.8, 8.0)
    whole, cut = Flight(path, {"control.faults": "diagnosed"}), Flight(path, {"control.faults": "diagnosed"})
    whole.go_on(400)
    cut.go_on(200)
    other = Flight(path, {"control.faults": "diagnosed"})
    other.restore(cut.snapshot())
    other.go_on(200)
    np.testing.assert_array_equal(other.mission.data.qpos, whole.mission.data.qpos)
    np.testing.assert_array_equal(other.mission.data.act, whole.mission.data.act)
