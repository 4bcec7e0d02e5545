"""Allowed forces of a set of motors: two intervals each, and rest where it is allowed."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import bounded, numbers

NEGATIVE, OFF, POSITIVE = 0, 1, 2
"""Columns of a side table; ``column - 1`` is the sign recorded as the motor's subset."""


def thruster_limits(limits: ArrayLike, motors: int) -> NDArray[np.float64]:
    """Bring the limits of ``motors`` motors into one checked table.

    Args:
        limits: (m, 4) rows ``[F_max-, F_DZ-, F_DZ+, F_max+]`` [N]; (m, 2) rows ``[F_max-, F_max+]`` mean
            no dead zone; one row, (4,) or (2,), holds for every motor.
        motors: number of motors m.

    Returns:
        (m, 4) table with ``F_max- <= F_DZ- <= 0 <= F_DZ+ <= F_max+`` in every row.

    Raises:
        AllocationError: the shape is none of the above, a limit is not finite, or limits cross.
    """
    table = numbers("limits", limits, "table")
    shape = table.shape
    if table.ndim == 1:
        table = np.tile(table, (motors, 1))
    if table.ndim != 2 or table.shape[0] != motors or table.shape[1] not in (2, 4):
        raise AllocationError(
            f"limits have shape {shape}; A has {motors} motors, so give ({motors}, 4), ({motors}, 2), (4,) or (2,)"
        )
    if table.shape[1] == 2:
        rest = np.zeros(motors)
        table = np.column_stack([table[:, 0], rest, rest, table[:, 1]])
    for i, row in enumerate(table):
        if not np.all(np.isfinite(row)):
            raise AllocationError(f"motor {i + 1}: limits {row.tolist()} are not finite")
        if not (row[0] <= row[1] <= 0.0 <= row[2] <= row[3]):
            raise AllocationError(
                f"motor {i + 1}: limits {row.tolist()} must be ordered F_max- <= F_DZ- <= 0 <= F_DZ+ <= F_max+"
            )
    bounded("limits", table)
    # Adding zero turns -0.0 into 0.0, so that recorded forces never show a signed zero.
    return np.ascontiguousarray(table + 0.0)


def side_table(limits: NDArray[np.float64], allow_off: bool) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Intervals of each motor's sides, in the order negative, off, positive.

    Args:
        limits: (m, 4) from `thruster_limits`.
        allow_off: whether a motor may rest; without it the off interval is empty (low > high).

    Returns:
        low, high: (m, 3) [N] each.
    """
    motors = len(limits)
    low, high = np.empty((motors, 3)), np.empty((motors, 3))
    low[:, NEGATIVE], high[:, NEGATIVE] = limits[:, 0], limits[:, 1]
    low[:, OFF], high[:, OFF] = (0.0, 0.0) if allow_off else (np.inf, -np.inf)
    low[:, POSITIVE], high[:, POSITIVE] = limits[:, 2], limits[:, 3]
    return low, high
