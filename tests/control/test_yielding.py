"""What gives way of a demand that cannot be made: torques or forces, against least squares and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from support.vehicles import random_hull, random_rotation, vehicle

from cube_sim.control.authority import Authority
from cube_sim.control.judged_capability import capability
from cube_sim.control.yielding import LONGEST_ARMS, SMALL_FORCE, WaterHold, held_or_pointed, yielding_directions

UP = np.array([0.0, 0.0, 1.0])


def draw(rng):
    """(weights, lost (6,k)): a hull somewhere within 60 degrees of upright, and k = 1 to 3 lost combinations."""
    up = random_rotation(rng)[2]
    while up[2] < 0.5:
        up = random_rotation(rng)[2]
    hold = WaterHold(np.append(rng.normal(0.0, 1.0, 2), rng.uniform(5.0, 20.0)), rng.uniform(5.0, 50.0, 3))
    return hold.weights(up), rng.normal(size=(6, rng.integers(1, 4)))


def projected(wrench, lost, directions, constants):
    return wrench - directions @ np.linalg.solve(lost.T @ directions, lost.T @ wrench - constants)


def test_what_is_left_can_be_made_and_torques_or_forces_yielded_never_both():
    rng = np.random.default_rng(11)
    for _ in range(100):
        weights, lost = draw(rng)
        found, wrench, constants = yielding_directions(lost, weights, 0.3), rng.normal(0.0, 20.0, 6), rng.normal(size=1)
        assert found is not None
        asked = projected(wrench, lost, found.directions, constants)
        np.testing.assert_allclose(lost.T @ asked, constants[0], atol=1e-6)
        forces = np.abs(found.directions[:3]).max(axis=0) > 0.0
        torques = np.abs(found.directions[3:]).max(axis=0) > 0.0
        assert not np.any(forces & torques)
        assert np.count_nonzero(forces) == found.pointed


def test_where_only_one_kind_yields_it_is_the_cheapest_change_of_that_kind():
    """min d' W^-1 d over torques alone, or forces alone, with N'(w + d) = b: by least squares."""
    rng = np.random.default_rng(12)
    seen = set()
    for _ in range(200):
        weights, lost = draw(rng)
        found = yielding_directions(lost, weights, 0.3)
        assert found is not None
        if found.pointed not in (0, lost.shape[1]):
            continue
        seen.add(found.pointed > 0)
        part = np.diag(np.repeat([1.0, 0.0] if found.pointed else [0.0, 1.0], 3))
        values, axes = np.linalg.eigh(part @ weights @ part)
        L, wrench = axes * np.sqrt(np.maximum(values, 0.0)), rng.normal(0.0, 20.0, 6)
        y = np.linalg.lstsq(lost.T @ L, -lost.T @ wrench, rcond=1e-10)[0]
        asked = projected(wrench, lost, found.directions, np.zeros(lost.shape[1]))
        np.testing.assert_allclose(asked, wrench + L @ y, atol=1e-5)
    assert seen == {True, False}


def test_what_nothing_holds_never_gives_way():
    """Torque about the vertical; and of a hull that is top-heavy or upside down, all torque."""
    rng = np.random.default_rng(13)
    for _ in range(30):
        up, lost, wrench = random_rotation(rng)[2], rng.normal(size=(6, 2)), rng.normal(0.0, 20.0, 6)
        found = yielding_directions(lost, WaterHold(10.0 * UP, np.full(3, 20.0)).weights(up), 0.3)
        assert found is not None
        asked = projected(wrench, lost, found.directions, np.zeros(2))
        assert up @ asked[3:] == pytest.approx(up @ wrench[3:], abs=1e-9)
        if up[2] <= 0.0:
            np.testing.assert_allclose(asked[3:], wrench[3:], atol=1e-9)
    np.testing.assert_array_equal(WaterHold(-10.0 * UP, np.full(3, 20.0)).weights(UP)[3:], 0.0)


@pytest.mark.parametrize("seed", range(5))
def test_a_single_combination_comes_out_of_what_is_cheaper(seed):
    """Its share of force is |F n_f|^2 / (|F n_f|^2 + (r / 2)^2 |n_t|^2), n_t its level torque: TRIM below half."""
    rng = np.random.default_rng(seed)
    n = np.append(rng.normal(0.0, 30.0, 3), [*rng.normal(0.0, 3.0, 2), 0.0])  # a lever far longer than the arms
    A = np.linalg.svd(n[None])[2][1:].T  # five thrusters that make all the rest
    force = rng.uniform(5.0, 50.0, 3)
    torque = np.linalg.norm(force * n[:3]) / np.linalg.norm(n[3:])
    for share, authority in ((0.51, Authority.PLANE), (0.49, Authority.TRIM)):
        righting = 2.0 * torque * np.sqrt((1.0 - share) / share)
        left = capability(A, cost_limit=1e3, hold=WaterHold(righting * UP, force))
        assert left.authority is authority
        gone = n - left.project_onto_range(n)
        part = slice(0, 3) if authority is Authority.PLANE else slice(3, 6)
        yielded = n[part] * (force**2 if authority is Authority.PLANE else 1.0)
        np.testing.assert_allclose(gone[part], (n @ n) / (yielded @ n[part]) * yielded, atol=1e-9)
        assert np.linalg.norm(gone) == pytest.approx(np.linalg.norm(gone[part]))


@pytest.mark.parametrize("seed", range(5))
def test_a_torque_that_is_missing_by_itself_is_left_to_the_water_whatever_it_holds(seed):
    """On a lever no longer than the thrusters' arms every force is there, however far its torque may tilt the hull."""
    rng = np.random.default_rng(seed)
    axes, weak = np.append(rng.normal(size=2), 0.0), WaterHold(1e-3 * UP, rng.uniform(5.0, 50.0, 3))
    force = rng.normal(size=3)
    for arms, pointed in ((0.9 * LONGEST_ARMS, 0), (1.1 * LONGEST_ARMS, 1)):
        lever = arms * 0.3
        lost = np.append(lever * force / np.linalg.norm(force), axes / np.linalg.norm(axes))[:, None]
        found = held_or_pointed(lost, weak, UP, 0.3)
        assert found is not None
        assert found.pointed == pointed
    vertical = np.append(0.1 * force, UP)[:, None]
    for held, hold in ((vertical, weak), (lost, weak._replace(righting=-1e-3 * UP)), (lost, None)):
        found = held_or_pointed(held, hold, UP, 0.3)
        assert found is not None
        assert found.pointed == 1  # nothing turns it back


