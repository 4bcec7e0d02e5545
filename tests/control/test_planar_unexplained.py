"""The observer of what the planar model leaves unexplained."""

from math import exp

import numpy as np
import pytest

from cube_sim.control.planar.unexplained import UnexplainedAcceleration


def follow(w, time, dt, duration):
    """Estimates of w(t), (3,), from the velocity it makes together with an acceleration that is explained."""
    observer, nu, found = UnexplainedAcceleration(time), np.zeros(3), []
    explained = np.array([0.3, -0.1, 0.02])
    observer.update(nu, explained, dt)
    for k in range(round(duration / dt)):
        nu = nu + dt * (explained + w((k + 0.5) * dt))
        found.append(observer.update(nu, explained, dt))
    return np.array(found)


def test_it_follows_a_steady_change_without_lag():
    slope, start = np.array([0.01, -0.02, 0.005]), np.array([0.1, 0.0, -0.1])
    found = follow(lambda t: start + slope * t, 0.5, 0.02, 20.0)
    np.testing.assert_allclose(found[-1], start + slope * 20.0, atol=1e-9)


def test_a_step_is_followed_by_63_percent_within_its_time_constant():
    """1 - exp(-t/T) (1 + t/T - (t/T)^2): the response of the transfer function in the docstring."""
    found = follow(lambda t: np.ones(3), 0.5, 0.001, 3.0)
    for t in (0.1, 0.5, 1.0, 2.5):
        x = t / 0.5
        assert found[round(t / 0.001) - 1] == pytest.approx(1.0 - exp(-x) * (1.0 + x - x * x), abs=5e-3)


@pytest.mark.parametrize("dt", [0.02, 0.5, 5.0])
def test_it_is_stable_whatever_the_tick(dt):
    found = follow(lambda t: np.array([1.0, -1.0, 0.5]), 0.5, dt, 100.0 * dt + 20.0)
    np.testing.assert_allclose(found[-1], [1.0, -1.0, 0.5], atol=1e-6)


def test_one_that_turns_slowly_is_missed_by_three_times_the_square_of_its_angle_per_time_constant():
    omega, T = 0.1, 0.5
    found = follow(lambda t: np.array([np.cos(omega * t), np.sin(omega * t), 0.0]), T, 0.01, 100.0)
    t = 0.01 * np.arange(1, len(found) + 1)
    missed = np.hypot(found[:, 0] - np.cos(omega * t), found[:, 1] - np.sin(omega * t))[2000:]
    assert missed == pytest.approx(3.0 * (omega * T) ** 2, rel=0.1)
