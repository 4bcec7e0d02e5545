"""A hull and the links it carries as one body at the reference pose, as whoever reckons with the vehicle has it."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from support.linked import Linked, random_link, random_start
from support.water_bodies import coriolis_matrix, random_body

import cube_sim
from cube_sim.vehicle.floating import floating_height


def arm(seed: int) -> Linked:
    rng = np.random.default_rng(seed)
    links = tuple(random_link(rng, parent, kind) for parent, kind in ((0, "hinge"), (1, "hinge"), (2, "none")))
    return Linked(replace(random_body(rng, 1.5), current=(0.0, 0.0, 0.0)), links)


def at_reference(linked: Linked, model: mujoco.MjModel, nu: np.ndarray) -> tuple[mujoco.MjData, np.ndarray]:
    """The model turned anyhow, its joints at rest at 0, its hull in motion; and B, which turns to body axes."""
    state = random_start(np.random.default_rng(3), len(linked.moving))
    state[7:] = 0.0
    n = len(linked.moving)
    state[7 + n : 13 + n] = nu
    data = mujoco.MjData(model)
    linked.set_state(data, state)
    mujoco.mj_forward(model, data)
    B = np.eye(6)
    B[:3, :3] = data.xmat[1].reshape(3, 3).T
    return data, B


@pytest.mark.parametrize("seed", range(3))
def test_its_inertia_is_that_of_hull_and_arm(seed):
    linked = arm(seed)
    model = linked.model()
    vehicle = cube_sim.Vehicle.from_model(model)
    data, B = at_reference(linked, model, np.zeros(6))
    M = np.zeros((model.nv, model.nv))
    mujoco.mju_sym2dense(M, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    np.testing.assert_allclose(vehicle.mass_matrix + vehicle.added_mass, B @ M[:6, :6] @ B.T, atol=1e-10)
    assert np.abs(vehicle.added_mass - linked.hull.added).max() > 0.1


@pytest.mark.parametrize("seed", range(3))
def test_its_drag_and_lift_are_those_of_hull_and_arm(seed):
    """Along and about each axis alone, where the quadratic drag of links is exact; at rest, buoyancy is left."""
    linked = arm(seed)
    model = linked.model()
    vehicle = cube_sim.Vehicle.from_model(model)
    for nu in [np.zeros(6), *np.eye(6), *(-0.4 * np.eye(6))]:
        data, B = at_reference(linked, model, nu)
        up = data.xmat[1].reshape(3, 3)[2]
        lift = vehicle.displaced_mass * linked.gravity * up
        A, turning = vehicle.added_mass, np.append(np.cross(nu[3:], nu[:3]), np.zeros(3))
        expected = (
            np.append(lift, np.cross(vehicle.centre_of_buoyancy, lift))
            - vehicle.dynamics.damping(nu)
            - coriolis_matrix(A, nu) @ nu
            + A @ turning
        )
        np.testing.assert_allclose(B @ data.qfrc_passive[:6], expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("share", [0.3, 0.8, 0.99])
def test_it_floats_where_weight_and_lift_are_equal(share):
    linked = arm(1)
    whole = sum(link.body.mass for link in linked.links) + linked.hull.mass
    others = sum(link.body.volume for link in linked.links)
    linked = replace(linked, hull=replace(linked.hull, volume=whole / 1000.0 / share - others))
    model = linked.model(parameters={"water:surface": 0.0})
    vehicle = cube_sim.Vehicle.from_model(model)
    data = mujoco.MjData(model)
    data.qpos[2] = floating_height(model, vehicle)
    mujoco.mj_forward(model, data)
    assert data.qfrc_passive[2] == pytest.approx(whole * linked.gravity, rel=1e-6)


def test_one_that_sinks_is_just_awash():
    linked = arm(2)
    linked = replace(linked, hull=replace(linked.hull, volume=0.5 * linked.hull.volume))
    model = linked.model(parameters={"water:surface": 0.0})
    vehicle = cube_sim.Vehicle.from_model(model)
    lifts = []
    for lower in (1e-6, -1e-3):
        data = mujoco.MjData(model)
        data.qpos[2] = floating_height(model, vehicle) - lower
        mujoco.mj_forward(model, data)
        lifts.append(data.qfrc_passive[2] / (vehicle.displaced_mass * linked.gravity))
    assert lifts[0] == pytest.approx(1.0, abs=1e-12)
    assert lifts[1] < 1.0


def test_its_coriolis_terms_are_its_own_where_a_table_has_the_hulls():
    """`coriolis_of_added_mass` 0 speaks of the hull's added mass; that of links is in no table."""
    linked = arm(0)
    table = {"hull:velocity_products": [2.0, 1.0, 2.0, -5.0], "hull:coriolis_of_added_mass": 0.0}
    model = linked.model(parameters=table)
    dynamics = cube_sim.Vehicle.from_model(model).dynamics
    nu, still = np.array([0.4, 0.2, -0.1, 0.0, 0.0, 0.0]), np.zeros(6)
    data, B = at_reference(linked, model, nu)
    up = data.xmat[1].reshape(3, 3)
    weight = dynamics.mass_matrix[0, 0] * linked.gravity * up[2]
    passive = B @ data.qfrc_passive[:6] - np.append(weight, np.cross(dynamics.centre_of_mass, weight))
    # drag of several axes at once is not exact: both are taken without it
    passive += sum_of_drags(linked, data)
    expected = -dynamics.wrench(up, nu, still, np.zeros(3)) + dynamics.damping(nu)
    np.testing.assert_allclose(passive, expected, atol=1e-9)


def sum_of_drags(linked: Linked, data: mujoco.MjData) -> np.ndarray:
    total = np.zeros(6)
    for k, body in enumerate([linked.hull, *(link.body for link in linked.links)], 1):
        Rh, R = data.xmat[1].reshape(3, 3), data.xmat[k].reshape(3, 3)
        v = R.T @ data.qvel[:3]  # no rotation: one velocity everywhere
        V = np.append(v, np.zeros(3))
        F = body.linear @ V + body.quadratic @ (np.abs(V) * V)
        force, moment = Rh.T @ R @ F[:3], Rh.T @ R @ F[3:]
        place = Rh.T @ (data.xpos[k] - data.xpos[1])
        total += np.append(force, moment + np.cross(place, force))
    return total
