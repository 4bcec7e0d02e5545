"""The kinematic law: its Lyapunov function, its convergence from far away, its analytic acceleration."""

from math import pi

import numpy as np
import pytest

from cube_sim.guidance.approach import Approach
from cube_sim.guidance.helix import Helix
from cube_sim.guidance.line import Line
from cube_sim.guidance.speed import ConstantSpeed
from cube_sim.guidance.virtual_target import VirtualTarget

K2, SPEED = 0.5, 0.4
HELIX = Helix([0.0, 0.0, -8.0], 3.0, 3.0, 2.0)


def approach(closing: float = SPEED) -> Approach:
    return Approach(ConstantSpeed(SPEED), pi / 3.0, 0.5, stop_time=2.0, closing_limit=closing).at_closing_speed(2.0)


def random_states(seed: int, n: int):
    """(position, velocity, arc length) around the helix, up to far outside it."""
    rng = np.random.default_rng(seed)
    for _ in range(n):
        s = rng.uniform(0.05, 0.95) * HELIX.length
        yield HELIX.at(s).position + rng.normal(0.0, 4.0, 3), rng.normal(0.0, 0.6, 3), s


def test_the_error_moves_as_the_curvature_free_lyapunov_identity_says():
    """V' = s1 (v_T - s') + y1 v_1 + z1 v_2, by finite differences of V itself, whatever the curvature and error."""
    h = 1e-6
    for position, velocity, s in random_states(1, 200):
        view = VirtualTarget(HELIX, K2, arc_length=s).view(position, velocity)

        def V(t, position=position, velocity=velocity, s=s, speed=view.speed):
            e = VirtualTarget(HELIX, K2, arc_length=s + speed * t).view(position + velocity * t, velocity).error
            return 0.5 * e @ e

        s1, y1, z1 = view.error
        v_T, v_1, v_2 = view.velocity
        identity = s1 * (v_T - view.speed) + y1 * v_1 + z1 * v_2
        assert (V(h) - V(-h)) / (2.0 * h) == pytest.approx(identity, rel=1e-6, abs=1e-6)
        assert s1 * (v_T - view.speed) == pytest.approx(-K2 * s1**2)


def test_the_approach_never_leads_away_from_the_path():
    for position, velocity, s in random_states(2, 500):
        view = VirtualTarget(HELIX, K2, arc_length=s).view(position, velocity)
        wanted = approach().motion(view).velocity @ view.point.rotation
        assert view.error[1:] @ wanted[1:] <= 0.0
        assert np.linalg.norm(wanted) <= SPEED * (1.0 + 1e-12) or wanted[0] < 0.0


def test_at_a_closing_speed_only_what_lies_across_the_path_is_faster():
    position = np.array([9.0, 4.0, -2.0])
    view = VirtualTarget(HELIX, K2, arc_length=3.0).view(position, np.zeros(3))
    slow, fast = (approach(c).motion(view).velocity @ view.point.rotation for c in (SPEED, 1.2))
    near = HELIX.at(3.0).position + 1e-5 * HELIX.at(3.0).rotation[:, 1]
    beside = VirtualTarget(HELIX, K2, arc_length=3.0).view(near, np.zeros(3))
    slow_beside, fast_beside = (approach(c).motion(beside).velocity @ beside.point.rotation for c in (SPEED, 1.2))
    assert SPEED < np.hypot(*fast[1:]) <= 1.2
    assert np.hypot(*slow[1:]) <= SPEED
    assert fast[1] * slow[2] == pytest.approx(fast[2] * slow[1])
    np.testing.assert_allclose(fast_beside, slow_beside, atol=1e-12)
    assert approach(0.3).least_closing == 1.0
    assert approach(1.2).least_closing == pytest.approx(SPEED / 1.2)
    assert approach(1.2).lateral_time == pytest.approx(approach().lateral_time)


@pytest.mark.parametrize("closing", [SPEED, 1.2])
def test_the_acceleration_is_the_derivative_of_the_velocity_along_the_motion(closing):
    h = 1e-6
    for position, velocity, s in random_states(3, 200):
        target = VirtualTarget(HELIX, K2, arc_length=s)
        view = target.view(position, velocity)

        def wanted(t, position=position, velocity=velocity, s=s, speed=view.speed):
            moved = VirtualTarget(HELIX, K2, arc_length=s + speed * t)
            return approach(closing).motion(moved.view(position + velocity * t, velocity)).velocity

        np.testing.assert_allclose(
            approach(closing).motion(view).acceleration, (wanted(h) - wanted(-h)) / (2.0 * h), atol=1e-7
        )


def test_on_the_path_itself_the_motion_is_smooth_and_the_centripetal_acceleration_is_there():
    s = 0.5 * HELIX.length
    point = HELIX.at(s)
    view = VirtualTarget(HELIX, K2, arc_length=s).view(point.position, SPEED * point.rotation[:, 0])
    motion = approach().motion(view)
    k1, k2 = point.curvature
    np.testing.assert_allclose(motion.velocity, SPEED * point.rotation[:, 0], atol=1e-12)
    np.testing.assert_allclose(motion.acceleration @ point.rotation, [0.0, SPEED**2 * k1, SPEED**2 * k2], atol=1e-12)


@pytest.mark.flight
@pytest.mark.parametrize("seed", range(8))
def test_a_vehicle_that_moves_as_wanted_converges_from_beyond_the_radius_of_curvature(seed):
    """The point of the 2007 result: no condition on the initial error."""
    rng = np.random.default_rng(seed)
    offset = rng.normal(size=3)
    position = HELIX.at(0.0).position + offset / np.linalg.norm(offset) * rng.uniform(3.5, 12.0)
    target, law, dt = VirtualTarget(HELIX, K2, speed_limit=1.0), approach(), 0.02
    velocity = np.zeros(3)
    distances = []
    for _ in range(int(160.0 / dt)):
        view = target.view(position, velocity)
        velocity = law.motion(view).velocity
        position = position + velocity * dt
        target.advance(view.speed, dt)
        distances.append(np.linalg.norm(view.error))
    assert distances[0] > 3.0
    assert np.max(distances[int(100.0 / dt) :]) < 0.02
    np.testing.assert_allclose(position, HELIX.at(HELIX.length).position, atol=0.02)


def test_the_vehicle_turns_back_when_it_has_run_past_the_end():
    line = Line([0.0, 0.0, 0.0], [10.0, 0.0, 0.0])
    view = VirtualTarget(line, K2, arc_length=10.0).view(np.array([11.0, 0.0, 0.0]), np.zeros(3))
    motion = approach().motion(view)
    np.testing.assert_allclose(motion.velocity, [-0.5, 0.0, 0.0], atol=1e-12)


def test_the_target_never_leaves_the_path_nor_exceeds_its_speed_limit():
    target = VirtualTarget(HELIX, K2, speed_limit=0.7)
    view = target.view(HELIX.at(0.0).position + 50.0 * HELIX.at(0.0).rotation[:, 0], np.zeros(3))
    assert view.speed == 0.7
    behind = target.view(HELIX.at(0.0).position - 50.0 * HELIX.at(0.0).rotation[:, 0], np.zeros(3))
    assert behind.speed == 0.0  # already at the beginning
    target.advance(0.7, 1e6)
    assert target.arc_length == HELIX.length
