"""MuJoCo's own functions for compiled code, by their names in its library.

`cube_sim.vehicle.plugin.hook` makes these names known to the process when it hooks the water in. Arguments are the
addresses of an mjModel and an mjData; nothing is checked.
"""

from __future__ import annotations

import mujoco
from numba import types

from cube_sim.native.compiled import compiled

STAGE_VELOCITY = int(mujoco.mjtStage.mjSTAGE_VEL)

_forward = types.ExternalFunction("mj_forward", types.void(types.int64, types.int64))
_forward_skip = types.ExternalFunction("mj_forwardSkip", types.void(types.int64, types.int64, types.int32, types.int32))
_check = types.ExternalFunction("mj_checkAcc", types.void(types.int64, types.int64))
_runge_kutta = types.ExternalFunction("mj_RungeKutta", types.void(types.int64, types.int64, types.int32))
_step = types.ExternalFunction("mj_step", types.void(types.int64, types.int64))


@compiled
def forward(model, data):
    """Everything that follows from the state of a simulation: `mj_forward`."""
    _forward(model, data)


@compiled
def forward_again(model, data):
    """`forward` of a state that has been through it, with other thrusters: positions and velocities are known."""
    _forward_skip(model, data, STAGE_VELOCITY, 0)


@compiled
def step(model, data, count, classical):
    """So many steps of the physics, from a state that has been through `forward`.

    Args:
        model: address of the mjModel.
        data: address of the mjData.
        count: how many.
        classical: whether the integrator is Runge-Kutta's. The first step goes on from what `forward` has found then;
            the bits are those of `mj_step`, which begins anew.
    """
    begun = 0
    if classical and count > 0:
        forward_again(model, data)
        _check(model, data)
        _runge_kutta(model, data, 4)
        begun = 1
    for _ in range(begun, count):
        _step(model, data)
