"""Desired attitudes: their angular velocity is their own derivative; vertical stretches do no harm."""

from itertools import pairwise

import numpy as np
import pytest

from cube_sim.control.along_path import AlongPath
from cube_sim.control.attitude_mode import Situation
from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.guidance.helix import Helix
from cube_sim.guidance.law import TargetView
from cube_sim.guidance.line import Line
from cube_sim.guidance.path import PathPoint
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.spatial import rotation_from_quaternion, skew

HELIX = Helix([0.0, 0.0, 0.0], 3.0, 8.0, 2.0)


def seen(view: TargetView) -> Situation:
    """These attitudes ask for nothing but the view."""
    return Situation(view, np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3), np.eye(6))


def at(path, s: float, speed: float = 0.4) -> Situation:
    view = VirtualTarget(path, 0.5, arc_length=s).view(path.at(s).position, np.zeros(3))
    return seen(view._replace(speed=speed))


def flown(mode, path, speed=0.4, dt=0.02):
    """Desired attitudes as rotations, and their rates, while the target runs up to 10 m of the path."""
    for s in np.arange(0.0, min(path.length, 10.0), speed * dt):
        desired = mode.attitude(at(path, s, speed), dt)
        yield s, rotation_from_quaternion(desired.quaternion), desired.rates


def test_the_attitude_along_a_path_points_along_the_tangent_and_stays_level():
    for s, R, _ in flown(AlongPath(), HELIX):
        np.testing.assert_allclose(R[:, 0], HELIX.at(s).rotation[:, 0], atol=1e-12)
        assert abs(R[2, 1]) < 1e-4
        assert R[2, 2] > 0.0


def test_its_rates_are_the_derivative_of_the_attitude():
    dt = 1e-3
    steps = [step for step, _ in zip(flown(AlongPath(), HELIX, dt=dt), range(600), strict=False)][500:]
    for (_, before, _), (_, now, rates), (_, after, _) in zip(steps, steps[1:], steps[2:], strict=False):
        np.testing.assert_allclose((after - before) / (2.0 * dt), skew(rates) @ now, atol=1e-6)


@pytest.mark.flight
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_vertical_path_has_a_steady_finite_attitude(direction):
    line = Line([0.0, 0.0, 0.0], [0.0, 0.0, direction * 5.0])
    first = None
    for _, R, rates in flown(AlongPath(), line):
        first = R if first is None else first
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(R[:, 0], [0.0, 0.0, direction], atol=1e-12)
        np.testing.assert_allclose(R, first, atol=1e-12)
        np.testing.assert_array_equal(rates, np.zeros(3))


@pytest.mark.flight
def test_a_half_loop_through_the_vertical_never_jumps_and_ends_level():
    """Up, over the vertical, and back the other way: upside down at the top, then rolled out on the straight."""
    mode, dt, speed = AlongPath(), 0.02, 0.4
    steps = []
    for s in np.arange(0.0, 20.0, speed * dt):
        angle, k1 = (min(s, np.pi), 1.0 if s < np.pi else 0.0)  # a loop of 1 m radius, then a straight line
        T = np.array([np.cos(angle), 0.0, np.sin(angle)])
        N = np.array([-np.sin(angle), 0.0, np.cos(angle)])
        point = PathPoint(np.zeros(3), np.column_stack([T, N, np.cross(T, N)]), (k1, 0.0), (0.0, 0.0))
        desired = mode.attitude(seen(TargetView(s, 10.0, speed, point, np.zeros(3), np.zeros(3))), dt)
        assert np.all(np.isfinite(desired.rates))
        steps.append((rotation_from_quaternion(desired.quaternion), np.linalg.norm(desired.rates)))
    for (R, rate), (after, _) in pairwise(steps):
        turned = np.arccos(np.clip((np.trace(R.T @ after) - 1.0) / 2.0, -1.0, 1.0))
        assert turned <= rate * dt * 1.05 + 1e-6
    assert min(R[2, 2] for R, _ in steps) < -0.2  # upside down for a while, past the vertical
    assert steps[-1][0][2, 2] > 0.999  # and level again


def test_a_fixed_attitude_is_fixed():
    q = np.array([0.5, 0.5, -0.5, 0.5])
    desired = FixedAttitude(q).attitude(at(HELIX, 3.0), 0.02)
    np.testing.assert_array_equal(desired.quaternion, q)
    np.testing.assert_array_equal(desired.rates, np.zeros(3))
