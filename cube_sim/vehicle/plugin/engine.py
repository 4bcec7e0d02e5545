"""MuJoCo's own functions for compiled code, by their names in its library.

`cube_sim.vehicle.plugin.hook` makes these names known to the process when it hooks the water in. Arguments are the
addresses of an mjModel and an mjData; nothing is checked.
"""

from __future__ import annotations

from numba import types

from cube_sim.native.compiled import compiled

_forward = types.ExternalFunction("mj_forward", types.void(types.int64, types.int64))
_step = types.ExternalFunction("mj_step", types.void(types.int64, types.int64))


@compiled
def forward(model, data):
    """Everything that follows from the state of a simulation: `mj_forward`."""
    _forward(model, data)


@compiled
def step(model, data, count):
    """So many steps of the physics: `mj_step`."""
    for _ in range(count):
        _step(model, data)
