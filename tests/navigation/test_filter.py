"""The filter against statistics, closed forms and a filter that gets every reading at its instant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2
from support.navigation_motion import (
    AIDS,
    DEG,
    DT,
    FLAWLESS,
    GRAVITY,
    IMU,
    INITIAL,
    KNOWN,
    expected,
    flawless_readings,
    navigate,
    on_time,
    straight,
    truths,
    tumbling,
    weaving,
)

from cube_sim.navigation.aid import aid_records
from cube_sim.navigation.correction import corrected
from cube_sim.navigation.depth import Depth
from cube_sim.navigation.dvl import Dvl
from cube_sim.navigation.filter import Filter
from cube_sim.navigation.filtering import agrees
from cube_sim.navigation.gate import MAX_REJECTIONS
from cube_sim.navigation.heading import Heading
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.navigator import InitialErrors
from cube_sim.navigation.position import PositionFix
from cube_sim.navigation.reading import Reading, ReadingOutcome
from cube_sim.navigation.sampling import Sampling
from cube_sim.navigation.strapdown import predict, rotation, turned
from cube_sim.scenario.navigation_blocks import LARGEST_SCALE_ERROR
from cube_sim.spatial import quaternion_from_euler

RUNS = 12
DVL, DEPTH, HEADING, POSITION = range(4)


@pytest.fixture(scope="module", params=[weaving, tumbling], ids=["weaving", "tumbling"])
def flights(request):
    """Seeded runs of one motion, all errors drawn anew."""
    motions = truths(request.param, 16.0)
    return [navigate(motions, seed) for seed in range(RUNS)]


@pytest.mark.flight
def test_errors_are_as_large_as_the_filter_says(flights):
    """NEES: e' P^-1 e over the runs is chi-square, for the whole error and for its parts."""
    parts = {"position": slice(0, 3), "velocity": slice(3, 6), "attitude": slice(6, 9), "all": slice(0, 21)}
    for k in (0, 100, 300, 500, 800):
        for name, part in parts.items():
            errors = [(run[k].error[part], run[k].estimate.covariance[part, part]) for run in flights]
            total = sum(e @ np.linalg.solve(P, e) for e, P in errors)
            low, high = chi2.ppf([5e-4, 1 - 5e-4], RUNS * len(errors[0][0]))
            assert low < total < high, (name, k, total, low, high)


@pytest.mark.flight
def test_the_largest_scale_error_allowed_leaves_the_filter_as_good_as_it_says():
    """NEES of the velocity after 2 s, 60 runs: 1.32 per component at 0.1, 1.50 at 0.2, 1.38 is the bound."""
    aids = (replace(AIDS[DVL], scale=LARGEST_SCALE_ERROR), *AIDS[1:])
    motions = truths(weaving, 2.0)
    last = [navigate(motions, seed, aids=aids)[-1] for seed in range(60)]
    errors = [(run.error[3:6], run.estimate.covariance[3:6, 3:6]) for run in last]
    low, high = chi2.ppf([5e-4, 1 - 5e-4], 3 * len(errors))
    assert low < sum(e @ np.linalg.solve(P, e) for e, P in errors) < high


@pytest.mark.flight
def test_innovations_are_as_large_as_the_filter_says(flights):
    """NIS of each sensor over all runs; readings of one run are independent of each other, by theory."""
    for aid in range(4):
        found = [f for run in flights for tick in run for f in tick.fusions if f.reading.aid == aid]
        n = len(found) * len(found[0].innovation)
        low, high = chi2.ppf([1e-4, 1 - 1e-4], n)
        assert low < sum(f.nis for f in found) < high
        assert sum(f.outcome is ReadingOutcome.REJECTED for f in found) <= 3  # one in ten thousand is expected


@pytest.mark.flight
def test_covariances_stay_symmetric_and_positive(flights):
    for tick in flights[0]:
        P = tick.estimate.covariance
        np.testing.assert_array_equal(P, P.T)
    assert np.linalg.eigvalsh(P).min() > 0