def test_a_vehicle_that_can_be_neither_pointed_nor_held_is_told():
    yaw = np.array([[0.0, 0.0, 0.0, 0.0, 0.0, 1.0]]).T
    assert yielding_directions(yaw, WaterHold(10.0 * UP, np.full(3, 20.0)).weights(UP), 0.3) is None


def test_without_a_righting_moment_roll_and_pitch_have_to_be_made():
    """The six-thruster BlueROV2 flies at trim; the same thrusters on a hull that nothing rights, do not."""
    A = vehicle("bluerov2_vectored").actuation_matrix
    righted = WaterHold.of(vehicle("bluerov2_vectored").dynamics, 0.4)
    assert capability(A, hold=righted).authority is Authority.TRIM
    assert capability(A, hold=WaterHold(np.zeros(3), righted.force)).authority is Authority.SAFE
    assert capability(A).authority is Authority.SAFE


def test_a_lever_counts_by_the_force_that_comes_with_it():
    """A propeller turns the hull a little; that its broad side would meet ten times the drag is not to the point."""
    forces = np.array([[8.0, 8.0, 8.0], [8.0, 80.0, 80.0]])
    lever = np.array([[0.025, 0.0, 0.0, 0.0, 1.0, 0.0]]).T
    found = [yielding_directions(lever, WaterHold(UP, force).weights(UP), 0.3) for force in forces]
    assert [yielding is not None and yielding.pointed for yielding in found] == [0, 0]


def test_the_force_of_a_mission_is_the_drag_along_each_axis_and_what_the_lift_leaves():
    rng = np.random.default_rng(13)
    hull, speed = random_hull(rng), 0.7
    linear, quadratic = hull.linear_damping, hull.quadratic_damping
    drags = [np.linalg.norm((linear[:3, i] + quadratic[:3, i] * speed) * speed) for i in range(3)]
    hold = WaterHold.of(hull, speed)
    # 10 N in water, 11 N of lift
    np.testing.assert_allclose(hold.force, np.hypot(np.array(drags) + 1.0, SMALL_FORCE * 10.0), rtol=1e-6)
    np.testing.assert_array_equal(hold.righting, hull.righting_moment)
