"""The loop times nobody has set: the margins they promise, and that they are in order."""

from __future__ import annotations

import numpy as np
import pytest

from cube_sim.control.loop_times import FASTEST_TURN, LoopTimes, angular_acceleration
from cube_sim.guidance.approach import Approach
from cube_sim.guidance.law import TargetView
from cube_sim.guidance.path import PathPoint
from cube_sim.guidance.speed import ConstantSpeed

HERE = PathPoint(np.zeros(3), np.eye(3), (0.0, 0.0), (0.0, 0.0))


def margins(open_loop, w):
    """(gain margin, phase margin [deg]) of L(jw), which falls through 1 once."""
    L = open_loop(1j * w)
    phase = np.unwrap(np.angle(L))
    crossing = int(np.argmax(np.abs(L) < 1.0))
    turned = int(np.argmax(phase < -np.pi))
    return 1.0 / abs(L[turned]), 180.0 + float(np.degrees(phase[crossing]))


@pytest.mark.parametrize("delay", [0.01, 0.05, 0.1, 0.25])
def test_the_attitude_loops_have_their_margins_behind_a_delay(delay):
    """w' = -(1/T_a + 1/T_w) w - phi / (T_a T_w), late by the delay: what the two loops of the attitude add up to."""
    times = LoopTimes.behind(delay)
    T_a, T_w = times.attitude, times.rate
    w = np.geomspace(1e-2, 1e3, 200_000)
    gain, phase = margins(lambda s: np.exp(-delay * s) * ((1 / T_a + 1 / T_w) / s + 1 / (T_a * T_w) / s**2), w)
    assert gain > 3.0
    assert phase > 40.0


@pytest.mark.parametrize("delay", [0.01, 0.05, 0.1, 0.25])
def test_the_velocity_loop_has_its_margins_with_the_disturbance_estimate_in_it(delay):
    """An estimate of T_d = 1 s takes the place of the missing wrench: L = e^(-delay s) (1 / T_v s + 1 / T_d s)."""
    T_v = LoopTimes.behind(delay).velocity
    w = np.geomspace(1e-2, 1e3, 200_000)
    gain, phase = margins(lambda s: np.exp(-delay * s) * (1 / T_v + 1.0) / s, w)
    assert gain > 2.0
    assert phase > 40.0


@pytest.mark.parametrize("delay", [0.0, 0.01, 0.05, 0.1, 0.25, 1.0])
def test_each_loop_is_several_times_slower_than_the_one_inside_it(delay):
    times = LoopTimes.behind(delay)
    assert times.rate >= max(0.15, 3.0 * delay) - 1e-12
    assert times.velocity >= max(0.5, 6.0 * delay) - 1e-12
    assert times.attitude >= 3.0 * times.rate - 1e-12
    assert times.lateral >= 4.0 * times.velocity
    later = LoopTimes.behind(2.0 * delay)
    assert later.rate >= times.rate
    assert later.velocity >= times.velocity


def test_the_attitude_loop_asks_for_no_more_than_the_torque_gives():
    for turning in (0.05, 0.3, 1.0):
        times = LoopTimes.behind(0.05, turning)
        assert 0.5 / times.attitude**2 == pytest.approx(turning)
        assert times.turn == pytest.approx(min(FASTEST_TURN, turning * times.attitude))
        assert times.velocity == LoopTimes.behind(0.05).velocity
    assert LoopTimes.behind(0.05, 100.0) == LoopTimes.behind(0.05)


def test_an_attitude_that_points_the_thrust_is_turned_back_more_slowly():
    assert LoopTimes.behind(0.05).pointing == 1.5 * LoopTimes.behind(0.05).attitude
    assert LoopTimes.behind(0.05, level=True).pointing == 2.4 * LoopTimes.behind(0.05).attitude
    assert LoopTimes.behind(0.05, 1.0, pointing=True).attitude == pytest.approx(np.sqrt(0.8))


def test_the_axis_with_least_torque_counts_unless_the_water_holds_it():
    A = np.zeros((6, 2))
    A[3, 0], A[5, 1] = 0.1, 0.4  # roll and yaw
    limits = np.array([[-30.0, 0.0, 0.0, 40.0], [-20.0, 0.0, 0.0, 20.0]])
    inertia = np.diag([2.0, 2.0, 4.0])
    assert angular_acceleration(A, limits, inertia, np.zeros(3)) == pytest.approx(3.0 / 2.0)
    assert angular_acceleration(A, limits, inertia, np.array([0.0, 0.0, 7.0])) == pytest.approx(8.0 / 4.0)
    assert angular_acceleration(0.0 * A, limits, inertia, np.zeros(3)) == np.inf


def lateral_time(approach, speed, error=1e-4):
    """The time in which an approach removes 63 % of a small cross-track error [s]."""
    view = TargetView(0.0, 10.0, speed, HERE, np.array([0.0, error, 0.0]), np.array([speed, 0.0, 0.0]))
    return -error / approach.motion(view).velocity[1]


def test_an_approach_is_held_back_to_a_time_and_never_hurried():
    quick = Approach(ConstantSpeed(0.4), np.radians(60.0), 2.0, None)
    own = 1.0 / (0.4 * np.radians(60.0) * 2.0)
    assert lateral_time(quick, 0.4) == pytest.approx(own, rel=1e-6)
    assert lateral_time(quick.no_faster_than(5.0), 0.4) == pytest.approx(5.0, rel=1e-6)
    assert quick.no_faster_than(0.9 * own) is quick
    far = quick.no_faster_than(5.0)
    assert lateral_time(far, 0.4, 1e3) == pytest.approx(1e3 / (0.4 * np.sin(np.radians(60.0))), rel=1e-6)  # as before
