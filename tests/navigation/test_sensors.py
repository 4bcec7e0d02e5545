"""Sensors: what they read, how wrong they are, when they speak, and that none hears of another."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from support.navigation_motion import (
    AIDS,
    DEG,
    DT,
    GRAVITY,
    IMU,
    INITIAL,
    KNOWN,
    expected,
    navigate,
    straight,
    truths,
    weaving,
)

from cube_sim.navigation.aid import aid_records
from cube_sim.navigation.depth import Depth
from cube_sim.navigation.dvl import Dvl
from cube_sim.navigation.expectation import difference
from cube_sim.navigation.heading import Heading
from cube_sim.navigation.imu import ImuErrors
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.navigator import Navigator
from cube_sim.navigation.observability import what_drifts
from cube_sim.navigation.sampling import Sampling
from cube_sim.spatial import quaternion_from_euler, rotation_from_quaternion

REST = Motion(np.array([1.0, 2.0, -8.0]), np.zeros(3), np.eye(3), np.zeros(3))


def readings(ticks, aid):
    return {f.reading.tick: f.reading.value for tick in ticks for f in tick.fusions if f.reading.aid == aid}


def at_rest(errors, seed, period):
    """An inertial unit alone, and a function that reads it at rest."""
    navigator = Navigator(errors, [], KNOWN, REST, seed, GRAVITY, period)

    def read():
        navigator.update(REST)
        return navigator.inertial[:6].copy()

    return navigator, read


def test_the_noise_of_the_inertial_unit_has_the_stated_density():
    """A mean over T seconds of white noise of density N scatters by N / sqrt(T), whatever the period."""
    errors = ImuErrors(0.01, 0.2, 0.0, 0.0, 0.0, 0.0)
    for period in (0.02, 0.1):
        _, read = at_rest(errors, 3, period)
        n = round(1.0 / period)
        means = np.array([np.mean([read() for _ in range(n)], axis=0) for _ in range(400)])
        scatter = means.std(axis=0) / errors.noise
        np.testing.assert_allclose(scatter, 1.0, atol=0.13)  # 400 samples: 0.035 one standard deviation
        np.testing.assert_allclose(means.mean(axis=0), [0, 0, 0, 0, 0, 9.81], atol=4 * 0.2 / 20)


def test_its_biases_are_drawn_once_and_wander_as_stated():
    errors = ImuErrors(0.0, 0.0, 0.02, 0.3, 0.001, 0.02)
    starts, steps = [], []
    for seed in range(300):
        navigator, read = at_rest(errors, seed, 0.1)
        first = read() - np.array([0, 0, 0, 0, 0, 9.81])
        np.testing.assert_allclose(first, navigator.true_biases, atol=1e-14)
        for _ in range(40):
            read()
        starts.append(first)
        steps.append(navigator.true_biases - first)
    np.testing.assert_allclose(np.std(starts, axis=0) / errors.bias, 1.0, atol=0.17)
    np.testing.assert_allclose(np.std(steps, axis=0) / (errors.bias_walk * np.sqrt(4.0)), 1.0, atol=0.17)


def test_one_sensor_more_or_noisier_changes_no_other_sensor():
    motions = truths(weaving, 4.0)
    all_of_them = navigate(motions, 5)
    fewer = navigate(motions, 5, aids=[AIDS[1], AIDS[2]])
    noisier = navigate(motions, 5, aids=[replace(AIDS[0], noise=1.0), *AIDS[1:]])  # type: ignore[type-var]
    for aid, other in ((1, 0), (2, 1)):
        a, b, c = readings(all_of_them, aid), readings(fewer, other), readings(noisier, aid)
        assert len(a) > 20
        for tick, value in a.items():
            np.testing.assert_array_equal(value, b[tick])
            np.testing.assert_array_equal(value, c[tick])
    assert not np.array_equal(readings(all_of_them, 0)[0], readings(noisier, 0)[0])


def test_the_same_seed_gives_the_same_estimate_and_another_another():
    motions = truths(weaving, 2.0)
    a, b, c = (navigate(motions, seed)[-1].estimate for seed in (7, 7, 8))
    np.testing.assert_array_equal(a.state.position, b.state.position)
    np.testing.assert_array_equal(a.covariance, b.covariance)
    assert np.abs(a.state.position - c.state.position).min() > 1e-6


@pytest.mark.parametrize(("rate", "delay"), [(50.0, 0.0), (5.0, 0.1), (8.0, 0.03), (0.3, 1.0), (33.3, 0.02)])
def test_readings_come_at_their_rate_and_after_their_delay(rate, delay):
    navigator = Navigator(IMU, [Depth(Sampling(rate, delay), 0.1, 0.0)], INITIAL, REST, 1, GRAVITY, DT)
    taken, late = [], []
    for tick in range(1001):
        for reading in navigator.update(REST):
            taken.append(int(reading["tick"]))
            late.append(tick - int(reading["tick"]))
    ideal = np.arange(len(taken)) / rate
    error = np.array(taken) * DT - ideal
    assert error.min() > -1e-9
    assert error.max() < DT  # each at the first tick that is not too early, and no lag adds up
    assert set(late) == {int(np.ceil(delay / DT - 1e-9))}
    assert len(taken) == pytest.approx((20.0 - delay) * rate + 1, abs=1.01)


def test_a_doppler_log_on_an_arm_feels_the_turn():
    dvl = Dvl(Sampling(5.0), 0.01, 0.0, 0.0, (1.0, 0.0, 0.0))
    R = rotation_from_quaternion(quaternion_from_euler(0.0, 0.0, np.pi / 2))
    motion = Motion(np.zeros(3), np.array([0.0, 0.5, 0.1]), R, np.array([0.0, 0.0, 0.2]))
    np.testing.assert_allclose(expected(dvl, motion, np.zeros(4)).value, [0.5, 0.2, 0.1], atol=1e-15)
    np.testing.assert_allclose(
        expected(dvl, motion, np.array([0.1, 0.01, 0.02, 0.03])).value, [0.56, 0.24, 0.14], atol=1e-15
    )


def test_depth_is_positive_downwards():
    depth = Depth(Sampling(1.0), 0.1, 0.1)
    assert expected(depth, REST, np.array([0.5])).value == pytest.approx(8.5)


def test_a_compass_reads_from_x_towards_y_wraps_and_is_silent_nose_up():
    compass = Heading(Sampling(10.0), 0.01, 0.01)

    def read(roll, pitch, yaw):
        R = rotation_from_quaternion(quaternion_from_euler(*np.radians([roll, pitch, yaw])))
        return expected(compass, Motion(np.zeros(3), np.zeros(3), R, np.zeros(3)), np.zeros(1))

    for roll in (0.0, 90.0, 180.0):
        assert read(roll, 40.0, 130.0).value == pytest.approx(130.0 * DEG)
    assert read(0.0, 75.0, 10.0) is not None
    assert read(0.0, 76.0, 10.0) is None
    assert read(30.0, -90.0, 10.0) is None
    turned = difference(aid_records([compass], DT)[0], 179.0 * DEG, -179.0 * DEG)
    np.testing.assert_allclose(turned, -2.0 * DEG)


def test_a_sensor_of_more_numbers_than_the_laws_have_room_for_is_refused():
    @dataclass(frozen=True)
    class Wide(Depth):
        components: int = field(default=4, init=False)

    with pytest.raises(ValueError, match=r"depth: 4 numbers in a reading .* have room for 3"):
        aid_records([Wide(Sampling(1.0), 0.1, 0.1)], DT)


def test_every_sensor_may_be_missing_and_what_is_lost_is_said():
    """The sentences, and what the filter itself says after half a minute with each set."""
    motions = truths(weaving, 25.0)
    sigma = {}
    for names in (("dvl", "depth", "heading"), ("dvl",), ("heading", "position"), ("dvl", "position")):
        aids = [aid for aid in AIDS if aid.name in names]
        last = navigate(motions, 1, aids=aids)[-1].estimate
        sigma[names] = (last.position_sigma, last.attitude_sigma)
    dead, bare = sigma["dvl", "depth", "heading"], sigma["dvl",]
    assert "dead-reckoned" in what_drifts({"dvl", "depth", "heading"})
    assert dead[0][:2].min() > 0.99 * INITIAL.position
    assert dead[0][2] < 0.06
    assert "and so does depth" in what_drifts({"dvl"})
    assert bare[0].min() > 0.99 * INITIAL.position
    assert "heading drifts" in what_drifts({"dvl"})
    assert bare[1][2] > 0.7 * INITIAL.heading  # a little is known from the first velocity
    assert "position is held by fixes, depth too; heading is held" in what_drifts({"heading", "position"})
    assert sigma["heading", "position"][0].max() < 0.5
    assert "as the turn between DVL and fixes" in what_drifts({"dvl", "position"})
    assert sigma["dvl", "position"][1][2] < 0.95 * bare[1][2]
    for _, attitude in sigma.values():
        assert attitude[:2].max() < 0.5 * INITIAL.tilt
    assert "sideways or ahead" in what_drifts({"depth", "position"})


@pytest.mark.parametrize(
    ("aids", "nose_level", "moves_level", "heading"),
    [
        ({"dvl", "heading"}, 1.0, False, "heading is held by the compass"),
        (
            {"dvl", "heading"},
            0.0,
            False,
            "the nose points steeply up or down and the compass reads nothing: heading drifts with the gyro, and the"
            " level position with it",
        ),
        ({"dvl", "heading", "position"}, 0.0, False, "the compass reads nothing: heading drifts with the gyro"),
        ({"dvl", "heading", "position"}, 0.0, True, "as the turn between DVL and fixes"),
        ({"dvl", "position"}, 1.0, False, "heading drifts with the gyro"),
        ({"dvl", "heading"}, 0.4, True, "heading is held by the compass on 40% of the path; on the rest the nose"),
        ({"dvl", "heading"}, None, True, "heading is held by the compass, but where the nose points steeply"),
    ],
)
def test_what_holds_the_heading_depends_on_path_and_attitude(aids, nose_level, moves_level, heading):
    _, said, _ = what_drifts(aids, nose_level, moves_level).replace("; on the rest", "/ on the rest").split("; ")
    assert heading.replace("; on", "/ on") in said


def test_a_period_of_rest_leaves_the_estimate_where_it_was():
    motions = truths(straight, 0.0) * 200
    quiet = replace(IMU, gyro_bias=0.0, accelerometer_bias=0.0)
    still = [m._replace(velocity=np.zeros(3)) for m in motions]
    ticks = navigate(still, 0, quiet)
    assert np.abs(ticks[-1].error[3:6]).max() < 0.03
