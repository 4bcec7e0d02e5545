"""What a wrench costs the thrusters."""

from __future__ import annotations

import numpy as np

from cube_sim.spatial import Matrix
from cube_sim.wrench.tolerances import RANK_ROUNDING, RANK_TOLERANCE


def effort_matrix(A: Matrix, cost_limit: float | None = None) -> Matrix:
    """Q = (A A')^+ (6,6): w' Q w is the least |f|^2 with A f = w, for w in the range of A, dead zones and limits apart.

    Directions that cost a hundred times the cheapest one's force count as lost, and cost nothing. Under a cost limit
    that limit says what is lost, and everything costs what it costs.

    Args:
        A: (6,k) actuation matrix.
        cost_limit: of the directions the controller works with [N/N]; default none.
    """
    root = np.linalg.pinv(A, rcond=RANK_TOLERANCE if cost_limit is None else RANK_ROUNDING)
    return root.T @ root