def test_late_readings_end_in_the_estimate_of_a_filter_that_had_them_in_time():
    """To the bit, with three sensors late by different times, seen when the last reading has arrived."""
    motions = truths(weaving, 6.0)
    late, timely = navigate(motions, 3), navigate(motions, 3, aids=on_time(AIDS))
    settled = 0
    for k, (a, b) in enumerate(zip(late, timely, strict=True)):
        # At 5.50 s and at 3.50 s a fix has just arrived; the others' latest readings, if under way, are missing.
        if k * DT in (0.5, 2.5, 4.5):
            assert not np.array_equal(late[k - 1].estimate.state.position, timely[k - 1].estimate.state.position)
        pending = any(
            k - delay < look <= k
            for aid, delay in zip(AIDS, (5, 3, 3, 25), strict=True)
            for look in [aid.sampling.tick_of(int(k * DT * aid.sampling.rate_hz + 1e-9), DT)]
        )
        if not pending:
            settled += 1
            np.testing.assert_array_equal(a.estimate.state.position, b.estimate.state.position)
            np.testing.assert_array_equal(a.estimate.state.quaternion, b.estimate.state.quaternion)
            np.testing.assert_array_equal(a.estimate.covariance, b.estimate.covariance)
    assert settled > 20


def test_a_delay_nobody_takes_account_of_costs_speed_times_delay():
    """A fix of 0.8 s ago taken for one of now, at 0.5 m/s; fused at its instant it costs nothing."""
    delay, n = 40, 3000
    motions = [straight(k * DT) for k in range(n)]
    fix = PositionFix(Sampling(50.0, delay * DT), 0.02)
    x = np.concatenate([motions[0].position, motions[0].velocity, [np.sqrt(0.5), 0, 0, np.sqrt(0.5)], np.zeros(6)])
    P = np.diag(np.repeat([0.01, 0.01, 1e-4, 1e-12, 1e-12], 3))
    # Its own accelerations are trusted little, so that it leans on the fixes.
    imu = replace(FLAWLESS, accelerometer_noise=0.3)
    errors, inputs = [], flawless_readings(motions)
    for compensated in (True, False):
        filter_ = Filter(x, P, imu, [fix], GRAVITY, DT)
        for k in range(1000):
            seen = k - delay
            readings = [Reading(0, seen if compensated else k, motions[seen].position)] if seen >= 0 else []
            filter_.step(inputs[k], readings)
        errors.append(filter_.x[:3] - motions[999].position)
    np.testing.assert_allclose(errors[0], 0.0, atol=1e-4)
    np.testing.assert_allclose(errors[1], [0.0, -0.5 * delay * DT, 0.0], atol=2e-3)


def test_without_errors_only_the_integration_of_the_position_is_left_and_it_is_of_second_order():
    worst = []
    for dt in (0.04, 0.02, 0.01):
        ticks = navigate(truths(tumbling, 8.0, dt), imu=FLAWLESS, aids=(), initial=KNOWN, dt=dt)
        errors = np.abs([tick.error for tick in ticks])
        assert errors[:, 3:9].max() < 1e-12  # velocity and attitude: increments add up whatever the tick is
        worst.append(errors[:, :3].max())
    np.testing.assert_allclose(np.log2(np.divide(worst[:-1], worst[1:])), 2.0, atol=0.01)
    assert worst[1] < 1e-4


@pytest.mark.flight
def test_it_finds_level_and_north_from_a_first_estimate_that_is_far_off():
    """Tilts of up to 30 degrees and headings of up to 100, drawn from such a distribution."""
    initial = InitialErrors(0.5, 0.2, 15 * DEG, 45 * DEG)
    motions = truths(weaving, 16.0)
    first, last = [], []
    for seed in range(8):
        ticks = navigate(motions, seed, initial=initial)
        first.append(np.abs(ticks[0].error[6:9]) / DEG)
        last.append(np.abs(ticks[-1].error[6:9]) / DEG)
    tilt, heading = np.max(first, axis=0)[[1, 2]]
    assert tilt > 25.0
    assert heading > 45.0
    assert np.max(last, axis=0)[:2].max() < 1.0
    assert np.max(last, axis=0)[2] < 8.0  # four times the compass's own bias


@pytest.mark.flight
def test_it_finds_the_biases():
    motions = truths(weaving, 40.0)
    ticks = [navigate(motions, seed)[-1].error for seed in range(2)]
    gyro, accelerometer = np.abs([e[9:12] for e in ticks]), np.abs([e[12:15] for e in ticks])
    assert gyro.max() < 0.08 * IMU.gyro_bias
    assert accelerometer.max() < 0.2 * IMU.accelerometer_bias


@pytest.mark.flight
def test_dead_reckoning_wanders_as_the_square_root_of_time():
    """Noise s of a DVL of rate r alone: the position's variance grows by s^2 / r per second."""
    dvl = Dvl(Sampling(5.0), 0.05, 0.0, 0.0)
    imu = replace(FLAWLESS, accelerometer_noise=0.1)
    motions = truths(straight, 10.0)
    runs = [navigate(motions, seed, imu, [dvl], KNOWN) for seed in range(30)]
    for k in (250, 500):
        spread = np.sqrt(np.mean([run[k].error[:3] ** 2 for run in runs]))
        expected = 0.05 * np.sqrt(k * DT / 5.0)
        assert abs(spread / expected - 1.0) < 0.2  # 90 samples: 7.5 % one standard deviation
        assert abs(np.sqrt(runs[0][k].estimate.covariance[0, 0]) / expected - 1.0) < 0.1


