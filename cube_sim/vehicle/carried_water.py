"""The water on a hull and on the links it carries, as one body at the reference pose.

Whoever reckons with a vehicle takes it for a rigid body: its arm stands as the file has it (qpos0), and what its motion
does beside that is a disturbance.
"""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np

from cube_sim.spatial import Matrix, Vector, skew
from cube_sim.vehicle.plugin import layout


class CarriedWater(NamedTuple):
    """The water of a hull with all it carries, in the hull's axes at its origin.

    Attributes:
        added_mass: M_A (6,6) [kg, kg m, kg m^2].
        linear_damping: D (6,6) [N s/m, N s, N m s].
        quadratic_damping: D_q (6,6) [N s^2/m^2, ...]. That of links is exact for motion along, or about, one axis.
        displaced_mass: rho V [kg].
        centre_of_buoyancy: r_CB (3,) [m].
        added_mass_of_links: what of M_A is of links.
    """

    added_mass: Matrix
    linear_damping: Matrix
    quadratic_damping: Matrix
    displaced_mass: float
    centre_of_buoyancy: Vector
    added_mass_of_links: Matrix


def link_records(model: mujoco.MjModel, packed: Vector, hull: int) -> Matrix:
    """(n, `layout.HULL_SIZE`) the records of the links that a hull carries.

    Args:
        model: made by `load_model`.
        packed: its packed values.
        hull: index of the hull's body.
    """
    count, start = int(packed[layout.LINK_COUNT]), int(packed[layout.LINKS])
    if not count:
        return np.empty((0, layout.HULL_SIZE))
    records = packed[start : start + count * layout.HULL_SIZE].reshape(count, layout.HULL_SIZE)
    return records[model.body_rootid[records[:, layout.BODY].astype(int)] == hull]


def carried_water(data: mujoco.MjData, hull: Vector, links: Matrix) -> CarriedWater:
    """The sums over a hull and its links.

    Args:
        data: at the reference pose, its kinematics up to date.
        hull: the hull's record.
        links: (n, `layout.HULL_SIZE`) its links' records.
    """
    added, linear, quadratic = (_matrix(hull, start) for start in (layout.ADDED_MASS, layout.LINEAR, layout.QUADRATIC))
    displaced, centre = float(hull[layout.DISPLACED_MASS]), hull[layout.CENTRE : layout.ADDED_MASS]
    of_links = np.zeros((6, 6))
    if not len(links):
        return CarriedWater(added, linear, quadratic, displaced, centre, of_links)
    moment = displaced * centre
    for link in links:
        R, place = pose_on(data, int(hull[layout.BODY]), int(link[layout.BODY]))
        X = np.block([[R.T, -R.T @ skew(place)], [np.zeros((3, 3)), R.T]])  # twist of the link, by that of the hull
        of_links = of_links + X.T @ _matrix(link, layout.ADDED_MASS) @ X
        linear = linear + X.T @ _matrix(link, layout.LINEAR) @ X
        # column by column: the wrench of a unit velocity along that axis alone
        quadratic = quadratic + X.T @ _matrix(link, layout.QUADRATIC) @ (np.abs(X) * X)
        displaced += float(link[layout.DISPLACED_MASS])
        moment = moment + link[layout.DISPLACED_MASS] * (place + R @ link[layout.CENTRE : layout.ADDED_MASS])
    of_links = 0.5 * (of_links + of_links.T)
    centre = moment / displaced if displaced > 0.0 else centre
    return CarriedWater(added + of_links, linear, quadratic, displaced, centre, of_links)


def pose_on(data: mujoco.MjData, hull: int, body: int) -> tuple[Matrix, Vector]:
    """R (3,3) and place (3,) [m] of a body in the axes of a hull, by their indices."""
    R_WB = data.xmat[hull].reshape(3, 3)
    return R_WB.T @ data.xmat[body].reshape(3, 3), R_WB.T @ (data.xpos[body] - data.xpos[hull])


def _matrix(record: Vector, start: int) -> Matrix:
    """(6,6) of a record, where it lies column by column."""
    return np.ascontiguousarray(record[start : start + 36].reshape(6, 6).T)
