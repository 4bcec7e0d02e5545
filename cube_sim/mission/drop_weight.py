"""Ballast that a vehicle lets go to rise without its thrusters."""

from __future__ import annotations

import mujoco

from cube_sim.vehicle.vehicle import Vehicle


class DropWeight:
    """Once dropped, the hull is lighter by the ballast's weight in water, and rises until it floats.

    The lift acts at the centre of mass; the ballast's inertia is neglected beside the vehicle's.

    Args:
        weight: in water [N].
        vehicle: the hull that carries it.

    Attributes:
        dropped: whether it is gone.
    """

    def __init__(self, weight: float, vehicle: Vehicle) -> None:
        self._weight, self._vehicle = weight, vehicle
        self.dropped = False

    def drop(self) -> bool:
        """Let it go; False if there is none, or no longer."""
        if self.dropped or self._weight == 0.0:
            return False
        self.dropped = True
        return True

    def lift(self, data: mujoco.MjData) -> None:
        """Apply its lift for the coming tick."""
        if self.dropped:
            data.xfrc_applied[self._vehicle.body, 2] = self._weight
