"""The forces thrusters may make: one checked table of limits, and each thruster's three sides read off it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import WrenchError
from cube_sim.wrench.arguments import bounded, numbers
from cube_sim.wrench.axes import Matrix

NEGATIVE, OFF, POSITIVE = 0, 1, 2
"""Columns of a side table; ``column - 1`` is the sign recorded as the thruster's subset."""


def thruster_limits(limits: ArrayLike, m: int) -> Matrix:
    """Bring the limits of m thrusters into one checked table.

    Args:
        limits: (m, 4) rows ``[F_max-, F_DZ-, F_DZ+, F_max+]`` [N]; (m, 2) rows ``[F_max-, F_max+]`` mean
            no dead zone; one row, (4,) or (2,), holds for every thruster.
        m: number of thrusters.

    Returns:
        (m, 4) table with ``F_max- <= F_DZ- <= 0 <= F_DZ+ <= F_max+`` in every row.

    Raises:
        WrenchError: the shape is none of the above, a limit is not finite or too large, or limits cross.
    """
    table = numbers("limits", limits, "table")
    shape = table.shape
    if table.ndim == 1:
        table = np.tile(table, (m, 1))
    if table.ndim != 2 or table.shape[0] != m or table.shape[1] not in (2, 4):
        raise WrenchError(f"limits have shape {shape}; {m} thrusters need ({m}, 4), ({m}, 2), (4,) or (2,)")
    if table.shape[1] == 2:
        rest = np.zeros(m)
        table = np.column_stack([table[:, 0], rest, rest, table[:, 1]])
    for i, row in enumerate(table):
        if not (np.all(np.isfinite(row)) and row[0] <= row[1] <= 0.0 <= row[2] <= row[3]):
            raise WrenchError(
                f"thruster {i + 1}: limits {row.tolist()} must be finite and ordered "
                "F_max- <= F_DZ- <= 0 <= F_DZ+ <= F_max+"
            )
    bounded("limits", table)
    # Adding zero turns -0.0 into 0.0, so that recorded forces never show a signed zero.
    return np.ascontiguousarray(table + 0.0)


def side_table(limits: Matrix, allow_off: bool) -> tuple[Matrix, Matrix]:
    """Intervals of each thruster's sides, in the order negative, off, positive.

    Args:
        limits: (m, 4) from `thruster_limits`.
        allow_off: whether a thruster may rest; without it the off interval is empty (low > high).

    Returns:
        low, high: (m, 3) [N] each.
    """
    m = len(limits)
    low, high = np.empty((m, 3)), np.empty((m, 3))
    low[:, NEGATIVE], high[:, NEGATIVE] = limits[:, 0], limits[:, 1]
    low[:, OFF], high[:, OFF] = (0.0, 0.0) if allow_off else (np.inf, -np.inf)
    low[:, POSITIVE], high[:, POSITIVE] = limits[:, 2], limits[:, 3]
    return low, high
