"""Scenarios flown on an estimate: what is measured, what is recorded, what is refused."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from ruamel.yaml import YAML
from scipy.stats import chi2
from support.flights import FORCES_ONLY, thruster_event, values
from support.places import SCENARIOS

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.mission.hull import flown_hull, initial_state
from cube_sim.mission.navigation import motion_of
from cube_sim.navigation.imu import IMU_MEMORY, IMU_NORMALS, ImuErrors, read_imu
from cube_sim.navigation.strapdown import rotation_vector
from cube_sim.recording.reading import read_recording
from cube_sim.scenario import load
from cube_sim.spatial import angle_between, rotation_about, rotation_from_quaternion
from cube_sim.vehicle.state import read_state

NAVIGATED = SCENARIOS / "cube_navigated.yaml"
UPRIGHT = {"type": "line", "start_m": [0, 0, -8], "end_m": [0, 0, -2]}
CORNER = {"type": "polyline", "points_m": [[0, 0, -8], [4, 0, -8], [4, 0, -4]], "corner_radius_m": 0.01}
SHORT = {"duration_s": 4.0, "checks": FORCES_ONLY}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return cube_sim.run(NAVIGATED, SHORT, tmp_path_factory.mktemp("navigated"))


def test_the_inertial_unit_adds_up_what_mujocos_own_sensors_feel():
    """Gyro and accelerometer of the model's site at the body origin, over 85 steps, tumbling and under thrust."""
    loaded = load(NAVIGATED, SHORT)
    model, vehicle = flown_hull(loaded)
    data = initial_state(model, vehicle, loaded.scenario)
    dof, steps, model.opt.timestep = vehicle.dof_address, 85, 0.002
    period_s = steps * model.opt.timestep
    data.qvel[dof : dof + 6] = 0.5, -0.3, 0.2, 1.0, -2.0, 0.7
    data.ctrl[:] = np.linspace(-0.6, 0.8, model.nu)
    unit, memory = ImuErrors(*[0.0] * 6).record(period_s), np.zeros(1, IMU_MEMORY)
    mujoco.mj_forward(model, data)
    for tick in range(6):
        turn, gained = np.eye(3), np.zeros(3)
        for _ in range(steps if tick else 0):
            rates, force = data.sensor("gyro").data.copy(), turn @ data.sensor("accelerometer").data
            mujoco.mj_step(model, data)
            mujoco.mj_forward(model, data)
            rates = 0.5 * (rates + data.sensor("gyro").data)
            turn = turn @ rotation_about(*_axis_and_angle(rates * model.opt.timestep))
            gained += 0.5 * (force + turn @ data.sensor("accelerometer").data) * model.opt.timestep
        motion = motion_of(read_state(vehicle, data))
        read_imu(unit, memory, *motion[1:], vehicle.gravity, period_s, np.zeros(IMU_NORMALS))
        found = memory["reading"][0]
        np.testing.assert_allclose(found[6:], data.sensor("gyro").data if tick else [1.0, -2.0, 0.7], atol=1e-12)
        if tick:
            np.testing.assert_allclose(rotation_about(*_axis_and_angle(found[:3] * period_s)), turn, atol=1e-6)
            np.testing.assert_allclose(found[3:6] * period_s, gained, atol=3e-5)
            assert np.linalg.norm(gained / period_s - data.sensor("accelerometer").data) > 0.1  # not what is felt last


def _axis_and_angle(vector):
    angle = np.linalg.norm(vector)
    return vector / angle, angle


@pytest.mark.flight
def test_at_a_tick_of_a_tenth_of_a_second_the_estimate_is_as_good_as_it_says():
    """Thrusters push otherwise at each tick; of rates read at the tick alone velocities had a NEES of 7 a number."""
    navigation = YAML(typ="safe").load(NAVIGATED)["navigation"]
    helix = SCENARIOS / "bluerov2_vectored_helix.yaml"
    changes = {"navigation": navigation, "control_period_s": 0.1, "duration_s": 60.0, "checks": FORCES_ONLY}
    runs = [cube_sim.run(helix, {**changes, "seed": seed}, record="none").signals for seed in range(8)]
    outcomes = np.concatenate([run["sensor_dvl.outcome"][:, 1] for run in runs])
    assert (outcomes > 0).sum() <= 3  # of 2,400; one in ten thousand is expected
    for name in ("position", "velocity", "attitude"):
        for k in (200, 400, 600):
            scaled = [run[f"navigation_error.{name}"][k, 1:] / run[f"navigation.{name}_sigma"][k, 1:] for run in runs]
            low, high = chi2.ppf([5e-4, 1 - 5e-4], 3 * len(runs))
            assert low < np.square(scaled).sum() < high, (name, k)