@pytest.mark.flight
@pytest.mark.parametrize(
    ("aids", "axis"),
    [
        ([Dvl(Sampling(10.0), 5e-3, 0.0, 0.01), Heading(Sampling(10.0), 1e-3, 0.0)], 1),
        ([Dvl(Sampling(10.0), 5e-3, 0.0, 0.0), Heading(Sampling(10.0), 5e-3, 0.5 * DEG)], 0),
    ],
    ids=["scale error along", "compass bias across"],
)
def test_constant_errors_of_dead_reckoning_grow_with_the_distance(aids, axis):
    """s d along the track, b d across it; the filter's standard deviation says the same."""
    initial = replace(KNOWN, velocity=0.02, heading=2 * DEG if axis == 0 else 0.0)
    ratios = []
    for seed in range(4):
        ticks = navigate(truths(straight, 12.0), seed, FLAWLESS, aids, initial)
        e, distance = ticks[-1].error[:3] - ticks[100].error[:3], 5.0
        sigma = 0.01 if axis == 1 else 0.5 * DEG
        drift = ticks[-1].estimate.position_sigma[axis]
        np.testing.assert_allclose(drift, sigma * 6.0, rtol=0.1)
        assert np.abs(np.delete(e, axis)).max() < 2e-2 + 0.05 * abs(e[axis])
        ratios.append(e[axis] / (sigma * distance))
    assert np.std(ratios) > 0.2  # each run has its own error
    assert np.abs(ratios).max() < 3.5


def test_a_fix_from_nowhere_is_kept_out():
    motions = truths(weaving, 4.0)
    filter_, inputs = _filter_with_fixes(motions)
    for k, inertial in enumerate(inputs):
        value = motions[k].position + (30.0 if k == 100 else 0.0)
        fusions = filter_.step(inertial, [Reading(0, k, value)] if k % 25 == 0 else [])
        if k % 25 == 0:
            assert (fusions[0].outcome is ReadingOutcome.REJECTED) == (k == 100)
    assert np.abs(filter_.x[:3] - motions[-1].position).max() < 0.2


def test_the_gate_does_not_lock_a_sensor_out_for_ever():
    """The estimate is sure of itself and 20 m off: after MAX_REJECTIONS readings the sensor is believed."""
    motions = truths(weaving, 8.0)
    filter_, inputs = _filter_with_fixes(motions, offset=20.0)
    outcomes = []
    for k, inertial in enumerate(inputs):
        readings = [Reading(0, k, motions[k].position)] if k % 25 == 0 else []
        outcomes += [fusion.outcome for fusion in filter_.step(inertial, readings)]
    assert outcomes[: MAX_REJECTIONS + 1] == [ReadingOutcome.REJECTED] * MAX_REJECTIONS + [
        ReadingOutcome.ACCEPTED_AFTER_REJECTIONS
    ]
    assert outcomes[-1] is ReadingOutcome.FUSED
    assert np.abs(filter_.x[:3] - motions[-1].position).max() < 0.5


def test_garbage_that_no_vehicle_could_have_made_does_not_agree():
    """Two depths that differ by less than a third, but by more than a vehicle goes in the meantime."""
    often, seldom = aid_records([Depth(Sampling(5.0), 0.01, 0.0), Depth(Sampling(0.5), 0.01, 0.0)], DT)
    for apart, found in ((5.0, (True, True)), (9.0, (False, True)), (20.0, (False, False))):
        y, last = np.array([40.0, 0.0, 0.0]), np.array([40.0 - apart, 0.0, 0.0])
        assert (bool(agrees(often, y, last, 0.5)), bool(agrees(seldom, y, last, 0.5))) == found


def test_an_inertial_unit_that_is_dead_is_not_believed():
    """It reads zeros for three seconds; believed, that would be a fall of 29 m/s."""
    motions = truths(weaving, 8.0)
    filter_, inputs = _filter_with_fixes(motions)
    off = []
    for k, inertial in enumerate(inputs):
        readings = [Reading(0, k, motions[k].position)] if k % 25 == 0 else []
        filter_.step(np.zeros(9) if 100 <= k < 250 else inertial, readings)
        off.append(np.abs(filter_.x[3:6] - motions[k].velocity).max())
    assert max(off[100:250]) < 2.5


