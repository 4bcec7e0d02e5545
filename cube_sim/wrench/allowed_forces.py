"""The forces each thruster can hold, as a union of closed intervals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.wrench.axes import Matrix, Vector
from cube_sim.wrench.limits import side_table, thruster_limits


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
            limits: [N], as for `thruster_limits`.
            thrusters: m.
            dead_zones: whether the dead zones count; without them a thruster holds anything between its maxima.
            rest: whether a thruster may also stand still inside its dead zone.

        Raises:
            WrenchError: as for `thruster_limits`.
        """
        table = thruster_limits(limits, thrusters)
        low, high = np.full((thrusters, 3), np.nan), np.full((thrusters, 3), np.nan)
        for i, sides in enumerate(np.stack(side_table(table, rest), axis=2).tolist()):
            parts = [(bottom, top) for bottom, top in sides if bottom <= top]
            if not dead_zones:
                parts = [(parts[0][0], parts[-1][1])]
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


def _merged(parts: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Join intervals that touch."""
    joined = [parts[0]]
    for low, high in parts[1:]:
        if low <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return joined