@pytest.mark.flight
def test_the_record_says_where_the_vehicle_is_and_where_it_believes_to_be(run):
    s = values(run)
    for k in range(0, 201, 25):
        R_F = rotation_from_quaternion(s["target.quaternion"][k])
        true = R_F.T @ (s["pose.position"][k] - s["target.position"][k])
        np.testing.assert_allclose(true, [*s["path_error.along"][k], *s["path_error.lateral"][k]], atol=1e-12)
        attitude = angle_between(s["reference.quaternion"][k], s["pose.quaternion"][k])
        assert s["path_error.attitude"][k, 0] == pytest.approx(attitude, abs=1e-12)
        R, R_true = (rotation_from_quaternion(s[f"{name}.quaternion"][k]) for name in ("navigation", "pose"))
        np.testing.assert_allclose(
            s["navigation_error.position"][k], s["navigation.position"][k] - s["pose.position"][k], atol=1e-12
        )
        error = R @ s["navigation.linear"][k] - R_true @ s["velocity.linear"][k]
        np.testing.assert_allclose(s["navigation_error.velocity"][k], error, atol=1e-12)
        angle = np.linalg.norm(s["navigation_error.attitude"][k])
        axis = s["navigation_error.attitude"][k] / angle
        np.testing.assert_allclose(rotation_about(axis, angle) @ R_true, R, atol=1e-9)
    assert np.linalg.norm(s["navigation_error.position"], axis=1).min() > 0.01


@pytest.mark.flight
def test_readings_are_recorded_as_they_arrive(run):
    expected = {"dvl": (5.0, 0.1), "depth": (10.0, 0.06), "heading": (10.0, 0.06), "position": (0.5, 0.5)}
    for name, (rate, delay) in expected.items():
        taken = run.signals[f"sensor_{name}.taken_at"]
        np.testing.assert_allclose(taken[:, 0] - taken[:, 1], delay, atol=1e-9)
        np.testing.assert_allclose(taken[:, 1], np.arange(len(taken)) / rate, atol=1e-9)
        assert set(run.signals[f"sensor_{name}.outcome"][:, 1]) <= {0.0, 1.0}
    imu = run.signals["sensor_imu.specific_force"]
    assert len(imu) == 201
    assert np.linalg.norm(imu[:, 1:], axis=1).mean() == pytest.approx(9.81, abs=0.1)


@pytest.mark.flight
def test_the_recording_reads_back_and_says_what_drifts(run):
    recording = read_recording(run.directory / "run.mcap")
    assert {"navigation", "navigation_error", "sensor_imu", "sensor_dvl"} <= {c.name for c in recording.channels}
    np.testing.assert_array_equal(recording.signals["navigation.position"], run.signals["navigation.position"])
    assert any("position is held by fixes" in line.text for line in recording.log)


@pytest.mark.flight
def test_the_same_seed_gives_the_same_bytes_and_another_seed_another_flight(run, tmp_path):
    again = cube_sim.run(NAVIGATED, SHORT, tmp_path / "again")
    assert (again.directory / "run.mcap").read_bytes() == (run.directory / "run.mcap").read_bytes()
    other = cube_sim.run(NAVIGATED, {**SHORT, "seed": 2}, tmp_path / "other")
    assert np.abs(other.signals["pose.position"] - run.signals["pose.position"]).max() > 1e-3


@pytest.mark.flight
def test_without_sensors_nothing_of_them_is_recorded_and_with_perfect_ones_the_flight_is_the_same(tmp_path):
    """The limit of no error: sensors of a millionth of the usual noise, every tick, without delay."""
    true = cube_sim.run(NAVIGATED, {**SHORT, "navigation": None}, tmp_path / "true")
    assert not any(name.startswith(("navigation", "sensor")) for name in true.signals)
    names = ("noise", "bias", "bias_walk")
    units = {"gyro": ("deg_s_per_sqrt_hz", "deg_s", "deg_s2_per_sqrt_hz")}
    units["accelerometer"] = ("m_s2_per_sqrt_hz", "m_s2", "m_s3_per_sqrt_hz")
    imu = {f"{of}_{n}_{u}": 0.0 for of, us in units.items() for n, u in zip(names, us, strict=True)}
    # The filter's allowance for what integration leaves; without it such readings contradict the estimate.
    imu["accelerometer_noise_m_s2_per_sqrt_hz"], imu["gyro_noise_deg_s_per_sqrt_hz"] = 1e-3, 0.01
    perfect = {
        "imu": imu,
        "dvl": {"rate_hz": 50, "noise_m_s": 1e-6, "bias_m_s": 0, "scale_error": 0, "delay_s": 0},
        "depth": {"rate_hz": 50, "noise_m": 1e-6, "bias_m": 0, "delay_s": 0},
        "heading": {"rate_hz": 50, "noise_deg": 1e-6, "bias_deg": 0, "delay_s": 0},
        "position": {"rate_hz": 50, "noise_m": 1e-6, "delay_s": 0},
        "initial": {"position_m": 1e-6, "velocity_m_s": 1e-6, "tilt_deg": 1e-6, "heading_deg": 1e-6},
    }
    run = cube_sim.run(NAVIGATED, {**SHORT, "navigation": perfect}, tmp_path / "perfect")
    difference = run.signals["pose.position"] - true.signals["pose.position"]
    assert np.abs(difference).max() < 1e-3
    assert np.abs(run.signals["navigation_error.position"][:, 1:]).max() < 1e-3


