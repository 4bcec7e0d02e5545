"""Knowing when the thrusters have been short of what a slow pace asks for, and when they no longer are."""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled

SHORTAGE = np.dtype([("since", np.float64), ("pressed", np.bool_)])
"""For how long they have been short [s], and whether the vehicle turns to where they have more."""
PATIENCE_S = 1.0
"""How long the thrusters have to be short of what a slow pace asks for before the vehicle turns."""
BACK_RAD = 0.02
"""Within this angle of the attitude its mission asks for it is taken to be back there."""


@compiled
def watch_shortage(memory, enough, is_balanced, balanced, dt):
    """Turn to where the thrusters have more when they have been short for a while, and back when they are not.

    Args:
        memory: record `SHORTAGE`, moved on.
        enough: whether they have enough for the least pace.
        is_balanced: whether the attitude is balanced.
        balanced: record of `cube_sim.control.balancing.MEMORY`.
        dt: [s].
    """
    m, b = memory[0], balanced[0]
    m.since = 0.0 if enough else m.since + dt
    if m.since > PATIENCE_S:
        m.pressed = True
    elif m.pressed and is_balanced and not b.short and b.off < BACK_RAD:
        m.pressed = False
