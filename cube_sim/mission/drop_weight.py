"""Ballast that a vehicle lets go to rise without its thrusters."""

from __future__ import annotations

import mujoco

EMERGING_M = 0.05
"""Depth below the surface from which the hull comes out of the water, and so loses the lift again (choice) [m]."""


class DropWeight:
    """Once dropped, the hull is lighter by the ballast's weight in water, and rises.

    The lift acts at the centre of mass; the ballast's inertia is neglected beside the vehicle's. At the surface the
    hull floats: what comes out of the water no longer carries, in proportion to how far it is out.

    Args:
        weight: in water [N].
        surface: height of the water's surface [m], world axes.
        body: MuJoCo's number of the hull.
    """

    def __init__(self, weight: float, surface: float, body: int) -> None:
        self._weight, self._surface, self._body = weight, surface, body
        self._dropped = False

    def drop(self) -> bool:
        """Let it go; False if there is none, or no longer."""
        if self._dropped or self._weight == 0.0:
            return False
        self._dropped = True
        return True

    def lift(self, data: mujoco.MjData) -> None:
        """Apply its lift for the coming tick."""
        if self._dropped:
            depth = self._surface - data.xipos[self._body, 2]
            data.xfrc_applied[self._body, 2] = self._weight * min(1.0, float(depth) / EMERGING_M)
