"""An estimate of the current, from the wrench that still water does not explain."""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import State, Vector
from cube_sim.tuples import length, solve_positive, triple
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.laws.hull_motion import inverse_dynamics

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
        self._hull, self.time = dynamics.record, time
        slope = current_slope(self._hull, np.eye(3), QUIET * np.ones(3), QUIET * np.ones(3), (0.0, 0.0, 0.0))
        damping = float(np.sort(np.abs(np.diag(slope)))[1])  # the median: numpy's loads masked arrays
        self.damping = max(damping, SLOWEST_DECAY * float(np.trace(dynamics.total_mass[:3, :3])) / 3.0)
        self.estimate = np.zeros(3)

    def update(self, state: State, residual: Vector, dt: float) -> Vector:
        """The estimate (3,) [m/s], world axes, after a tick.

        Args:
            state: at the end of the tick.
            residual: wrench (6,) the model does not explain with the estimate as it stands, body axes.
            dt: length of the tick [s].
        """
        observe_current(
            self._hull,
            self.damping,
            dt / self.time,
            self.estimate,
            state.rotation,
            state.velocity,
            state.rates,
            residual,
        )
        return self.estimate.copy()


@compiled
def told_of_water(rates, smeared_time):
    """Share of what a turning hull does not explain that the water may be the cause of.

    The residual is smeared over a time T, in axes that turn at w: of what stands still in the world 1 / (1 + (w T)^2)
    is left there in phase. The rest, and the lag of thrusters whose forces turn with the hull, is not of the water.

    Args:
        rates: 3-tuple [rad/s].
        smeared_time: T [s]; at 0 everything counts.
    """
    angle = smeared_time * length(rates)
    return 1.0 / (1.0 + angle * angle)


@compiled
def observe_current(hull, damping, share, estimate, R, v, w, residual):
    """One tick of the observer.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        damping: s [N s/m].
        share: dt / T.
        estimate: (3,) [m/s], world axes, moved on.
        R: R_WB (3,3).
        v: (3,) over ground [m/s], body axes.
        w: (3,) [rad/s], body axes.
        residual: (6,) [N, N m], body axes.
    """
    J = current_slope(hull, R, v, w, triple(estimate))
    d = (residual[0], residual[1], residual[2])
    square = np.empty((3, 3))
    for i in range(3):
        for j in range(i + 1):
            square[i, j] = J[0, i] * J[0, j] + J[1, i] * J[1, j] + J[2, i] * J[2, j]
        square[i, i] += damping * damping
    right = (
        J[0, 0] * d[0] + J[1, 0] * d[1] + J[2, 0] * d[2],
        J[0, 1] * d[0] + J[1, 1] * d[1] + J[2, 1] * d[2],
        J[0, 2] * d[0] + J[1, 2] * d[1] + J[2, 2] * d[2],
    )
    step = solve_positive(square, right)
    for i in range(3):
        estimate[i] += share * step[i]


@compiled
def current_slope(hull, R, v, w, current):
    """J (3,3) [N s/m]: how the force of the water, body axes, grows with the current (3-tuple), world axes."""
    nu, rest = (v[0], v[1], v[2], w[0], w[1], w[2]), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    a, b, c = current
    J = np.empty((3, 3))
    for j in range(3):
        x, y, z = (DIFFERENCE if j == 0 else 0.0), (DIFFERENCE if j == 1 else 0.0), (DIFFERENCE if j == 2 else 0.0)
        less = inverse_dynamics(hull, R, nu, rest, (a - x, b - y, c - z))
        more = inverse_dynamics(hull, R, nu, rest, (a + x, b + y, c + z))
        for i in range(3):
            J[i, j] = (less[i] - more[i]) / (2.0 * DIFFERENCE)
    return J