@pytest.mark.flight
def test_a_lost_thruster_is_found_and_flown_without_on_the_estimate(tmp_path):
    """Diagnosis looks at thrusters, reconfiguration at the estimate."""
    events = [thruster_event(2.0, ["T1", "T4"])]
    run = cube_sim.run(NAVIGATED, {**SHORT, "duration_s": 12.0, "events": events}, tmp_path / "run")
    believed = run.signals["health.believed"][-1, 1:]
    np.testing.assert_array_equal(believed == 0.0, [True, False, False, True, False, False, False, False])
    assert run.signals["path_error.cross_track"][-1, 1] < 1.0


@pytest.mark.parametrize(
    ("overrides", "sentence"),
    [
        ({"navigation.imu": None}, r"navigation\.imu: no estimate without an inertial unit"),
        ({"navigation.dvl": None, "navigation.position": None}, r"nothing sees the velocity"),
        ({"navigation.dvl.rate_hz": 80.0}, r"at most one reading per control period: 80 Hz against 50 Hz"),
        ({"control_period_s": 0.2}, r"10 Hz against 5 Hz \(override control_period_s\)"),
        ({"navigation.depth.delay_s": 11.0}, r"must be at most 10"),
        ({"navigation.heading.noise_deg": 0.0}, r"must be at least 1e-06"),
        ({"navigation.sonar": {}}, r"unknown key"),
    ],
)
def test_a_set_that_cannot_work_is_refused(overrides, sentence):
    with pytest.raises(ScenarioError, match=sentence):
        load(NAVIGATED, {**SHORT, **overrides})


def test_a_check_of_a_sensor_that_is_not_there_is_refused(tmp_path):
    checks = [{"kind": "signal", "signal": "sensor_position.surprise", "statistic": "mean", "at_most": 3.0}]
    with pytest.raises(ScenarioError, match=r"no signal 'sensor_position\.surprise' is recorded"):
        cube_sim.run(NAVIGATED, {**SHORT, "checks": checks, "navigation.position": None}, tmp_path / "out")


def test_the_rotation_vector_undoes_a_rotation():
    axis = np.array([0.6, 0.0, -0.8])
    for angle in (0.0, 1e-7, 0.3, 3.0):
        np.testing.assert_allclose(rotation_vector(rotation_about(axis, angle)), angle * axis, atol=1e-12)


@pytest.mark.parametrize(
    ("changes", "heading"),
    [
        ({}, "; heading is held by the compass;"),
        ({"path": UPRIGHT}, "; the nose points steeply up or down and the compass reads nothing: heading drifts with"),
        ({"path": UPRIGHT, "control.attitude": {"mode": "fixed", "attitude_deg": [0, 20, 0]}}, "held by the compass;"),
        ({"control.attitude": {"mode": "fixed", "attitude_deg": [0, -80, 0]}}, "reads nothing: heading is seen while"),
        ({"path": CORNER}, "; heading is held by the compass on 50% of the path;"),
        ({"control.attitude": {"mode": "free"}}, "; heading is held by the compass, but where the nose points steeply"),
    ],
)
def test_the_log_says_what_holds_the_heading_on_this_path_in_this_attitude(changes, heading, tmp_path):
    run = cube_sim.run(NAVIGATED, SHORT | changes | {"duration_s": 0.2}, tmp_path)
    (said,) = [line.text for line in read_recording(run.directory / "run.mcap").log if "navigation:" in line.text]
    assert heading in said


def test_a_scale_error_the_filter_is_not_linear_in_is_refused():
    with pytest.raises(ScenarioError, match=r"navigation.dvl.scale_error: .*0\.1"):
        load(NAVIGATED, {"navigation.dvl.scale_error": 0.3})
