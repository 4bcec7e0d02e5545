"""Ballast that a vehicle lets go to rise without its thrusters."""

from __future__ import annotations

from math import sqrt

import mujoco
import numpy as np

from cube_sim.spatial import cross
from cube_sim.vehicle.vehicle import Vehicle

EMERGING_M = 0.05
"""Depth below the surface from which the hull comes out of the water, and so loses the lift again (choice) [m]."""
DAMPING_RATIO = 1.0
"""Of the bobbing at the surface, for the waves it makes (choice): at 1 the hull comes up and stops."""


class DropWeight:
    """Once dropped, the hull is lighter by the ballast's weight in water, and rises.

    The lift acts at the centre of mass; the ballast's inertia is neglected beside the vehicle's. At the surface the
    hull floats: what comes out of the water no longer carries, in proportion to how far it is out, and the waves it
    makes damp its bobbing. The force is never more than the ballast's weight, up or down: no hull, wherever it is when
    the ballast goes, moves faster than its drag allows for that weight.

    The force is held over a tick, and a spring that is held pushes on after its end: it would feed the bobbing. So it
    is the force that belongs to the end of the tick, as an implicit Euler step has it: by the convexity of the spring's
    energy U, -U'(z+) (z+ - z) <= U(z) - U(z+) at any stiffness and any length of the tick.

    Args:
        weight: in water [N].
        surface: height of the water's surface [m], world axes.
        vehicle: the hull that carries it.
        period_s: length of a tick.

    Attributes:
        dropped: whether it is gone.
    """

    def __init__(self, weight: float, surface: float, vehicle: Vehicle, period_s: float) -> None:
        self._weight, self._surface, self._vehicle, self._period = weight, surface, vehicle, period_s
        self._mobility = np.linalg.inv(vehicle.mass_matrix + vehicle.added_mass)
        self.dropped = False

    def drop(self) -> bool:
        """Let it go; False if there is none, or no longer."""
        if self.dropped or self._weight == 0.0:
            return False
        self.dropped = True
        return True

    def lift(self, data: mujoco.MjData) -> None:
        """Apply its lift for the coming tick.

        Args:
            data: MuJoCo's, up to date at the start of the tick, accelerations too.
        """
        if not self.dropped:
            return
        hull, T = self._vehicle, self._period
        body, dof = hull.body, hull.dof_address
        R = data.xmat[body].reshape(3, 3)
        arm = data.xipos[body] - data.xpos[body]
        rates = R @ data.qvel[dof + 3 : dof + 6]
        v = float(data.qvel[dof + 2] + cross(rates, arm)[2])
        turning = R @ data.qacc[dof + 3 : dof + 6]
        acceleration = float(data.qacc[dof + 2] + (cross(turning, arm) + cross(rates, cross(rates, arm)))[2])
        # how the centre of mass answers to the force: the last tick's is in the acceleration still
        along = np.concatenate([R[2], cross(arm @ R, R[2])])
        mobility = float(along @ self._mobility @ along)
        acceleration -= mobility * data.xfrc_applied[body, 2]
        stiffness = self._weight / EMERGING_M
        damping = 2.0 * DAMPING_RATIO * sqrt(stiffness / mobility)
        # depth at the end of the tick and velocity in its mean, but for what the force itself adds
        mean = v + 0.5 * acceleration * T
        depth = self._surface - data.xipos[body, 2] - mean * T
        step = 1.0 + 0.5 * T * mobility * (damping + stiffness * T)
        force = (stiffness * depth - damping * mean) / step
        data.xfrc_applied[body, 2] = min(self._weight, max(-self._weight, force))
