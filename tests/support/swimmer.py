"""The CUBE with an added mass that couples everything, in random motion: no term of the dynamics can hide."""

from __future__ import annotations

import mujoco
import numpy as np

import cube_sim
from cube_sim.spatial import quaternion_from_euler
from cube_sim.vehicle.state import read_state
from support.edited_cube import edited


def swimmer(centre_of_mass=(0.0, 0.0, 0.0)):
    """(model, vehicle): a full added mass, and a centre of mass [m] that may lie off the origin."""
    root = np.random.default_rng(4).normal(size=(6, 6)) * np.sqrt([80, 80, 80, 2, 2, 2])
    changes = {"hull:added_mass": (root.T @ root / 6.0).ravel(), "hull:centre_of_buoyancy": (0.01, -0.02, 0.05)}
    x, y, z = centre_of_mass
    model = cube_sim.load_model(edited(('<inertial pos="0 0 0"', f'<inertial pos="{x} {y} {z}"')), changes)
    return model, cube_sim.Vehicle.from_model(model)


def moving(rng, model, vehicle):
    """(data, state): somewhere, turned and moving at random, its accelerations computed."""
    data = mujoco.MjData(model)
    data.qpos[:3] = rng.normal(size=3)
    data.qpos[3:7] = quaternion_from_euler(*rng.uniform(-3.0, 3.0, 3))
    data.qvel[:] = rng.normal(size=6)
    mujoco.mj_forward(model, data)
    return data, read_state(vehicle, data)


def push(data, state, wrench) -> None:
    """Apply a wrench (6,) in body axes until the next one."""
    data.qfrc_applied[:3], data.qfrc_applied[3:] = state.rotation @ wrench[:3], wrench[3:]


def accelerations(data, state, wrench):
    """(linear, world axes; angular, body axes) under a wrench (6,) in body axes, by MuJoCo's forward dynamics."""
    push(data, state, wrench)
    mujoco.mj_forward(data.model, data)
    return data.qacc[:3].copy(), data.qacc[3:].copy()
