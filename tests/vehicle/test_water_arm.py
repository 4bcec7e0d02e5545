"""A hull with an arm: the hull keeps its added mass while joints move."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from support.water_bodies import DENSITY, random_body, set_state, tumbling

import cube_sim
from cube_sim.spatial import rotation_from_quaternion

ARM = """<body name="upper" pos="0.2 0.1 -0.1" euler="10 20 30"><joint name="shoulder" axis="0 1 0" armature="0.02"/>
  <inertial pos="0.2 0 0" mass="2" fullinertia="0.01 0.05 0.05 0.001 0.002 0"/>
  <body name="fore" pos="0.4 0 0"><joint name="elbow" type="ball"/>
  <geom type="capsule" size="0.03" fromto="0 0 0 0.3 0 0"/></body></body>"""


def ideal(seed: int):
    rng = np.random.default_rng(seed)
    return rng, random_body(rng, 3.0).ideal()


def full_mass(model, data) -> np.ndarray:
    M = np.zeros((model.nv, model.nv))
    mujoco.mju_sym2dense(M, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    return M


def moved(model, rng) -> mujoco.MjData:
    data = mujoco.MjData(model)
    set_state(data, tumbling(rng))
    data.qpos[7] = 0.6
    q = rng.normal(size=4)
    data.qpos[8:12] = q / np.linalg.norm(q)
    data.qvel[6:] = rng.normal(size=4)
    mujoco.mj_forward(model, data)
    return data


def impulse(body, model, data):
    """(linear, angular about the world's origin): of hull and arm, and of the water with the hull, world axes."""
    mujoco.mj_forward(model, data)
    mujoco.mj_subtreeVel(model, data)
    R = data.xmat[1].reshape(3, 3)
    nu = np.concatenate([R.T @ data.qvel[:3], data.qvel[3:6]])
    p, h = R @ (body.added[:3] @ nu), R @ (body.added[3:] @ nu)
    total = model.body_subtreemass[1] * data.subtree_linvel[1]
    angular = data.subtree_angmom[1] + np.cross(data.subtree_com[1], total) + h + np.cross(data.xpos[1], p)
    return total + p, angular


@pytest.mark.parametrize("seed", range(3))
def test_inertia_is_mujocos_own_plus_added_mass(seed):
    """Against the same model compiled dry: M differs by B' M_A B in the hull's block, and by nothing elsewhere."""
    rng, body = ideal(seed)
    spec = body.spec(inside=ARM)
    spec.body("hull").simple = 0
    dry, wet = spec.compile(), cube_sim.load_model(body.spec(inside=ARM))
    data = moved(wet, rng)
    other = mujoco.MjData(dry)
    other.qpos[:], other.qvel[:] = data.qpos, data.qvel
    mujoco.mj_forward(dry, other)
    R = data.xmat[1].reshape(3, 3)
    B = np.zeros((6, wet.nv))
    B[:3, :3], B[3:, 3:6] = R.T, np.eye(3)
    np.testing.assert_allclose(full_mass(wet, data), full_mass(dry, other) + B.T @ body.added @ B, atol=1e-11)


def test_armature_of_the_free_joint_is_kept():
    """MuJoCo adds it to the diagonal; overwriting the block must not lose it."""
    rng, body = ideal(4)
    spec = body.spec()
    spec.joint("hull").armature = 2.5
    plain, armoured = body.model(), cube_sim.load_model(spec)
    state, masses = tumbling(rng), []
    for model in (plain, armoured):
        data = mujoco.MjData(model)
        set_state(data, state)
        mujoco.mj_forward(model, data)
        masses.append(full_mass(model, data))
    np.testing.assert_allclose(masses[1] - masses[0], 2.5 * np.eye(6), atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_energy_and_impulse_of_hull_and_arm_are_kept(seed):
    """Free flight in an ideal fluid without gravity: kinetic energy, linear and angular impulse stay."""
    rng, body = ideal(seed)
    body = replace(body, volume=body.mass / DENSITY)
    model = body.model(
        timestep=0.002, inside=ARM, extra='<option gravity="0 0 0"><flag energy="enable" contact="disable"/></option>'
    )
    data = moved(model, rng)

    def invariants():
        linear, angular = impulse(body, model, data)
        return np.array([data.energy[1], *linear, *angular])

    first = invariants()
    mujoco.mj_step(model, data, nstep=1500)
    # the rotor's armature is inertia that mj_subtreeVel does not count: its share is left out of the angular impulse
    np.testing.assert_allclose(invariants()[:4], first[:4], atol=1e-6 * np.abs(first).max())


def test_angular_impulse_is_kept_without_rotor_inertia():
    rng, body = ideal(7)
    model = body.model(
        timestep=0.002,
        inside=ARM.replace(' armature="0.02"', ""),
        extra='<option gravity="0 0 0"><flag contact="disable"/></option>',
    )
    data = moved(model, rng)
    _, first = impulse(body, model, data)
    mujoco.mj_step(model, data, nstep=1500)
    np.testing.assert_allclose(impulse(body, model, data)[1], first, atol=1e-6 * np.abs(first).max())


def test_vehicle_counts_the_arm_at_the_reference_pose():
    _, body = ideal(1)
    model = body.model(inside=ARM)
    vehicle = cube_sim.Vehicle.from_model(model)
    assert vehicle.mass == pytest.approx(model.body_subtreemass[1])
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    M, R = full_mass(model, data)[:6, :6], rotation_from_quaternion(data.qpos[3:7])
    B = np.block([[R, np.zeros((3, 3))], [np.zeros((3, 3)), np.eye(3)]])
    np.testing.assert_allclose(vehicle.mass_matrix + vehicle.added_mass, B.T @ M @ B, atol=1e-10)
