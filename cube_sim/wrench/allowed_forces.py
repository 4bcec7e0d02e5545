"""The forces each thruster can hold, as a union of closed intervals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import ActuationError
from cube_sim.wrench.axes import Matrix, Vector


@dataclass(frozen=True)
class AllowedForces:
    """Allowed forces of m thrusters.

    Attributes:
        low: (m,s) lower ends of the intervals [N], ascending; unused places are NaN.
        high: (m,s) upper ends [N].
    """

    low: Matrix
    high: Matrix

    @staticmethod
    def from_limits(limits: ArrayLike, thrusters: int, *, dead_zones: bool, rest: bool = True) -> AllowedForces:
        """Read a table of limits.

        Args:
            limits: (m,4) rows [F_max-, F_DZ-, F_DZ+, F_max+] [N]; (m,2) rows [F_max-, F_max+] mean no dead zone;
                one row holds for every thruster.
            thrusters: m.
            dead_zones: whether the dead zones count; without them a thruster holds anything between its maxima.
            rest: whether a thruster may also stand still inside its dead zone.

        Raises:
            ActuationError: another shape, a limit that is not finite, or limits out of order.
        """
        table = _table(limits, thrusters)
        low, high = np.full((thrusters, 3), np.nan), np.full((thrusters, 3), np.nan)
        for i, (bottom, reverse, forward, top) in enumerate(table.tolist()):
            parts = [(bottom, reverse), (0.0, 0.0), (forward, top)] if rest else [(bottom, reverse), (forward, top)]
            if not dead_zones:
                parts = [(bottom, top)]
            for place, (a, b) in enumerate(_merged(parts)):
                low[i, place], high[i, place] = a, b
        used = ~np.all(np.isnan(low), axis=0)
        return AllowedForces(low[:, used], high[:, used])

    @property
    def minimum(self) -> Vector:
        """(m,) most negative force [N]."""
        return np.nanmin(self.low, axis=1)

    @property
    def maximum(self) -> Vector:
        """(m,) most positive force [N]."""
        return np.nanmax(self.high, axis=1)


def _table(limits: ArrayLike, thrusters: int) -> Matrix:
    try:
        table = np.array(limits, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ActuationError(f"the limits are not a table of numbers: {error}") from None
    if table.ndim == 1:
        table = np.tile(table, (thrusters, 1))
    if table.ndim != 2 or len(table) != thrusters or table.shape[1] not in (2, 4):
        raise ActuationError(
            f"the limits have shape {np.shape(limits)}; {thrusters} thrusters need ({thrusters}, 4), ({thrusters}, 2), "
            "(4,) or (2,)"
        )
    if table.shape[1] == 2:
        table = np.insert(table, 1, np.zeros((2, thrusters)), axis=1)
    for i, row in enumerate(table):
        if not (np.all(np.isfinite(row)) and row[0] <= row[1] <= 0.0 <= row[2] <= row[3]):
            raise ActuationError(
                f"thruster {i + 1}: the limits {row.tolist()} must be finite and ordered "
                "F_max- <= F_DZ- <= 0 <= F_DZ+ <= F_max+"
            )
    return table + 0.0


def _merged(parts: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Join intervals that touch."""
    joined = [parts[0]]
    for low, high in parts[1:]:
        if low <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return joined
