"""What the motors of the thrusters turn at, as MuJoCo integrates it.

What a thruster gives now follows from what it was commanded: delayed by the model's `delay`, through the lag of its
motor. MuJoCo does not follow the exponential of that lag. It takes steps of its integrator (Euler, RK4), reads the
delayed command from a buffer of one entry a step, and holds or interpolates between the entries. At a step of half the
lag that is already another curve. So who wants to know what a whole thruster gives reads MuJoCo's own activations.
They follow from the commands alone: whatever fails in a thruster, fails behind them.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.thrusters import Thrusters


def activation_addresses(model: mujoco.MjModel, thrusters: Thrusters) -> NDArray[np.int64]:
    """Where in `act` the lagged commands (m,) of thrusters lie, whose force the characteristics give.

    Args:
        model: made by `load_model`.
        thrusters: of one hull of it.
    """
    first, number = model.actuator_actadr[thrusters.actuators], model.actuator_actnum[thrusters.actuators]
    return (first + number - 1).astype(np.int64)
