"""An attitude to turn to where the thrusters have too little in the one wished: sought, kept, left again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.pace import Facets
from cube_sim.control.roomiest_attitude import TO_BRAKE, has_enough, roomiest_attitude
from cube_sim.spatial import Matrix, Record, Vector, quaternion_from_rotation, rotation_from_quaternion


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


@dataclass
class Refuge:
    """The attitude turned to, while there is one.

    Attributes:
        attitude: it; None while none is taken.
    """

    attitude: FixedAttitude | None = None

    @property
    def taken(self) -> bool:
        """Whether the vehicle turns to one, or stays in it."""
        return self.attitude is not None

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
        self.attitude = None if found is None else FixedAttitude(quaternion_from_rotation(found))

    def look_back(self, kept: KeptMotion, wished: Matrix, short: bool) -> bool:
        """Leave it once the thrusters have plenty in the attitude that the mission asks for, or not enough in this one.

        Plenty, because what is believed of the water wanders: a hull that turned back for nothing would be thrown off
        its path for a second time.

        Args:
            kept: the motion.
            wished: the attitude that the mission asks for (3,3).
            short: whether the thrusters have too little now.

        Returns:
            Whether the vehicle turns back to the mission's attitude.
        """
        if self.attitude is None:
            return False
        if not short and has_enough(*kept, wished, TO_BRAKE):
            self.attitude = None
            return True
        if not has_enough(*kept, rotation_from_quaternion(self.attitude.quaternion)):
            self.attitude = None  # the path has turned: to be looked for anew
        return False
