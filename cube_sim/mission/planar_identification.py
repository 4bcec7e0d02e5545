"""The planar model of a hull, read off its compiled MuJoCo model.

Accelerations at a set of planar velocities, thrusters at rest, are fitted with the terms of
`cube_sim.control.planar.model.PlanarModel`. The terms are exact for Kirchhoff's equations, linear and quadratic drag
and lift, so the fit is exact too or the hull is refused; a user's own force on the hull is included.
"""

from __future__ import annotations

from itertools import combinations, product

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.control.planar.model import PlanarModel
from cube_sim.errors import ModelError
from cube_sim.vehicle.current import still_water
from cube_sim.vehicle.plugin.endless_water import endless_water
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
VELOCITIES = np.array(list(product((-1.5, 0.3, 1.1), (-0.6, 0.1, 0.8), (-0.4, 0.05, 0.3))))
"""(u, v, r) at which the hull is looked at [m/s, m/s, rad/s]."""
WAY_ON = "`control.law: motion_6dof` knows it"
"""Said with every refusal: the law that takes any hull."""
LEAST_TURN = 0.01
"""Smallest part of a yaw rate that has to turn the course, 1 - m_ur / m_v."""


def identify_planar_model(model: mujoco.MjModel, vehicle: Vehicle) -> PlanarModel:
    """The planar equations the hull obeys when it is level in still water.

    Raises:
        ModelError: they hold other terms than the planar laws know, or turning would not turn the flow.
    """
    _require_uncoupled_inertia(vehicle)
    inertia = np.diag(vehicle.mass_matrix + vehicle.added_mass)[list(PLANE)]
    _require_rest(vehicle, inertia * _acceleration(model, vehicle, 0.0, 0.0, 0.0), inertia)
    resistance = -inertia * np.array([_acceleration(model, vehicle, *motion) for motion in VELOCITIES])
    terms = np.array([_terms(*motion) for motion in VELOCITIES])
    found = np.linalg.lstsq(terms, resistance, rcond=None)[0].T
    # An axis that nothing resists is measured by what turning takes: rounding is not to be read as a resistance.
    sizes = np.maximum(np.abs(resistance).max(axis=0), _turning(inertia))
    shares = np.abs(found) * np.abs(terms).max(axis=0) / sizes[:, None]
    for j, (axis, allowed) in enumerate(ALLOWED.items()):
        known = terms[:, [TERMS.index(term) for term in allowed]]
        left_over = resistance[:, j] - known @ np.linalg.lstsq(known, resistance[:, j], rcond=None)[0]
        if np.abs(left_over).max() <= NEGLIGIBLE * sizes[j]:
            continue
        strange = [term for term, share in zip(TERMS, shares[j], strict=True) if share > NEGLIGIBLE]
        strange = [term for term in strange if term not in allowed]
        polynomial = np.abs(terms @ found[j] - resistance[:, j]).max() <= NEGLIGIBLE * sizes[j]
        what = f"depends on {', '.join(strange)}" if strange and polynomial else "is no polynomial in u, v and r"
        raise ModelError(vehicle.name, f"its resistance to {axis} {what}, which the planar laws do not know; {WAY_ON}")
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
            f" its yaw rate does not turn its course; {WAY_ON}",
        )
    return result


def _require_uncoupled_inertia(vehicle: Vehicle) -> None:
    """Refuse a mass matrix, rigid and added, that couples surge, sway and yaw; the part at fault is named."""
    rigid, added = (M[np.ix_(PLANE, PLANE)] for M in (vehicle.mass_matrix, vehicle.added_mass))
    mass, axes = rigid + added, tuple(ALLOWED)
    allowed = NEGLIGIBLE * mass.max()
    pairs = [(i, j) for i, j in combinations(range(3), 2) if abs(mass[i, j]) > allowed]
    if not pairs:
        return
    x, y = vehicle.centre_of_mass[:2]
    parts = [f"{abs(x):.3g} m {'ahead of' if x > 0.0 else 'behind'}"] if abs(rigid[1, 2]) > allowed else []
    parts += [f"{abs(y):.3g} m to {'port' if y > 0.0 else 'starboard'} of"] if abs(rigid[0, 2]) > allowed else []
    off_centre = f"its centre of mass lies {' and '.join(parts)} the body's origin" if parts else ""
    off_diagonal = any(abs(added[i, j]) > allowed for i, j in pairs)
    because = " and ".join(filter(None, (off_centre, "its added mass is not diagonal" if off_diagonal else "")))
    couplings = ", ".join(f"{axes[i]} and {axes[j]} by {mass[i, j]:.3g} kg{' m' * (j == 2)}" for i, j in pairs)
    element = vehicle.name if off_centre else f"{vehicle.name}:added_mass"
    raise ModelError(element, f"{because}, which couples {couplings}: the planar laws know no coupling; {WAY_ON}")


def _require_rest(vehicle: Vehicle, force: NDArray[np.float64], inertia: NDArray[np.float64]) -> None:
    """Refuse a hull that is pushed, (3,) [N, N, N m], when it lies level and still in still water."""
    pushed = np.abs(force) > NEGLIGIBLE * _turning(inertia)
    if pushed.any():
        text = ", ".join(
            f"{axis} by {value:.3g} {'N m' if axis == 'yaw' else 'N'}"
            for axis, value, there in zip(ALLOWED, force, pushed, strict=True)
            if there
        )
        raise ModelError(
            vehicle.name, f"level and at rest it is pushed: {text}; the planar laws take it to float level; {WAY_ON}"
        )


def _turning(inertia: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3,) [N, N, N m] the largest forces and torque by which the velocities looked at turn a mass in a second."""
    u, v, r = np.abs(VELOCITIES).max(axis=0)
    return inertia * np.array([v * r, u * r, r * r])


def _terms(u: float, v: float, r: float) -> tuple[float, ...]:
    return (u, v, r, u * abs(u), v * abs(v), r * abs(r), u * v, u * r, v * r)


def _acceleration(model: mujoco.MjModel, vehicle: Vehicle, u: float, v: float, r: float) -> NDArray[np.float64]:
    """(u', v', r') [m/s^2, rad/s^2] of the level hull at yaw 0 in still water, thrusters at rest."""
    data = mujoco.MjData(model)
    at, dof = vehicle.qpos_address, vehicle.dof_address
    data.qpos[at + 3 : at + 7] = (1.0, 0.0, 0.0, 0.0)
    data.qvel[dof : dof + 6] = (u, v, 0.0, 0.0, 0.0, r)
    with still_water(model), endless_water(model):
        mujoco.mj_forward(model, data)
    a = data.qacc[dof : dof + 6]
    # MuJoCo's is the classical acceleration, u' and v' are taken in turning axes
    return np.array([a[0] + r * v, a[1] - r * u, a[5]])
