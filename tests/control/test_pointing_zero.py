"""A force that the hull is turned to point is asked for no faster than it can be pointed."""

from __future__ import annotations

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY

import cube_sim
from cube_sim.control.course_trim import level_motion
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.pointing_zero import EASED, inverse_zeros, most_turning, turning_fast, zero_time
from cube_sim.control.yielding import WaterHold
from cube_sim.spatial import rotation_about
from cube_sim.wrench.health import Health


def left_of(name, folder, speed_m_s, dead=()):
    """The hull and what is left of a vehicle of the catalogue without some thrusters."""
    model = folder / "model.xml"
    model.write_text(catalogue()[name].make())
    vehicle = cube_sim.Vehicle.from_model(cube_sim.load_model(str(model)))
    working = np.array([0.0 if thruster in dead else 1.0 for thruster in vehicle.thrusters.names])
    health = Health(working, np.full(len(working), np.nan))
    hold = WaterHold.of(vehicle.dynamics, speed_m_s)
    return vehicle.dynamics, remaining_capability(vehicle.actuation_matrix, vehicle.thrusters.limits, health, hold=hold)


def slowest_zero_time(left, hull, speed_m_s):
    motion = level_motion(left, hull, speed_m_s)
    return 0.0 if motion is None else zero_time(left, hull, *motion)


def given_way(left):
    return np.linalg.solve(left.lost.T @ left.yielding, left.lost.T)


@pytest.mark.parametrize("speed_m_s", [0.1, 0.2])
def test_a_turn_that_grows_at_the_rate_of_a_zero_asks_for_no_force(speed_m_s, tmp_path):
    """Level ahead, its yaw growing as exp(z t): the fins' torque and the force that comes with it do not move it."""
    hull, left = left_of("torpedo_four_fins", tmp_path, speed_m_s)
    ahead = np.array([speed_m_s, 0.0, 0.0])
    slowest = float(max(inverse_zeros(left, hull, ahead, np.eye(3)[2]).real))
    assert np.isclose(slowest, slowest_zero_time(left, hull, speed_m_s), rtol=1e-3)
    z = 1.0 / slowest

    def pushed(rate, yaw=1e-6):
        turn, spin, change = np.array([[1.0, -yaw, 0.0], [yaw, 1.0, 0.0], [0.0, 0.0, 1.0]]), yaw * rate, yaw * rate**2
        flow = turn.T @ ahead
        kept = -np.cross([0.0, 0.0, spin], flow)
        wrench = hull.wrench(turn, np.r_[flow, 0.0, 0.0, spin], np.r_[kept, 0.0, 0.0, change], np.zeros(3))
        still = hull.wrench(np.eye(3), np.r_[ahead, np.zeros(3)], np.zeros(6), np.zeros(3))
        return float((given_way(left) @ (wrench - still))[0]) / yaw

    assert abs(pushed(z)) < 1e-4 * abs(pushed(0.0))
    assert pushed(0.5 * z) * pushed(2.0 * z) < 0.0


def test_the_centre_of_oscillation_has_a_zero_of_its_own(tmp_path):
    """Its bow rising as exp(z t), the hull going along as far as the turn drags it: no force beside the torque's."""
    speed_m_s = 0.25
    hull, left = left_of("torpedo_four_fins", tmp_path, speed_m_s)
    ahead, up = np.array([speed_m_s, 0.0, 0.0]), np.eye(3)[2]
    z = 1.0 / float(max(inverse_zeros(left, hull, ahead, up, centre=True).real))
    assert slowest_zero_time(left, hull, speed_m_s) >= 3.0 / z * 0.999
    dragged = left.record(hull.total_mass)["dragged"][0] @ np.eye(3)[1]

    def pushed(rate, pitch=1e-6):
        turn, spin, change = rotation_about(np.eye(3)[1], pitch), pitch * rate, pitch * rate**2
        flow = turn.T @ (ahead + spin * dragged)
        kept = turn.T @ (change * dragged) - np.cross([0.0, spin, 0.0], flow)
        wrench = hull.wrench(turn, np.r_[flow, 0.0, spin, 0.0], np.r_[kept, 0.0, change, 0.0], np.zeros(3))
        still = hull.wrench(np.eye(3), np.r_[ahead, np.zeros(3)], np.zeros(6), np.zeros(3))
        return given_way(left) @ (wrench - still) / pitch

    assert np.linalg.norm(pushed(z)) < 1e-3 * np.linalg.norm(pushed(0.0))
    assert pushed(0.5 * z) @ pushed(2.0 * z) < 0.0


