"""What gives way of a demand that cannot be made: against least squares, and against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from support.vehicles import random_hull, random_rotation, vehicle

from cube_sim.control.authority import Authority, Capability, capability
from cube_sim.control.yielding import SMALL_FORCE, WaterHold


def without(lost, held):
    """The capability of thrusters that make everything but the columns of lost (6,k)."""
    none = np.zeros((3, 0))
    return Capability(Authority.PLANE, none, "", lost[:3], lost[3:], np.eye(6), held)


def draw(rng):
    """(weights, lost (6,k), held): a hull somewhere within 60 degrees of upright, and k = 1 to 3 lost combinations."""
    up = random_rotation(rng)[2]
    while up[2] < 0.5:
        up = random_rotation(rng)[2]
    hold = WaterHold(np.append(rng.normal(0.0, 1.0, 2), rng.uniform(5.0, 20.0)), rng.uniform(5.0, 50.0))
    return hold.weights(up), rng.normal(size=(6, rng.integers(1, 4))), rng.normal(0.0, 3.0, 6)


def test_of_all_that_can_be_made_the_cheapest_change_is_taken():
    """min d' W^-1 d with N'(w + d) = b, by least squares: d = L y, W = L L', N'L y = b - N'w."""
    rng = np.random.default_rng(11)
    for _ in range(100):
        weights, lost, held = draw(rng)
        left, wrench = without(lost, held), rng.normal(0.0, 20.0, 6)
        asked = left.project_onto_range(wrench, weights)
        values, axes = np.linalg.eigh(weights)
        L = axes * np.sqrt(np.maximum(values, 0.0))
        y = np.linalg.lstsq(lost.T @ L, left.constants - lost.T @ wrench, rcond=None)[0]
        np.testing.assert_allclose(asked, wrench + L @ y, atol=1e-5)
        np.testing.assert_allclose(lost.T @ asked, left.constants, atol=1e-5)
        free = np.linalg.svd(lost.T @ L)[2][lost.shape[1] :].T  # other ways to make it, by chance
        for other in (y[:, None] + free @ rng.normal(0.0, 0.1 * np.linalg.norm(y), (free.shape[1], 50))).T:
            np.testing.assert_allclose(lost.T @ (wrench + L @ other), left.constants, atol=1e-8)
            assert other @ other >= y @ y


def test_what_nothing_holds_never_gives_way():
    """Torque about the vertical; and of a hull that is top-heavy or upside down, all torque."""
    rng = np.random.default_rng(12)
    for _ in range(30):
        up, lost, wrench = random_rotation(rng)[2], rng.normal(size=(6, 2)), rng.normal(0.0, 20.0, 6)
        hold = WaterHold(np.array([0.0, 0.0, 10.0]), 20.0)
        asked = without(lost, np.zeros(6)).project_onto_range(wrench, hold.weights(up))
        assert up @ asked[3:] == pytest.approx(up @ wrench[3:], abs=1e-12)
        if up[2] <= 0.0:
            np.testing.assert_allclose(asked[3:], wrench[3:], atol=1e-12)
        top_heavy = WaterHold(np.array([0.0, 0.0, -10.0]), 20.0)
        np.testing.assert_array_equal(top_heavy.weights(np.array([0.0, 0.0, 1.0]))[3:], 0.0)


@pytest.mark.parametrize("seed", range(5))
def test_a_single_combination_comes_out_of_what_is_cheaper(seed):
    """Its share of force is |n_f|^2 / (|n_f|^2 + (r / 2 F)^2 |n_t|^2), n_t its level torque: TRIM below half."""
    rng = np.random.default_rng(seed)
    n = np.append(rng.normal(size=3), [*rng.normal(0.0, 3.0, 2), 0.0])
    A = np.linalg.svd(n[None])[2][1:].T  # five thrusters that make all the rest
    force, arm = 20.0, np.linalg.norm(n[:3]) / np.linalg.norm(n[3:])
    for share, authority in ((0.51, Authority.PLANE), (0.49, Authority.TRIM)):
        lever = arm * np.sqrt((1.0 - share) / share)
        hold = WaterHold(np.array([0.0, 0.0, lever * 2.0 * force]), force)
        assert capability(A, cost_limit=1e3, hold=hold).authority is authority
        asked = capability(A, cost_limit=1e3, hold=hold).project_onto_range(n, hold.weights(np.array([0.0, 0.0, 1.0])))
        gone = n - asked
        np.testing.assert_allclose(gone[:3], share / (n[:3] @ n[:3]) * (n @ n) * n[:3], atol=1e-6)


def test_without_a_righting_moment_roll_and_pitch_have_to_be_made():
    """The six-thruster BlueROV2 flies at trim; the same thrusters on a hull that nothing rights, do not."""
    A = vehicle("bluerov2_vectored").actuation_matrix
    righted = WaterHold.of(vehicle("bluerov2_vectored").dynamics, 0.4)
    assert capability(A, hold=righted).authority is Authority.TRIM
    assert capability(A, hold=WaterHold(np.zeros(3), righted.force)).authority is Authority.SAFE
    assert capability(A).authority is Authority.SAFE


def test_the_force_of_a_mission_is_drag_ahead_and_what_the_lift_leaves():
    rng = np.random.default_rng(13)
    hull, speed = random_hull(rng), 0.7
    drag = hull.linear_damping[0, 0] * speed + hull.quadratic_damping[0, 0] * speed**2
    hold = WaterHold.of(hull, speed)
    assert hold.force == pytest.approx(np.hypot(drag + 1.0, SMALL_FORCE * 10.0))  # 10 N in water, 11 N of lift
    np.testing.assert_array_equal(hold.righting, hull.righting_moment)
    up = np.array([0.0, 0.0, 1.0])
    np.testing.assert_array_equal(hold.weights(up, 0.1 * hold.force), hold.weights(up))
    np.testing.assert_allclose(hold.weights(up, 2.0 * hold.force)[3:], hold.weights(up)[3:] / 4.0)