def _filter_with_fixes(motions, offset=0.0):
    fix = PositionFix(Sampling(2.0), 0.3)
    m = motions[0]
    x = np.concatenate([m.position + offset, m.velocity, quaternion_from_euler(0.0, 0.0, 1.5), np.zeros(6)])
    P = np.diag(np.repeat([0.1, 0.05, 0.01, 1e-4, 1e-3], 3) ** 2)
    filter_ = Filter(x, P, IMU, [fix], GRAVITY, DT)
    return filter_, flawless_readings(motions)


def test_readings_of_the_future_or_of_ages_ago_are_refused():
    filter_, inputs = _filter_with_fixes(truths(weaving, 0.1))
    for inertial in inputs:
        filter_.step(inertial)
    for tick in (7, 2):
        with pytest.raises(ValueError, match=f"tick {tick} cannot be fused at tick 6"):
            filter_.step(inputs[0], [Reading(0, tick, np.zeros(3))])


def moved(x, error):
    """The true state when the estimate x is off by an error."""
    true = np.concatenate([x[:6] + error[:6], x[6:10], x[10:] + error[9:]])
    q = np.array([x[6], -x[7], -x[8], -x[9]])
    q = turned(q, -error[6:9])  # Exp(phi) q = (q* exp(-phi))*
    true[6:10] = q[0], -q[1], -q[2], -q[3]
    return true


def difference(true, x):
    """The error of x, of first order in the attitude."""
    R = rotation(true[6:10]) @ rotation(x[6:10]).T
    phi = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return np.concatenate([true[:6] - x[:6], phi, true[10:] - x[10:]])


@pytest.mark.parametrize("aid", AIDS, ids=lambda aid: aid.name)
def test_how_a_reading_changes_with_the_error(aid):
    """Jacobians by central differences, at an attitude on no axis; rates carry the gyro's bias."""
    random = np.random.default_rng(5)
    c = len(aid.constants)
    x = np.concatenate([random.normal(size=6), quaternion_from_euler(2.0, -0.7, 1.0), 0.1 * random.normal(size=6 + c)])
    w = random.normal(size=3)

    def reading(error):
        y = moved(x, error)
        return expected(aid, Motion(y[:3], y[3:6], rotation(y[6:10]), w - y[10:13]), y[16:]).value

    found = expected(aid, Motion(x[:3], x[3:6], rotation(x[6:10]), w - x[10:13]), x[16:])
    h = 1e-6
    for i in range(12):
        e = h * np.eye(15 + c)[i]
        np.testing.assert_allclose((reading(e) - reading(-e)) / (2 * h), found.H_motion[:, i], atol=1e-8)
    for i in range(c):
        e = h * np.eye(15 + c)[15 + i]
        np.testing.assert_allclose((reading(e) - reading(-e)) / (2 * h), found.H_constants[:, i], atol=1e-8)


def test_how_the_error_goes_on_over_a_tick():
    """Covariance of the prediction against central differences of the state's, up to third order in the tick."""
    random = np.random.default_rng(2)
    for dt in (0.02, 0.005):
        x = np.concatenate([random.normal(size=6), quaternion_from_euler(2.0, -0.7, 1.0), 0.1 * random.normal(size=7)])
        mean, rest = random.normal(size=6), np.zeros(6)

        def step(x, mean=mean, dt=dt, rest=rest):
            return predict(x, np.zeros((16, 16)), mean, GRAVITY, dt, rest, rest)[0]

        h, F = 1e-5, np.empty((16, 16))
        for i in range(16):
            e = h * np.eye(16)[i]
            F[:, i] = (difference(step(moved(x, e)), step(x)) - difference(step(moved(x, -e)), step(x))) / (2 * h)
        root = random.normal(size=(16, 16))
        P = root @ root.T
        _, later = predict(x, P, mean, GRAVITY, dt, rest, rest)
        np.testing.assert_allclose(later, F @ P @ F.T, atol=20.0 * np.abs(P).max() * dt**2)
        np.testing.assert_array_equal(later, later.T)


