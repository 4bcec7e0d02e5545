"""An estimate of the wrench the model does not explain: tether, wrong coefficients, unknown current."""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record, State, Vector
from cube_sim.tuples import matrix_times_tuple, sextuple, triple
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.laws.hull_motion import inverse_dynamics

MEMORY = np.dtype([("integral", np.float64, 6), ("estimate", np.float64, 6), ("started", np.bool_)])
"""What the observer remembers: the integral [N s, N m s], its estimate [N, N m], whether there was a tick before."""


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
        self._hull, self.time = dynamics.record, time
        self.memory: Record = np.zeros(1, MEMORY)

    def update(self, state: State, applied: Vector, current: Vector, dt: float) -> Vector:
        """The estimate (6,) [N, N m], body axes, after a tick.

        Args:
            state: at the end of the tick.
            applied: the thrusters' wrench (6,) during the tick, body axes.
            current: the current (3,) the model is to reckon with [m/s], world axes.
            dt: length of the tick [s].
        """
        observe_disturbance(
            self._hull, self.time, self.memory, state.rotation, state.velocity, state.rates, applied, current, dt
        )
        return np.array(self.memory["estimate"][0])


@compiled
def observe_disturbance(hull, time, memory, R, v, w, applied, current, dt):
    """One tick of the observer; arguments as in `DisturbanceObserver.update`, memory a record `MEMORY`."""
    m = memory[0]
    nu = (v[0], v[1], v[2], w[0], w[1], w[2])
    momentum = matrix_times_tuple(hull[0].total_mass, nu)
    if not m.started:
        m.started = True
        for i in range(6):
            m.integral[i] = momentum[i]
        return
    model = inverse_dynamics(hull, R, nu, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), triple(current))
    tau = sextuple(applied)
    for i in range(6):
        m.integral[i] += dt * (tau[i] - model[i] + m.estimate[i])
        m.estimate[i] = (momentum[i] - m.integral[i]) / time
