"""Trajectory tracking and point stabilisation: the clock, the pull, their derivatives and their Lyapunov functions."""

from math import exp, inf, pi, tanh

import numpy as np
import pytest

from cube_sim.guidance.arc import circle
from cube_sim.guidance.clocked_target import ClockedTarget
from cube_sim.guidance.helix import Helix
from cube_sim.guidance.line import Line
from cube_sim.guidance.point import Point
from cube_sim.guidance.pursuit import Pursuit
from cube_sim.guidance.speed import ConstantSpeed, PlannedSpeed, Speed, StoppingSpeed

HELIX = Helix([0.0, 0.0, -8.0], 3.0, 3.0, 2.0)
LINE = Line([0.0, 0.0, 0.0], [10.0, 0.0, 0.0])
SPEED, TIME, CLOSING = 0.4, 2.0, 0.3
PROFILES = {
    "constant": ConstantSpeed(SPEED),
    "stopping": StoppingSpeed(ConstantSpeed(SPEED), HELIX.length, 20.0),
    "planned": PlannedSpeed(HELIX, SPEED, 0.03, 0.05),
}


class Accelerating:
    """u^2 = 0.04 + 0.02 s: a constant acceleration of 0.01 m/s^2."""

    def at(self, s: float) -> Speed:
        u = (0.04 + 0.02 * s) ** 0.5
        return Speed(u, 0.01 / u)


def run(target, duration, dt):
    for _ in range(round(duration / dt)):
        target.advance(target.view(np.zeros(3), np.zeros(3)).speed, dt)
    return target.arc_length


def test_the_clock_is_the_solution_of_its_differential_equation():
    assert run(ClockedTarget(HELIX, ConstantSpeed(SPEED)), 20.0, 0.02) == pytest.approx(8.0, abs=1e-12)
    # s = 0.2 t + 0.005 t^2
    assert run(ClockedTarget(HELIX, Accelerating()), 20.0, 0.02) == pytest.approx(6.0, abs=1e-5)
    # 10 m at 0.4 m/s with T = 2 s: even for 23 s, to 0.8 m before the end, then like exp(-t/T)
    stopping = ClockedTarget(LINE, StoppingSpeed(ConstantSpeed(SPEED), LINE.length, 2.0))
    assert run(stopping, 27.0, 0.02) == pytest.approx(10.0 - 0.8 * exp(-2.0), abs=1e-4)
    assert run(stopping, 60.0, 0.02) <= LINE.length
    assert stopping.view(np.zeros(3), np.zeros(3)).remaining == pytest.approx(0.0, abs=1e-9)


def test_the_clock_does_not_wait_for_the_vehicle():
    near, far = ClockedTarget(HELIX, ConstantSpeed(SPEED)), ClockedTarget(HELIX, ConstantSpeed(SPEED))
    for k in range(200):
        near.advance(near.view(HELIX.at(0.4 * 0.02 * k).position, np.ones(3)).speed, 0.02)
        far.advance(far.view(np.array([50.0, 0.0, k]), -np.ones(3)).speed, 0.02)
    assert near.arc_length == far.arc_length


def test_without_a_stop_the_target_runs_on_along_the_last_tangent():
    ring = circle([0.0, 0.0, 0.0], 2.0)
    target = ClockedTarget(ring, ConstantSpeed(SPEED), laps=1.5)
    run(target, 60.0, 0.02)
    view = target.view(np.zeros(3), np.zeros(3))
    beyond = target.arc_length - 6.0 * pi
    np.testing.assert_allclose(view.point.position, [-2.0, -beyond, 0.0], atol=1e-9)
    np.testing.assert_allclose(view.point.rotation[:, 0], [0.0, -1.0, 0.0], atol=1e-12)
    assert view.point.curvature == (0.0, 0.0)
    assert view.remaining == -beyond


def random_states(seed: int, n: int):
    """(position, velocity, arc length), from on the path to far outside it."""
    rng = np.random.default_rng(seed)
    for k in range(n):
        s = rng.uniform(0.05, 0.95) * HELIX.length
        yield HELIX.at(s).position + rng.normal(0.0, 10.0 ** (k % 7 - 5), 3), rng.normal(0.0, 0.6, 3), s