def test_where_more_water_is_accelerated_ahead_than_aside_turning_moves_the_hull_outwards_first(tmp_path):
    """Without one of two thrusters astern it goes with its deck ahead: M_x x'' + D_x x' = (M_x - M_z) u q + D_x u a."""
    hull, left = left_of("six_two_astern_four_up", tmp_path, 0.2, dead=["T2"])
    M, D = np.diag(hull.total_mass), np.diag(hull.linear_damping)
    assert np.isclose(slowest_zero_time(left, hull, 0.2), (M[2] - M[0]) / D[0], rtol=0.02)


def test_none_where_the_hull_is_pushed_the_right_way_at_once(tmp_path):
    for name in ("three_astern_up", "cube"):
        hull, left = left_of(name, tmp_path, 0.4)
        assert slowest_zero_time(left, hull, 0.4) == 0.0


@pytest.mark.parametrize("rate_rad_s", [0.05, 0.3])
def test_a_hull_that_turns_fast_has_the_drag_of_its_rate(rate_rad_s, tmp_path):
    hull, _ = left_of("torpedo_four_fins", tmp_path, 0.1)
    turning = np.array([0.0, 0.0, 0.0, 0.0, 0.0, rate_rad_s])
    assert np.allclose(turning_fast(hull, rate_rad_s).linear_damping @ turning, hull.damping(turning), rtol=1e-12)


@pytest.mark.parametrize("name", ["torpedo", "torpedo_fins", "torpedo_four_fins"])
def test_a_torpedo_that_goes_slowly_turns_no_faster_than_its_loop_bears(name, tmp_path):
    """There its zeros are twice as slow as at rest: what its stern pushes against has grown to twice as much."""
    hull, left = left_of(name, tmp_path, 0.1)
    slow, fast = level_motion(left, hull, 0.1), level_motion(left, hull, 0.4)
    at_rest = zero_time(left, hull, *slow)
    rate = most_turning(left, hull, *slow, at_rest, 0.5)
    assert np.isclose(zero_time(left, turning_fast(hull, rate), *slow), EASED * at_rest, rtol=0.01)
    assert rate < 0.2
    assert most_turning(left, hull, *fast, 4.6, 0.5) == 0.5


def test_turning_pushes_a_hull_no_faster_than_it_goes(tmp_path):
    """Without one of two thrusters astern a hull is pushed by 0.65 m for each radian of yaw."""
    hull, left = left_of("five_survey", tmp_path, 0.15, dead=["T1"])
    motion = level_motion(left, hull, 0.15, 1.2, radius_m=3.0)
    rate = most_turning(left, hull, *motion, 5.0, 1.0)
    torque = np.array([0.0, 0.0, hull.total_mass[5, 5] * rate])
    force = -left.lost[:3] @ np.linalg.lstsq(left.lost[:3].T @ left.lost[:3], left.lost[3:].T @ torque, rcond=None)[0]
    M = np.diag(hull.total_mass)[:3]
    assert np.isclose(np.linalg.norm(force / M), 0.15, rtol=0.05)
    assert 0.2 < rate < 0.3


