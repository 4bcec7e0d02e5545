"""What a vehicle can do at all, roughly: what a mission drawn for it may ask."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

USED = 0.6
"""Share of its force that a vehicle may need for its top speed here: the rest is for steering."""
LOOPS_APART = 6.0
"""How many times slower than its heading a hull that steers by it can be brought onto a path: two loops around it."""
NO_TORQUE_NM = 1e-6
"""What rounding leaves of a torque counts as none."""
CONVERGED = 4.5
"""Time constants after which 1 % is left of an error."""


@dataclass(frozen=True)
class Ability:
    """Of a vehicle.

    Attributes:
        names: of its thrusters.
        limits: (m,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N].
        length_m: longest edge of its geometry.
        top_m_s: speed ahead at `USED` of its force.
        any_way_m_s: the same in the slowest direction of the body, or 0.4 of that ahead where one cannot be made.
        stands: whether forces along all axes and a torque about the vertical are its own: it can stay at a point.
        full: whether all components are its own, none much dearer than others.
        converges_s: what a hull that steers by its heading needs to be on its path: to turn half round from rest by the
            torque it has, and then to remove its error across. 0 where all components are its own.
    """

    names: tuple[str, ...]
    limits: np.ndarray
    length_m: float
    top_m_s: float
    any_way_m_s: float
    stands: bool
    full: bool
    converges_s: float


def ability_of(model: Path, lost: tuple[str, ...], planar: bool) -> Ability:
    """Reads the model; raises what loading it raises."""
    import cube_sim

    compiled = cube_sim.load_model(str(model))
    vehicle = cube_sim.Vehicle.from_model(compiled)
    names = tuple(vehicle.thrusters.names)
    keep = [i for i, name in enumerate(names) if name not in lost]
    A, limits = vehicle.actuation_matrix[:, keep], vehicle.thrusters.limits
    reach = np.array([_reach(row, limits[keep]) for row in A[:3]])
    hull = vehicle.dynamics
    speeds = np.array(
        [_speed(USED * reach[i], hull.linear_damping[i, i], hull.quadratic_damping[i, i]) for i in range(3)]
    )
    rows = [0, 1, 5] if planar else [0, 1, 2, 5]
    sideways = speeds[:2] if planar else speeds
    able = sideways[sideways > 0.05 * speeds[0]]
    slowest = (
        float(able.min()) if len(able) == len(sideways) else min(0.4 * float(speeds[0]), float(able.min(initial=9e9)))
    )
    stands, full = _independent(A[rows]), _independent(A[[0, 1, 5]] if planar else A)
    return Ability(
        names=names,
        limits=limits,
        length_m=2.0 * float(compiled.geom_size.max()),
        top_m_s=float(speeds[0]),
        any_way_m_s=slowest,
        stands=stands,
        full=full,
        converges_s=0.0 if full and stands else _converges(_reach(A[5], limits[keep]), hull.total_mass[5, 5]),
    )


def _converges(torque: float, inertia: float) -> float:
    """See `Ability.converges_s`; the heading's loop asks for 0.8 rad at most of what the torque gives [N m, kg m^2]."""
    if torque <= NO_TORQUE_NM:
        return 0.0
    slow = float(np.sqrt(inertia / torque))
    return slow * (2.0 * np.sqrt(np.pi) + CONVERGED * LOOPS_APART * np.sqrt(0.8))


def _reach(row: np.ndarray, limits: np.ndarray) -> float:
    """The force [N] thrusters make along both ways of an axis."""
    ahead = np.sum(np.where(row > 0.0, row * limits[:, 3], row * limits[:, 0]))
    astern = -np.sum(np.where(row > 0.0, row * limits[:, 0], row * limits[:, 3]))
    return float(min(ahead, astern))


def _speed(force: float, linear: float, quadratic: float) -> float:
    """Where linear v + quadratic v^2 is the force; at most 5 m/s."""
    if quadratic <= 0.0:
        return min(5.0, force / linear) if linear > 0.0 else 5.0
    return float(min(5.0, (np.sqrt(linear**2 + 4.0 * quadratic * force) - linear) / (2.0 * quadratic)))


def _independent(rows: np.ndarray) -> bool:
    """Whether each row is its own, the costliest combination within 20 times the cheapest; torques over 0.3 m."""
    scaled = rows.copy()
    scaled[3 if len(rows) > 3 else 2 :] /= 0.3
    gains = np.linalg.svd(scaled, compute_uv=False)
    return len(gains) == len(rows) and bool(gains[-1] > 0.05 * gains[0])