def test_the_noise_of_the_inertial_unit_adds_up_to_the_stated_walks():
    """Over a second at rest: attitude variance N^2 t, velocity N^2 t, position N^2 t^3 / 3, biases K^2 t."""
    noise, walk = np.repeat([2e-3, 3e-2], 3), np.repeat([1e-4, 2e-3], 3)
    x, P = np.concatenate([np.zeros(6), [1.0], np.zeros(9)]), np.zeros((15, 15))
    inertial = np.zeros(6)  # free fall: gravity does not mix attitude into velocity
    for _ in range(50):
        x, P = predict(x, P, inertial, GRAVITY, DT, noise, walk)
    sigma2 = P.diagonal().reshape(5, 3)
    np.testing.assert_allclose(sigma2[0], 9e-4 / 3 + 4e-6 / 20, rtol=1e-3)  # K^2 t^5 / 20 of the bias's walk
    np.testing.assert_allclose(sigma2[1], 9e-4 + 4e-6 / 3, rtol=1e-3)
    np.testing.assert_allclose(sigma2[2], 4e-6 + 1e-8 / 3, rtol=1e-3)
    np.testing.assert_allclose(sigma2[3:], [[1e-8] * 3, [4e-6] * 3], rtol=1e-12)


def test_one_component_after_the_other_is_the_textbook_update():
    random = np.random.default_rng(8)
    for n, m in ((15, 1), (21, 3)):
        root = random.normal(size=(n, n))
        P, H, y, variance = root @ root.T, random.normal(size=(m, n)), random.normal(size=m), 0.3
        x = np.concatenate([random.normal(size=6), quaternion_from_euler(0.3, 0.1, 2.0), random.normal(size=n - 9)])
        later, Q, nis = corrected(x, P, H, y, variance)
        S = H @ P @ H.T + variance * np.eye(m)
        K = P @ H.T @ np.linalg.inv(S)
        np.testing.assert_allclose(later, moved(x, K @ y), atol=1e-10)
        np.testing.assert_allclose(Q, (np.eye(n) - K @ H) @ P, atol=1e-8 * np.abs(P).max())
        assert nis == pytest.approx(y @ np.linalg.solve(S, y), rel=1e-10)
        reference = corrected.py_func(x, P, H, y, variance)
        for a, b in zip((later, Q, nis), reference, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9)


def test_the_compiled_prediction_is_the_readable_one():
    random = np.random.default_rng(4)
    root = random.normal(size=(18, 18))
    x = np.concatenate([random.normal(size=6), quaternion_from_euler(0.3, 0.1, 2.0), random.normal(size=9)])
    arguments = (x, root @ root.T, random.normal(size=6), GRAVITY, DT, np.ones(6), np.ones(6))
    for a, b in zip(predict(*arguments), predict.py_func(*arguments), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12)


def test_a_turn_too_small_for_a_quotient_is_still_exact():
    q = quaternion_from_euler(0.3, -0.2, 2.0)
    for size in (0.0, 1e-9, 0.999e-4, 1.001e-4, 1e-2, 3.0):
        angle = size * np.array([0.6, 0.0, 0.8])
        there = turned(q, angle)
        assert np.linalg.norm(there) == pytest.approx(1.0, abs=1e-15)
        exact = np.concatenate([[np.cos(size / 2)], np.sin(size / 2) * np.array([0.6, 0.0, 0.8])])
        np.testing.assert_allclose(rotation(there), rotation(q) @ rotation(exact), atol=1e-15)


def test_upside_down_and_nose_up_the_estimate_goes_on():
    """Through looping and rolling the attitude stays known, also while the compass has no heading to read."""
    motions = truths(tumbling, 40.0)
    steep = sum(abs(true.rotation[2, 0]) > 0.97 for true in motions)
    assert steep > 200
    assert min(true.rotation[2, 2] for true in motions) < -0.8
    ticks = navigate(motions, 2)
    headings = sum(f.reading.aid == HEADING for tick in ticks for f in tick.fusions)
    assert 250 < headings < 401 - steep // 5 + 20
    late = np.abs([tick.error[6:9] for tick in ticks[1000:]])
    assert late.max() < 4 * DEG
    assert np.isfinite([tick.estimate.state.quaternion for tick in ticks]).all()


def test_a_filter_refuses_a_state_that_does_not_fit_its_sensors():
    with pytest.raises(ValueError, match="these aids make 16 errors"):
        Filter(np.zeros(16), np.eye(15), IMU, [Depth(Sampling(1.0), 0.1, 0.1)], GRAVITY, DT)


def test_the_first_estimate_is_off_by_what_is_said():
    motions = truths(straight, 0.0)
    errors = np.array([navigate(motions, seed, aids=[], initial=INITIAL)[0].error[:9] for seed in range(300)])
    expected = np.concatenate([np.repeat([0.5, 0.05], 3), np.array([1.0, 1.0, 3.0]) * DEG])
    np.testing.assert_allclose(errors.std(axis=0), expected, rtol=0.15)
