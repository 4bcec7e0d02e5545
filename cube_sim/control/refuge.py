"""An attitude to turn to where the thrusters have too little in the one wished: sought, kept, left again."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.pace import Facets
from cube_sim.control.roomiest_attitude import TO_BRAKE, TO_SPARE, excess, has_enough, roomiest_attitude
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Record, Vector, quaternion_from_rotation
from cube_sim.tuples import rotation_rows, triple

REFUGE = np.dtype([("quaternion", np.float64, 4), ("taken", np.bool_)])
"""The attitude turned to, q_WD (4,) wxyz, and whether there is one."""


class KeptMotion(NamedTuple):
    """A motion that the thrusters have to keep steady, as `has_enough` asks for it.

    Attributes:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        facets: of what the thrusters can make.
        force_ratio: share of their force that the supply leaves the thrusters.
        flow: velocity through the water (3,) [m/s], world axes.
    """

    hull: Record
    facets: Facets
    force_ratio: float
    flow: Vector


class Refuge:
    """The attitude turned to, while there is one.

    Attributes:
        memory: record `REFUGE`.
    """

    def __init__(self) -> None:
        self.memory: Record = np.zeros(1, REFUGE)

    @property
    def taken(self) -> bool:
        """Whether the vehicle turns to one, or stays in it."""
        return bool(self.memory["taken"][0])

    @property
    def attitude(self) -> FixedAttitude | None:
        """It; None while none is taken."""
        return FixedAttitude(self.memory["quaternion"][0].copy()) if self.taken else None

    def seek(self, kept: KeptMotion, now: Matrix, wished: Matrix) -> None:
        """Take the nearest attitude in which the thrusters have enough, if they have too little where the hull goes.

        Args:
            kept: the motion.
            now: R_WB (3,3).
            wished: the attitude that the mission asks for (3,3).
        """
        found = roomiest_attitude(*kept, now)
        if found is None and has_enough(*kept, now) and not has_enough(*kept, wished):
            found = now  # it has come by an attitude to stay in
        self.memory["taken"] = found is not None
        if found is not None:
            self.memory["quaternion"] = quaternion_from_rotation(found)

    def look_back(self, kept: KeptMotion, wished: Vector, short: bool) -> bool:
        """See `look_back`, of the quaternion (4,) that the mission asks for."""
        return self.taken and bool(look_back(self.memory, kept.hull, *kept.facets, *kept[2:], wished, short))


@compiled
def look_back(refuge, hull, normals, bounds, held_shares, force_ratio, flow_W, wished, short):
    """Leave a refuge once the thrusters have plenty in the attitude that the mission asks for, or not enough in it.

    Plenty, because what is believed of the water wanders: a hull that turned back for nothing would be thrown off its
    path for a second time.

    Args:
        refuge: record `REFUGE` of one that is taken, moved on.
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        normals: of `ForceBudget`, like the next two.
        bounds: of it.
        held_shares: of it.
        force_ratio: share of their force that the supply leaves the thrusters.
        flow_W: velocity through the water to be kept (3,) [m/s], world axes.
        wished: the attitude that the mission asks for, a quaternion (4,).
        short: whether the thrusters have too little now.

    Returns:
        Whether the vehicle turns back to the mission's attitude.
    """
    r, flow, mean = refuge[0], triple(flow_W), 0.0
    for i in range(len(bounds)):
        mean += bounds[i] / len(bounds)
    there = np.array(rotation_rows((wished[0], wished[1], wished[2], wished[3])))
    if not short and excess(hull, normals, bounds, held_shares, force_ratio, flow, there) <= -TO_BRAKE * mean:
        r.taken = False
        return True
    q = r.quaternion
    here = np.array(rotation_rows((q[0], q[1], q[2], q[3])))
    if not excess(hull, normals, bounds, held_shares, force_ratio, flow, here) <= -TO_SPARE * mean:
        r.taken = False  # the path has turned: to be looked for anew
    return False
