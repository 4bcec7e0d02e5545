"""What decides among the forces that make a wrench: a preferred force for each thruster, or for each of its sides."""

from __future__ import annotations

from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.options import Objective
from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import one_of, pairs, row


def side_targets(objective: str, target: ArrayLike | None, reactivity: ArrayLike | None, m: int) -> NDArray[np.float64]:
    """Preferred forces of an objective.

    Args:
        objective: see `Objective`.
        target: (m,) F_opt [N], for ``target`` only.
        reactivity: (m, 2) or (2,) F_react-, F_react+ [N], for the two reactivity objectives only.
        m: number of thrusters.

    Returns:
        (t, m, 3) t alternatives, each the preferred force per thruster on its negative side, off, positive side [N];
        the best allocation over all alternatives is wanted.

    Raises:
        AllocationError: an unknown objective, or arguments that do not belong to it.
    """
    one_of("objective", objective, get_args(Objective))
    reactive = objective in ("reactivity", "reactivity_by_side")
    if (objective == "target") != (target is not None):
        raise AllocationError("objective 'target' and the argument target go together: give both or neither")
    if reactive != (reactivity is not None):
        raise AllocationError("a reactivity objective and the argument reactivity go together: give both or neither")
    if objective == "energy":
        return np.zeros((1, m, 3))
    if target is not None:
        return np.ascontiguousarray(np.tile(row("target", target, m)[:, None], (1, 1, 3)))
    points = pairs("reactivity", reactivity if reactivity is not None else (), m)
    if np.any(points[:, 0] > 0.0) or np.any(points[:, 1] < 0.0):
        raise AllocationError("reactivity must hold F_react- <= 0 <= F_react+ for every thruster")
    if objective == "reactivity":
        return np.ascontiguousarray(np.stack([np.tile(points[:, [1]], (1, 3)), np.tile(points[:, [0]], (1, 3))]))
    return np.column_stack([points[:, 0], np.zeros(m), points[:, 1]])[None]
