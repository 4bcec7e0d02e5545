"""Whether a time step is short enough for the motors' lags, and the thrusters' buffers long enough for their delays.

MuJoCo goes on without a word in both cases. Under Euler, a lag with a step of twice its time constant swings for ever,
and with a longer step it grows without bound. A buffer that is too short cuts the delay off.

With x = step / lag, one step leaves of a difference between activation and command, by ``dyntype`` and integrator:

    filter       Euler, implicit, implicitfast  1 - x
    filter       RK4                            R(x) = 1 - x + x^2/2 - x^3/6 + x^4/24
    filterexact  Euler, implicit, implicitfast  exp(-x)
    filterexact  RK4                            1 + (R(x) - 1) (1 - exp(-x)) / x

and of a servo of a fin, within its rate, and of each of two lags in a row, what it leaves of `filter`.

The last is no misprint: RK4 averages the rate over its stages, and MuJoCo carries that average over the step by the
exponential. It is stable where R is.
"""

from __future__ import annotations

from math import ceil

import mujoco
import numpy as np

from cube_sim.errors import ModelError
from cube_sim.vehicle.mjcf.thruster_elements import is_thruster

_EULER_LIMIT = 2.0  # |1 - h/tau| = 1
_RK4_LIMIT = 2.785  # 1 - x + x^2/2 - x^3/6 + x^4/24 = 1
_ROUNDING = 1e-9


def require_time_step(model: mujoco.MjModel) -> None:
    """Refuse a lag that the model's time step and integrator make unstable, and a delay that its buffer cuts off.

    `load_model` asks this of the time step in the file. Ask again where you set another one on the compiled model.

    Args:
        model: compiled; only its actuators with ``biastype="user"``, the thrusters, are looked at.

    Raises:
        ModelError: names the actuator, both times and what would be right.
    """
    for i in (i for i in range(model.nu) if is_thruster(model, i)):
        name = model.actuator(i).name
        lags = 2 if model.actuator_dyntype[i] == mujoco.mjtDyn.mjDYN_USER else 1
        for lag_s in model.actuator_dynprm[i, :lags].tolist():
            _require_stable_lag(model, i, name, lag_s)
        _require_whole_delay(model, i, name)
    for i in np.flatnonzero(model.actuator_dyntype == mujoco.mjtDyn.mjDYN_USER).tolist():
        if model.actuator_dynprm[i, 0] > 0.0 and not is_thruster(model, i):  # the servo of a fin
            _require_stable_lag(model, i, model.actuator(i).name or f"actuator {i}", float(model.actuator_dynprm[i, 0]))


def _require_stable_lag(model: mujoco.MjModel, i: int, name: str, lag: float) -> None:
    rk4 = model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
    exact = model.actuator_dyntype[i] == mujoco.mjtDyn.mjDYN_FILTEREXACT
    if exact and not rk4:
        return
    step = model.opt.timestep
    limit = _RK4_LIMIT if rk4 else _EULER_LIMIT
    if step >= limit * lag:
        method = mujoco.mjtIntegrator(model.opt.integrator).name.removeprefix("mjINT_")
        remedy = "integrator implicitfast with dyntype='filterexact'" if rk4 else "dyntype='filterexact'"
        servo = model.actuator_dyntype[i] == mujoco.mjtDyn.mjDYN_USER
        otherwise = "" if servo else f", or {remedy}, which is stable at any"
        raise ModelError(
            name,
            f"its lag of {lag:g} s is unstable under {method} with a time step of {step:g} s; take a step below "
            f"{limit * lag:g} s{otherwise}",
        )


def _require_whole_delay(model: mujoco.MjModel, i: int, name: str) -> None:
    step, delay, samples = model.opt.timestep, float(model.actuator_delay[i]), int(model.actuator_history[i, 0])
    if not 0.0 <= delay < np.inf:
        raise ModelError(name, f"has a delay of {delay:g} s; a command arrives at once (0) or later")
    needed = ceil(delay / step * (1.0 - _ROUNDING))
    if samples < needed:
        raise ModelError(
            name,
            f"its delay of {delay:g} s is cut off at {samples * step:g} s: nsample={samples} commands, one per "
            f"time step of {step:g} s; {needed} are right",
        )
