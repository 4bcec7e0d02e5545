"""What to ask of thrusters as if they were whole."""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled


@compiled
def asked_forces(force, efficiency, responsive, limits, rounding):
    """Forces (m,) [N] to ask of the thrusters so that weak ones make what is wanted; 0 of those that do not respond.

    What is a rounding off a whole thruster's interval is moved to its end.

    Args:
        force: (m,) wanted [N].
        efficiency: (m,) share of its force that each gives.
        responsive: (m,) bool.
        limits: (m,4) of whole thrusters [N].
        rounding: [N].
    """
    asked = np.zeros(len(force))
    for i in range(len(force)):
        if not responsive[i]:
            continue
        x = force[i] / efficiency[i]
        side = 0 if x < 0.0 else 2
        inside = min(max(x, limits[i, side]), limits[i, side + 1])
        asked[i] = inside if x != 0.0 and abs(inside - x) <= rounding else x
    return asked
