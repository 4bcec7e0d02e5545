"""What a controller knows of a hull's lift, against the water that MuJoCo flies it in."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from support.lifting import Fin, Lifted
from support.places import CUBE, MODELS
from support.water_bodies import Body

import cube_sim
from cube_sim.mission.knowledge import believed_dynamics
from cube_sim.scenario.knowledge_block import KnowledgeBlock
from cube_sim.vehicle.fins import lift_tables
from cube_sim.vehicle.laws.fin import attached_wrench
from cube_sim.vehicle.plugin.packing import packed_parameters
from cube_sim.vehicle.vehicle import Vehicle

X, Y, Z = np.eye(3)
REMUS = MODELS / "remus100.xml"
CURRENT = np.array([0.2, -0.1, 0.05])
HULL = Body(added=np.diag([1.0, 10.0, 10.0, 0.1, 1.0, 1.0])).neutral()


def missing(model, nu_r) -> np.ndarray:
    """The wrench [N, N m] by which a controller misses what MuJoCo does to a hull in a current."""
    vehicle, data = Vehicle.from_model(model), mujoco.MjData(model)
    model.opt.wind[:] = CURRENT
    data.qpos[3:7] = [0.8, 0.1, -0.3, 0.5]
    data.qpos[2] = -20.0
    mujoco.mj_kinematics(model, data)
    R = data.xmat[vehicle.body].reshape(3, 3).copy()
    nu = nu_r + np.concatenate([R.T @ CURRENT, np.zeros(3)])
    data.qvel[:3], data.qvel[3:6] = R @ nu[:3], nu[3:]
    mujoco.mj_forward(model, data)
    turning = np.cross(nu[3:], nu[:3])
    nu_dot = np.concatenate([R.T @ data.qacc[:3] - turning, data.qacc[3:6]])
    return vehicle.dynamics.wrench(R, nu, nu_dot, CURRENT)


@pytest.mark.parametrize("seed", range(4))
def test_remus_is_known_as_it_moves(seed):
    """Its table, the Coriolis terms left out and its fins, undeflected."""
    nu = np.array([1.4, 0.0, 0.0, 0.0, 0.0, 0.0]) + 0.2 * np.random.default_rng(seed).normal(size=6)
    model = cube_sim.load_model(REMUS)
    assert np.abs(missing(model, nu)).max() < 1e-10
    assert np.abs(missing(cube_sim.load_model(REMUS, {"rudder:fin_area": [0.012]}), nu)).max() < 1e-10


def test_a_fin_that_stalls_is_known_as_long_as_it_does_not():
    keel = Fin("keel", np.array([-0.5, 0.0, -0.1]), X, Y, 0.02, 3.0, stall=0.3)
    model = cube_sim.load_model(Lifted(HULL, (keel,)).spec())
    dynamics, nu_r = Vehicle.from_model(model).dynamics, np.array([1.5, 0.02, 0.01, 0.0, 0.0, 0.02])
    lifted = np.linalg.norm(dynamics.absolute_products[1, 1, 0] * nu_r[1] * nu_r[0])
    assert lifted > 0.5
    left = missing(model, nu_r)
    without = missing(cube_sim.load_model(Lifted(HULL).spec()), nu_r)
    assert np.linalg.norm(without) < 1e-10
    assert np.linalg.norm(left) < 0.15 * lifted


@pytest.mark.parametrize("seed", range(4))
def test_a_fin_that_is_not_deflected_is_to_the_sharing_what_it_is_to_the_hull(seed):
    rng = np.random.default_rng(seed)
    chord = np.array([0.8, 0.0, -0.6]) if seed % 2 else X
    fin = Fin("keel", 0.3 * rng.normal(size=3), chord, Y, 0.02, 3.0, stall=0.3)
    model, nu = cube_sim.load_model(Lifted(HULL, (fin,)).spec()), rng.normal(size=6)
    by_products = np.einsum("ijk,j,k->i", Vehicle.from_model(model).lift.fins, nu, np.abs(nu))
    table = lift_tables(packed_parameters(model))[2]
    np.testing.assert_allclose(attached_wrench(table[0], tuple(nu)), by_products, atol=1e-9)


def test_strips_are_known_nearly_where_it_slips_more_than_it_turns():
    stations = np.column_stack([np.linspace(-0.7, 0.7, 15), np.full((15, 2), 0.12)])
    model = cube_sim.load_model(Lifted(HULL, stations=stations).spec())
    hull = Vehicle.from_model(model).dynamics
    for sway, yaw in ((0.3, 0.0), (0.2, 0.3), (-0.3, 0.5)):
        nu_r = np.array([1.0, sway, 0.0, 0.0, 0.0, yaw])
        drag = np.einsum("ijk,j,k", hull.absolute_products, nu_r, np.abs(nu_r))
        assert np.linalg.norm(drag) > 0.3
        assert np.linalg.norm(missing(model, nu_r)) < 0.2 * np.linalg.norm(drag)


def test_its_slope_is_that_of_the_wrench():
    dynamics = Vehicle.from_model(cube_sim.load_model(REMUS)).dynamics
    nu, step, still = np.array([1.3, 0.1, -0.2, 0.1, 0.2, -0.1]), 1e-6, np.zeros(6)

    def wrench(at):
        return dynamics.wrench(np.eye(3), at, still, np.zeros(3))

    slopes = [(wrench(nu + step * e) - wrench(nu - step * e)) / (2.0 * step) for e in np.eye(6)]
    np.testing.assert_allclose(dynamics.steady_wrench_slope(nu), np.array(slopes).T, atol=1e-6)
    straight = np.array([1.3, 0.1, -0.2, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(dynamics.steady_wrenches(straight[None, :3], Z[None])[0], wrench(straight), atol=1e-12)


def test_a_hull_without_lift_has_none():
    vehicle = Vehicle.from_model(cube_sim.load_model(CUBE))
    assert vehicle.lift is None
    assert vehicle.fins is None
    assert not vehicle.dynamics.lifts


def test_knowledge_scales_tables_and_fins_apart():
    vehicle = Vehicle.from_model(cube_sim.load_model(REMUS))
    true = vehicle.dynamics
    heavier = believed_dynamics(true, KnowledgeBlock(added_mass=1.3), vehicle.lift)
    nu, still, water = np.array([1.4, 0.2, 0.1, 0.0, 0.1, 0.2]), np.zeros(6), np.zeros(3)
    # The table holds the Coriolis terms of the added mass: another one changes none of them.
    at_rest = replace(heavier, added_mass=true.added_mass, velocity_products=true.velocity_products)
    np.testing.assert_allclose(at_rest.wrench(np.eye(3), nu, still, water), true.wrench(np.eye(3), nu, still, water))
    fins = believed_dynamics(true, KnowledgeBlock(fins=2.0), vehicle.lift)
    drag = believed_dynamics(true, KnowledgeBlock(drag=2.0), vehicle.lift)
    more = fins.absolute_products - true.absolute_products
    assert more[1, 1, 0] == pytest.approx(-9.64, rel=1e-9)  # Y_uudr, for a flow from the side
    assert drag.absolute_products[1, 1, 0] == true.absolute_products[1, 1, 0]  # of its fins alone
    assert drag.velocity_products[1, 0, 1] == pytest.approx(2.0 * -18.96)
