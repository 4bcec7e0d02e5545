"""Which directions of the wrench count as producible: none that is as good as lost, none that costs too much."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ActuationError
from cube_sim.wrench.axes import Matrix, Vector
from cube_sim.wrench.tolerances import RANK_ROUNDING, RANK_TOLERANCE


@dataclass(frozen=True)
class Threshold:
    """What counts among the singular values sigma of W A: the gains of its directions, whose costs are 1 / sigma.

    Attributes:
        rank_tolerance: a gain at or below this share of the largest is lost.
        cost_limit: a direction that costs more than this is dropped [N/N].
    """

    rank_tolerance: float = RANK_TOLERANCE
    cost_limit: float = inf

    @staticmethod
    def of(rank_tolerance: float | None = None, cost_limit: float | None = None) -> Threshold:
        """What a caller asks for: rank decides by default, a cost limit in its place where one is given.

        Raises:
            ActuationError: the tolerance is not in [0, 1), or the limit is not positive.
        """
        if cost_limit is not None and not cost_limit > 0.0:
            raise ActuationError(f"the cost limit is {cost_limit}; it must be positive")
        if rank_tolerance is not None and not 0.0 <= rank_tolerance < 1.0:
            raise ActuationError(f"the rank tolerance is {rank_tolerance}; it must be in [0, 1)")
        if rank_tolerance is None:
            rank_tolerance = RANK_TOLERANCE if cost_limit is None else 0.0
        return Threshold(rank_tolerance, inf if cost_limit is None else cost_limit)

    def dropped(self, gains: Vector) -> tuple[str, ...]:
        """Why each direction does not count: "rank", "cost", or "" for one that does; gains (d,) [N/N] descending."""
        return tuple(self._reason(gain, float(gains[0])) for gain in gains.tolist())

    def rank(self, gains: Vector) -> int:
        """How many of the directions count; gains (d,) [N/N] descending."""
        return self.dropped(gains).count("")

    def all_count(self, gains: Matrix) -> NDArray[np.bool_]:
        """(k,) whether every direction counts, for each row of gains (k,d) [N/N], each descending."""
        least, largest = gains[:, -1], gains[:, 0]
        reached = least > max(self.rank_tolerance, RANK_ROUNDING) * largest
        return reached & (1.0 / np.where(reached, least, 1.0) <= self.cost_limit)

    def _reason(self, gain: float, largest: float) -> str:
        if gain <= max(self.rank_tolerance, RANK_ROUNDING) * largest:
            return "rank"
        return "cost" if 1.0 / gain > self.cost_limit else ""
