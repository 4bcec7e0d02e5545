"""The inverse weights by which MuJoCo scales the softness of constraints, for the inertia with added mass."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.plugin.endless_water import endless_water

_BLOCKS = {int(mujoco.mjtJoint.mjJNT_FREE): (3, 3), int(mujoco.mjtJoint.mjJNT_BALL): (3,)}  # hinge and slide: (1,)


def set_inverse_weights(model: mujoco.MjModel, data: mujoco.MjData, hulls: Iterable[int]) -> None:
    """Recompute them for everything in the hulls' trees, and for all tendons.

    MuJoCo itself computes them before the water has touched M. The definitions are its own (mj_setConst), at the
    reference pose and under water, each from the diagonal of J M^-1 J':

    - body: the mean over its three translations [1/kg], and over its three rotations [1/(kg m^2)];
    - joint: the mean over its own axes, three by three;
    - tendon: the one value.

    Args:
        model: compiled, with its packed parameters in place; changed here.
        data: of that model; left at the reference pose.
        hulls: body indices.
    """
    roots = set(hulls)
    data.qpos[:] = model.qpos0
    with endless_water(model):
        mujoco.mj_forward(model, data)
    J = np.zeros((6, model.nv))
    for body in range(1, model.nbody):
        if model.body_rootid[body] in roots:
            mujoco.mj_jacBodyCom(model, data, J[:3], J[3:], body)
            model.body_invweight0[body] = _diagonal(model, data, J).reshape(2, 3).mean(axis=1)
    own = _diagonal(model, data, np.eye(model.nv))
    for joint in range(model.njnt):
        if model.body_rootid[model.jnt_bodyid[joint]] not in roots:
            continue
        first = int(model.jnt_dofadr[joint])
        for size in _BLOCKS.get(int(model.jnt_type[joint]), (1,)):
            model.dof_invweight0[first : first + size] = own[first : first + size].mean()
            first += size
    if model.ntendon:
        rows = np.zeros((model.ntendon, model.nv))
        mujoco.mju_sparse2dense(rows, data.ten_J, model.ten_J_rownnz, model.ten_J_rowadr, model.ten_J_colind)
        model.tendon_invweight0[:] = _diagonal(model, data, rows)


def _diagonal(model: mujoco.MjModel, data: mujoco.MjData, J: NDArray[np.float64]) -> NDArray[np.float64]:
    """Diagonal of J M^-1 J' for an (n, nv) J."""
    solution = np.zeros_like(J)
    mujoco.mj_solveM(model, data, solution, J)
    return np.einsum("ij,ij->i", J, solution)