@pytest.mark.flight
@pytest.mark.parametrize("yaw_deg", [180.0, -90.0, 0.0])
def test_it_comes_to_the_trim_that_it_wishes_for(yaw_deg, tmp_path):
    """Turning at 1 rad/s it was pushed past it, flew stern first, and left its path by 0.9 m in the next corner."""
    model = tmp_path / "model.xml"
    model.write_text(catalogue()["five_survey"].make())
    scenario = {
        "schema_version": 1,
        "name": "corner",
        "model": str(model),
        "duration_s": 136.0,
        "initial": {"position_m": [-0.3, 0.8, -19.8], "attitude_deg": [0.0, 0.0, yaw_deg]},
        "path": {
            "type": "polyline",
            "points_m": [[0, 0, -20], [13.5, 0.3, -22.4], [19.6, -5.1, -21.8], [17.9, -15.2, -22]],
            "corner_radius_m": 2.0,
        },
        "guidance": {"speed_m_s": 0.14},
        "control": {"faults": "told"},
        "events": [{"kind": "thrusters", "at_s": 0.0, "thrusters": ["T1"], "state": "dead"}],
        "checks": FORCES_ONLY,
    }
    run = cube_sim.fly(scenario, record="none")
    t, error = run.signals["path_error.cross_track"].T
    # It comes to its line as exp(-t / 25 s), as slowly as the zero z lets it: its velocity loop takes 3 / z.
    assert error[t > 80.0].max() < 0.08
    assert error[t > 120.0].max() < 0.03


@pytest.mark.flight
@pytest.mark.parametrize("seed", [1, 2])
def test_a_torpedo_on_sensors_does_not_swing_about_its_path(seed, tmp_path):
    """At 0.1 m/s it needs no more force ahead than what a centimetre per second of error asks for aside.

    Turning to and fro at 0.3 rad/s it made 2 cm/s along its path: its stern pushed it more than its thrust did.
    """
    model = tmp_path / "model.xml"
    model.write_text(catalogue()["torpedo_four_fins"].make())
    scenario = {
        "schema_version": 1,
        "name": "slow",
        "model": str(model),
        "seed": seed,
        "duration_s": 170.0,
        "initial": {"position_m": [1.5, -0.2, -19.3], "attitude_deg": [0.0, 0.0, 140.0]},
        "path": {"type": "line", "start_m": [0, 0, -20], "end_m": [24, -30, -20]},
        "guidance": {"speed_m_s": 0.1},
        "navigation": {
            "dvl": {"rate_hz": 2.0, "noise_m_s": 0.01},
            "position": {"rate_hz": 0.5, "noise_m": 0.4},
        },
        "checks": FORCES_ONLY,
    }
    run = cube_sim.fly(scenario, record="none")
    t, error = run.signals["path_error.cross_track"].T
    arc = run.signals["target.arc_length"][:, 1]
    late = t > 110.0
    assert error[late].max() < 0.5
    assert arc[-1] - arc[late][0] > 0.5 * 0.1 * 60.0


@pytest.mark.flight
@pytest.mark.parametrize("attitude", [{"mode": "along_path"}, {"mode": "fixed", "attitude_deg": [0.0, 0.0, 121.0]}])
def test_a_slow_torpedo_keeps_to_its_circle(attitude, tmp_path):
    """Asked for forces as quickly as at its own speed, it swings through half a radian, metres beside its path."""
    (tmp_path / "model.xml").write_text(catalogue()["torpedo_four_fins"].make())
    scenario = tmp_path / "slow.yaml"
    scenario.write_text("schema_version: 1\nname: slow\ndescription: A slow circle.\nmodel: model.xml\n")
    settings = {
        "path": {"type": "circle", "centre_m": [0.0, 0.0, -20.0], "radius_m": 4.3, "direction": "right"},
        "initial": {"position_m": [4.6, 0.5, -18.5], "attitude_deg": [0.0, 0.0, -120.0]},
        "guidance.speed_m_s": 0.1,
        "control.attitude": attitude,
        "duration_s": 170.0,
        "checks": FORCES_ONLY,
    }
    run = cube_sim.run(scenario, settings, out=tmp_path / "run")
    late = run.signals["path_error.cross_track"]
    assert np.sqrt(np.mean(late[late[:, 0] >= 130.0, 1] ** 2)) < 0.05
