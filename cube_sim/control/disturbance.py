"""An estimate of the wrench the model does not explain: tether, wrong coefficients, unknown current."""

from __future__ import annotations

import numpy as np

from cube_sim.spatial import State, Vector
from cube_sim.vehicle.dynamics import Dynamics


class DisturbanceObserver:
    """The generalised-momentum observer, one time constant for all six axes.

    With p = (M_RB + M_A) nu and p' = tau - n(nu) + d, the estimate d_hat = (p - integral(tau - n + d_hat)) / T obeys
    d_hat' = (d - d_hat) / T: a first-order filter of the true disturbance that needs no acceleration (A. De Luca and
    R. Mattone 2003, for manipulators). It starts from zero.

    Args:
        dynamics: the model against which wrenches are compared.
        time: T [s].
    """

    def __init__(self, dynamics: Dynamics, time: float) -> None:
        self._dynamics, self._time = dynamics, time
        self._mass = dynamics.mass_matrix + dynamics.added_mass
        self._integral: Vector | None = None
        self._estimate = np.zeros(6)

    def update(self, state: State, applied: Vector, current: Vector, dt: float) -> Vector:
        """The estimate (6,) [N, N m], body axes, after a tick.

        Args:
            state: at the end of the tick.
            applied: the thrusters' wrench (6,) during the tick, body axes.
            current: the current (3,) the model is to reckon with [m/s], world axes.
            dt: length of the tick [s].
        """
        nu = np.concatenate([state.velocity, state.rates])
        momentum = self._mass @ nu
        if self._integral is None:
            self._integral = momentum
            return self._estimate
        model = self._dynamics.wrench(state.rotation, nu, np.zeros(6), current)
        self._integral = self._integral + dt * (applied - model + self._estimate)
        self._estimate = (momentum - self._integral) / self._time
        return self._estimate
