"""MuJoCo's own functions for compiled code, by the names of `cube_sim.vehicle.plugin.guard`.

`cube_sim.vehicle.plugin.hook` makes these names known to the process when it hooks the water in. Arguments are the
addresses of an mjModel, an mjData and a buffer of `TEXT_BYTES`; nothing is checked. Each function answers whether all
went well; if not, MuJoCo's words are in the buffer, and the mjData have to be reset.
"""

from __future__ import annotations

from cube_sim.native.compiled import compiled
from cube_sim.native.intrinsics import External
from cube_sim.vehicle.plugin.guard import NAMES

_forward = External(NAMES["forward"], 3)
_forward_again = External(NAMES["forward_again"], 3)
_step_on = External(NAMES["step_on"], 3)
_step = External(NAMES["step"], 3)


@compiled
def forward(model, data, text):
    """Everything that follows from the state of a simulation: `mj_forward`."""
    return _forward(model, data, text) == 0


@compiled
def forward_again(model, data, text):
    """`forward` of a state that has been through it, with other thrusters: positions and velocities are known."""
    return _forward_again(model, data, text) == 0


@compiled
def step(model, data, text, count, classical):
    """So many steps of the physics, from a state that has been through `forward`.

    Args:
        model: address of the mjModel.
        data: address of the mjData.
        text: address of the buffer.
        count: how many.
        classical: whether the integrator is Runge-Kutta's. The first step goes on from what `forward` has found then;
            the bits are those of `mj_step`, which begins anew.
    """
    begun = 0
    if classical and count > 0:
        if _step_on(model, data, text) != 0:
            return False
        begun = 1
    for _ in range(begun, count):  # noqa: SIM110 - numba knows no generators in calls
        if _step(model, data, text) != 0:
            return False
    return True
