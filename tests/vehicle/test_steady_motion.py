"""The wrench of a steady motion and its slopes: those of the inverse dynamics, for hulls that couple everything."""

import numpy as np
import pytest
from support.vehicles import cube, random_hull, random_rotation, steady_wrench, turned

from cube_sim.vehicle.laws.hull_motion import turning_slope

H = 1e-6


@pytest.mark.parametrize("hull", [cube().dynamics, random_hull(np.random.default_rng(12))], ids=["cube", "random"])
def test_steady_wrenches_are_the_inverse_dynamics_of_motions_without_rotation_and_acceleration(hull):
    rng = np.random.default_rng(1)
    v, R = rng.normal(size=(5, 3)), np.array([random_rotation(rng) for _ in range(5)])
    wanted = [hull.wrench(r, np.r_[a, 0, 0, 0], np.zeros(6), np.zeros(3)) for a, r in zip(v, R, strict=True)]
    assert np.allclose(hull.steady_wrenches(v, R[:, 2]), wanted, atol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_slopes_are_derivatives_of_the_inverse_dynamics(seed):
    rng = np.random.default_rng(seed)
    hull, nu, R = random_hull(rng), rng.normal(size=6), random_rotation(rng)
    for i, e in enumerate(np.eye(6)):
        ends = [steady_wrench(hull, nu + s * H * e, R[2]) for s in (1, -1)]
        assert np.allclose(hull.steady_wrench_slope(nu)[:, i], (ends[0] - ends[1]) / (2 * H), atol=1e-6)
    for i, e in enumerate(np.eye(3)):
        ends = [steady_wrench(hull, nu, turned(R, s * H * e)[2]) for s in (1, -1)]
        assert np.allclose(-hull.restoring_slope(R[2])[:, i], (ends[0] - ends[1]) / (2 * H), atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_the_slope_by_turning_is_the_derivative_of_what_stands_still_in_the_world(seed):
    rng = np.random.default_rng(seed)
    hull, v, force, R = random_hull(rng), rng.normal(size=3), rng.normal(size=3), random_rotation(rng)
    by_velocity = hull.steady_wrench_slope(np.r_[v, 0, 0, 0])
    slope = turning_slope(hull.record, by_velocity, tuple(v), tuple(force), tuple(R[2]))
    for i, e in enumerate(np.eye(3)):
        ends = []
        for s in (1, -1):
            turn = turned(np.eye(3), s * H * e)
            wrench = hull.steady_wrenches((turn.T @ v)[None], turned(R, s * H * e)[2][None])[0]
            ends.append(wrench + np.r_[turn.T @ force, 0, 0, 0])
        assert np.allclose(slope[:, i], (ends[0] - ends[1]) / (2 * H), atol=1e-6)


def test_weight_and_lift_are_those_of_the_masses():
    hull = cube().dynamics
    wrench = hull.wrench(np.eye(3), np.zeros(6), np.zeros(6), np.zeros(3))
    assert wrench[2] == pytest.approx(hull.weight - hull.buoyancy)
    assert -hull.hydrostatics @ [0, 0, 1] == pytest.approx(wrench)