@pytest.mark.parametrize("profile", PROFILES.values(), ids=PROFILES.keys())
def test_the_acceleration_is_the_derivative_of_the_velocity_along_the_motion(profile):
    h, law = 1e-5, Pursuit(profile, TIME, CLOSING)
    for position, velocity, s in random_states(1, 210):
        target = ClockedTarget(HELIX, profile, arc_length=s)
        view = target.view(position, velocity)

        def wanted(t, position=position, velocity=velocity, s=s, speed=view.speed):
            moved = ClockedTarget(HELIX, profile, arc_length=s)
            moved.advance(speed, t)
            return law.motion(moved.view(position + velocity * t, velocity)).velocity

        # 2 h steps over a kink of a planned profile, or through e = 0, see another slope
        np.testing.assert_allclose(law.motion(view).acceleration, (wanted(h) - wanted(-h)) / (2.0 * h), atol=2e-5)


def test_far_away_the_pull_is_the_closing_speed_and_close_by_its_time_constant():
    law, still = Pursuit(ConstantSpeed(SPEED), TIME, CLOSING), np.zeros(3)
    for direction in np.random.default_rng(2).normal(size=(20, 3)):
        unit = direction / np.linalg.norm(direction)
        for distance in (1e-9, 1e-4, 6e-5, 0.5, 3.0, 1e6):
            target = ClockedTarget(HELIX, ConstantSpeed(SPEED), arc_length=5.0)
            here = HELIX.at(5.0)
            wanted = law.motion(target.view(here.position + distance * unit, still)).velocity
            pull = wanted - SPEED * here.rotation[:, 0]
            exact = -CLOSING * tanh(distance / (CLOSING * TIME)) * unit
            np.testing.assert_allclose(pull, exact, atol=1e-8 * distance + 1e-15)


@pytest.mark.flight
@pytest.mark.parametrize("profile", PROFILES.values(), ids=PROFILES.keys())
def test_the_distance_to_the_target_falls_along_whole_trajectories_of_the_kinematic_law(profile):
    """V' = -c |e| tanh(|e| / (c T_e)) exactly: the solution sinh(x) = sinh(x0) exp(-t / T_e) for x = |e| / (c T_e)."""
    law, dt = Pursuit(profile, TIME, CLOSING), 0.05
    for position, _, _ in random_states(3, 7):
        target = ClockedTarget(HELIX, profile)
        distances = []
        for _ in range(400):
            view = target.view(position, np.zeros(3))
            distances.append(np.linalg.norm(view.error))
            first = law.motion(view).velocity
            target.advance(view.speed, dt)
            second = law.motion(target.view(position + dt * first, np.zeros(3))).velocity
            position = position + 0.5 * dt * (first + second)
        x = np.array(distances) / (CLOSING * TIME)
        t = dt * np.arange(len(x))
        np.testing.assert_allclose(x, np.arcsinh(np.sinh(x[0]) * np.exp(-t / TIME)), atol=2e-3)
        assert np.all(np.diff(x) <= 1e-4)


def test_a_point_is_a_path_that_goes_nowhere():
    point = Point([1.0, 2.0, -3.0], pi / 2.0)
    assert (point.length, point.closed) == (0.0, False)
    for s in (-1.0, 0.0, 7.0, inf):
        np.testing.assert_array_equal(point.at(s).position, [1.0, 2.0, -3.0])
        np.testing.assert_allclose(point.at(s).rotation[:, 0], [0.0, 1.0, 0.0], atol=1e-15)
        np.testing.assert_allclose(point.at(s).rotation @ point.at(s).rotation.T, np.eye(3), atol=1e-15)
    profile = StoppingSpeed(ConstantSpeed(SPEED), point.length, 2.0)
    target = ClockedTarget(point, profile)
    view = target.view(np.array([1.0, 4.0, -3.0]), np.zeros(3))
    assert view.speed == view.remaining == 0.0
    np.testing.assert_allclose(view.error, [2.0, 0.0, 0.0], atol=1e-12)
    target.advance(view.speed, 1e3)
    assert target.arc_length == 0.0
    wanted = Pursuit(profile, TIME, CLOSING).motion(view)
    np.testing.assert_allclose(wanted.velocity, [0.0, -CLOSING * tanh(2.0 / (CLOSING * TIME)), 0.0], atol=1e-12)
