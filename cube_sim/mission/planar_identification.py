"""The planar model of a hull, read off its compiled MuJoCo model.

Accelerations at a set of planar velocities, thrusters at rest, are fitted with the terms of
`cube_sim.control.planar.model.PlanarModel`. The terms are exact for Kirchhoff's equations, linear and quadratic drag
and lift, so the fit is exact too or the hull is refused; a user's own force on the hull is included.
"""

from __future__ import annotations

from itertools import product

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.control.planar.model import PlanarModel
from cube_sim.errors import ModelError
from cube_sim.vehicle.vehicle import Vehicle

PLANE = (0, 1, 5)  # surge, sway, yaw
TERMS = ("u", "v", "r", "u|u|", "v|v|", "r|r|", "u v", "u r", "v r")
ALLOWED = {
    "surge": ("u", "u|u|", "v r"),
    "sway": ("v", "v|v|", "u v", "u r"),
    "yaw": ("r", "r|r|", "v", "v|v|", "u v", "u r"),
}
NEGLIGIBLE = 1e-6
"""Share of the largest force or torque of an axis below which one is not there."""
LEAST_TURN = 0.01
"""Smallest part of a yaw rate that has to turn the course, 1 - m_ur / m_v."""


def identify_planar_model(model: mujoco.MjModel, vehicle: Vehicle) -> PlanarModel:
    """The planar equations the hull obeys when it is level in still water.

    Raises:
        ModelError: they hold other terms than the planar laws know, or turning would not turn the flow.
    """
    mass = (vehicle.mass_matrix + vehicle.added_mass)[np.ix_(PLANE, PLANE)]
    coupling = np.abs(mass - np.diag(np.diag(mass))).max()
    if coupling > NEGLIGIBLE * mass.max():
        raise ModelError(f"{vehicle.name}:added_mass", "couples surge, sway and yaw, which the planar laws do not know")
    inertia = np.diag(mass)
    velocities = np.array(list(product((-1.5, 0.3, 1.1), (-0.6, 0.1, 0.8), (-0.4, 0.05, 0.3))))
    resistance = -inertia * np.array([_acceleration(model, vehicle, *motion) for motion in velocities])
    terms = np.array([_terms(*motion) for motion in velocities])
    found = np.linalg.lstsq(terms, resistance, rcond=None)[0].T
    sizes = np.abs(resistance).max(axis=0) + 1e-300
    left_over = np.abs(terms @ found.T - resistance).max(axis=0) / sizes
    shares = np.abs(found) * np.abs(terms).max(axis=0) / sizes[:, None]
    for axis, rest, share in zip(ALLOWED, left_over, shares, strict=True):
        strange = [
            term for term, size in zip(TERMS, share, strict=True) if size > NEGLIGIBLE and term not in ALLOWED[axis]
        ]
        if strange or rest > NEGLIGIBLE:
            what = f"depends on {', '.join(strange)}" if strange else "is no polynomial in u, v and r"
            raise ModelError(vehicle.name, f"its resistance to {axis} {what}, which the planar laws do not know")
    surge, sway, yaw = (dict(zip(TERMS, row.tolist(), strict=True)) for row in found)
    result = PlanarModel(
        m_u=float(inertia[0]),
        m_v=float(inertia[1]),
        m_r=float(inertia[2]),
        m_ur=sway["u r"],
        m_vr=-surge["v r"],
        D_u=surge["u"],
        D_uu=surge["u|u|"],
        D_v=sway["v"],
        D_vv=sway["v|v|"],
        D_uv=sway["u v"],
        K_r=yaw["r"],
        K_rr=yaw["r|r|"],
        K_v=yaw["v"],
        K_vv=yaw["v|v|"],
        K_uv=yaw["u v"],
        K_ur=yaw["u r"],
    )
    if not result.m_ur < (1.0 - LEAST_TURN) * result.m_v:
        raise ModelError(
            vehicle.name,
            f"slips sideways as fast as it turns (m_ur {result.m_ur:g} kg against m_v {result.m_v:g} kg):"
            " its yaw rate does not turn its course",
        )
    return result


def _terms(u: float, v: float, r: float) -> tuple[float, ...]:
    return (u, v, r, u * abs(u), v * abs(v), r * abs(r), u * v, u * r, v * r)


def _acceleration(model: mujoco.MjModel, vehicle: Vehicle, u: float, v: float, r: float) -> NDArray[np.float64]:
    """(u', v', r') [m/s^2, rad/s^2] of the level hull at yaw 0 in still water, thrusters at rest."""
    data = mujoco.MjData(model)
    at, dof = vehicle.qpos_address, vehicle.dof_address
    data.qpos[at + 3 : at + 7] = (1.0, 0.0, 0.0, 0.0)
    data.qvel[dof : dof + 6] = (u, v, 0.0, 0.0, 0.0, r)
    current = model.opt.wind.copy()
    model.opt.wind[:] = 0.0
    try:
        mujoco.mj_forward(model, data)
    finally:
        model.opt.wind[:] = current
    a = data.qacc[dof : dof + 6]
    # MuJoCo's is the classical acceleration, u' and v' are taken in turning axes
    return np.array([a[0] + r * v, a[1] - r * u, a[5]])
