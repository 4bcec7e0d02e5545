"""Where the water ends, and how a hull lies in it there."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.spatial import Vector
from cube_sim.vehicle.carried_water import link_records, pose_on
from cube_sim.vehicle.laws.surface import share_of_depth
from cube_sim.vehicle.plugin import layout, packing
from cube_sim.vehicle.vehicle import Vehicle

LEAST_LIFT = 1e-6
"""A hull floats that weighs less than the water it displaces by this share at least (rounding, a choice)."""

LEAST_EXTENT_M = 1e-9
"""Half height of what has no extent (rounding, a choice) [m]."""
UP = np.array([0.0, 0.0, 1.0])
"""World up in the axes of an upright body."""
_HEIGHT_M = 1e-9  # to which the height of a hull with links is found


def water_surface(model: mujoco.MjModel) -> float:
    """Height of the water's surface [m], world axes; inf for endless water.

    Raises:
        ModelError: the model has no water.
    """
    return float(packing.packed_parameters(model)[layout.SURFACE])


def floating_height(model: mujoco.MjModel, vehicle: Vehicle, lighter: float = 0.0) -> float:
    """Height of the origin of an upright hull over the surface it floats at [m]; just awash for one that sinks.

    Args:
        model: the vehicle's, with a surface or without.
        vehicle: the hull.
        lighter: weight that it has let go [N].
    """
    carried = Buoyancy.of(model, vehicle)
    extents, centres, lifts = *carried.extents(UP), carried.lifts
    awash = -float((centres + extents).max())
    if not weighs_less(vehicle, lighter):
        return awash
    weight, lift = _weight(vehicle) - lighter, _lift(vehicle)
    if len(lifts) > 1:
        return _balanced(extents, centres, lifts / lifts.sum(), max(weight / lift, 0.0), awash)
    # (1 + t)^2 (2 - t) / 4 = weight / lift: its root between -1 and 1 is where Viete's formula has it
    share = max(weight / lift, 0.0)
    t = 2.0 * np.cos((np.arccos(np.clip(1.0 - 2.0 * share, -1.0, 1.0)) + 4.0 * np.pi) / 3.0)
    return -float(t) * float(extents[0]) - float(centres[0])


def _balanced(extents: Vector, centres: Vector, shares: Vector, share: float, awash: float) -> float:
    """Height [m] at which that share of the whole volume is under water, by halving, from awash to dry."""
    low, high = awash, float((extents - centres).max())
    while high - low > _HEIGHT_M:
        middle = 0.5 * (low + high)
        t = np.clip(-(middle + centres) / np.maximum(extents, LEAST_EXTENT_M), -1.0, 1.0)
        under = float(shares @ (0.25 * (1.0 + t) ** 2 * (2.0 - t)))
        low, high = (middle, high) if under > share else (low, middle)
    return 0.5 * (low + high)


@dataclass(frozen=True)
class Buoyancy:
    """How the water carries a hull that comes out of it, with its links as at the reference pose.

    Attributes:
        half_axes: (n,3) of the ellipsoids over which the volumes of hull and links are spread [m].
        rotations: (n,3,3) from their axes to those of the hull's body.
        centres: (n,3) of them [m], body axes.
        lifts: (n,) that each has under water [N].
        weight: of all [N].
    """

    half_axes: NDArray[np.float64]
    rotations: NDArray[np.float64]
    centres: NDArray[np.float64]
    lifts: Vector
    weight: float

    @staticmethod
    def of(model: mujoco.MjModel, vehicle: Vehicle) -> Buoyancy:
        """That of a hull of a model made by `load_model`."""
        packed = packing.packed_parameters(model)
        start, count = int(packed[layout.HULLS]), int(packed[layout.COUNT])
        records = packed[start : start + count * layout.HULL_SIZE].reshape(count, layout.HULL_SIZE)
        hull = next(each for each in records if each[layout.BODY] == vehicle.body)
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        links = link_records(model, packed, vehicle.body)
        found = [(hull, np.eye(3), np.zeros(3))]
        found += [(link, *pose_on(data, vehicle.body, int(link[layout.BODY]))) for link in links]
        g = float(np.linalg.norm(vehicle.gravity))
        return Buoyancy(
            np.array([record[layout.HALF_AXES : layout.HALF_AXES + 3] for record, _, _ in found]),
            np.array([R for _, R, _ in found]),
            np.array([place + R @ record[layout.CENTRE : layout.CENTRE + 3] for record, R, place in found]),
            np.array([record[layout.DISPLACED_MASS] * g for record, _, _ in found]),
            _weight(vehicle),
        )

    def extents(self, up: Vector) -> tuple[Vector, Vector]:
        """Half heights (n,) and heights of the centres over the origin (n,) [m], with world up (3,) in body axes."""
        halves = np.linalg.norm(self.half_axes * np.einsum("nij,i->nj", self.rotations, up), axis=1)
        return halves, self.centres @ up

    def carried(self, depth: float, up: Vector) -> float:
        """What the water carries [N].

        Args:
            depth: of the hull's origin below the surface [m].
            up: world up in body axes (3,).
        """
        shares = [
            share_of_depth(depth - centre, max(half, LEAST_EXTENT_M))
            for half, centre in zip(*(each.tolist() for each in self.extents(up)), strict=True)
        ]
        return float(np.array(shares) @ self.lifts)

    def share(self, depth: float, up: Vector) -> float:
        """Share of what it carries whole; arguments are those of `carried`."""
        whole = float(self.lifts.sum())
        return self.carried(depth, up) / whole if whole > 0.0 else 1.0


def weighs_less(vehicle: Vehicle, lighter: float = 0.0) -> bool:
    """Whether a hull weighs less than the water it displaces, once it has let so much weight [N] go."""
    return _weight(vehicle) - lighter < (1.0 - LEAST_LIFT) * _lift(vehicle)


def _weight(vehicle: Vehicle) -> float:
    return vehicle.mass * float(np.linalg.norm(vehicle.gravity))


def _lift(vehicle: Vehicle) -> float:
    return vehicle.displaced_mass * float(np.linalg.norm(vehicle.gravity))
