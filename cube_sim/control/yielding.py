"""Which part of a demand gives way where missing thrusters couple forces with torques.

All that can be produced has N_f' F + N_t' M = b. A demand off it has to be changed, in its forces or in its torques. A
force that is not made moves the vehicle off its path. A torque about a level axis that is not made tilts the hull until
its righting moment makes up for it. So torques about level axes give way first, as far as the hull can hold them: with
a tilt of 30 degrees at most, a righting moment r holds the torque of a force F on a lever of r / (2 F). On a longer one
the force gives way, and the attitude has to point it (`balanced_attitude`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.dynamics import Dynamics

SMALL_FORCE = 1e-3
"""Share of the weight below which a force counts as none."""
MAX_TILT_SINE = 0.5
"""How far the hull may be tilted by torques that are left to it: by 30 degrees."""


class WaterHold(NamedTuple):
    """What the water holds of a hull by itself.

    Attributes:
        righting: r (3,) [N m], body axes, see `Dynamics.righting_moment`.
        force: the size of the forces that its missions ask for [N], positive.
    """

    righting: Vector
    force: float

    @staticmethod
    def of(dynamics: Dynamics, speed_m_s: float) -> WaterHold:
        """Of a hull whose missions ask for its drag ahead at this speed, and for its weight less its buoyancy."""
        drag = dynamics.damping(np.array([speed_m_s, 0.0, 0.0, 0.0, 0.0, 0.0]))
        force = float(np.linalg.norm(drag[:3])) + abs(dynamics.weight - dynamics.buoyancy)
        return WaterHold(dynamics.righting_moment, float(np.hypot(force, SMALL_FORCE * max(1.0, dynamics.weight))))

    def weights(self, up: Vector, force: float | None = None) -> Matrix:
        """W (6,6) [1, m^2]: how readily each force and torque gives way; W^-1 is the price of a change.

        W = diag(I, (r'z / 2 F)^2 (I - z z')). Torques about the vertical z, and all torques of a hull that does
        not right itself, do not give way: nothing else holds them.

        Args:
            up: z = R' e_z (3,), world up in body axes.
            force: F, the size of the forces that are asked for now [N], if that is more than what missions ask for.
        """
        F = self.force if force is None else max(force, self.force)
        W = np.zeros((6, 6))
        W[:3, :3] = np.eye(3)
        lever = MAX_TILT_SINE * max(0.0, float(self.righting @ up)) / F
        W[3:, 3:] = lever**2 * (np.eye(3) - np.outer(up, up))
        return W
