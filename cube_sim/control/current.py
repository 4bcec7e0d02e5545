"""An estimate of the current, from the wrench that still water does not explain."""

from __future__ import annotations

import numpy as np

from cube_sim.spatial import Matrix, State, Vector
from cube_sim.vehicle.dynamics import Dynamics

DIFFERENCE = 1e-3
"""Step of the central differences [m/s]."""
QUIET = 0.05
"""Relative speed [m/s] at which the slope of the drag equals the damping s: slower flow is taken for noise."""
SLOWEST_DECAY = 1e-3
"""Share of its speed per second, of which a slope of the drag below takes less (choice): nothing is read off it."""


class CurrentObserver:
    """Gauss-Newton on the current that would explain the residual force, at the pace of one time constant.

    A wrong current leaves the force d = n(nu, v_hat) - n(nu, v_c) unexplained. To first order d = J (v_c - v_hat), J =
    -dn/dv_c of the vehicle's own drag, added mass and Munk moment. So v_hat' = (J' J + s^2 I)^-1 J' d / T. The estimate
    is kept in world axes, where a steady current stands still while the vehicle turns. The force of a wrong
    drag coefficient turns with the vehicle and averages out. At rest relative to the water drag has no slope, and the
    current cannot be observed; the damping s keeps the estimate constant there.

    Args:
        dynamics: the controller's knowledge of the vehicle.
        time: T [s]; several times that of the observer whose residual it reads.
    """

    def __init__(self, dynamics: Dynamics, time: float) -> None:
        self._dynamics, self._time = dynamics, time
        slope = float(np.median(np.abs(np.diag(self._slope(np.eye(3), QUIET * np.ones(6), np.zeros(3))))))
        self._damping = max(slope, SLOWEST_DECAY * float(np.trace(dynamics.total_mass[:3, :3])) / 3.0)
        self.estimate = np.zeros(3)

    def update(self, state: State, residual: Vector, dt: float) -> Vector:
        """The estimate (3,) [m/s], world axes, after a tick.

        Args:
            state: at the end of the tick.
            residual: wrench (6,) the model does not explain with the estimate as it stands, body axes.
            dt: length of the tick [s].
        """
        nu = np.concatenate([state.velocity, state.rates])
        J = self._slope(state.rotation, nu, self.estimate)
        step = np.linalg.solve(J.T @ J + self._damping**2 * np.eye(3), J.T @ residual[:3])
        self.estimate = self.estimate + dt / self._time * step
        return self.estimate

    def _slope(self, rotation: Matrix, nu: Vector, current: Vector) -> Matrix:
        """J (3,3) [N s/m]: how the force of the water, body axes, grows with the current, world axes."""
        rest = np.zeros(6)
        columns = [
            self._dynamics.wrench(rotation, nu, rest, current - step)[:3]
            - self._dynamics.wrench(rotation, nu, rest, current + step)[:3]
            for step in DIFFERENCE * np.eye(3)
        ]
        return np.column_stack(columns) / (2.0 * DIFFERENCE)
