"""What is known of the fins that servos turn: whole, slow, short of travel, jammed or loose."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.spatial import Vector

STATES = ("whole", "slow", "short", "jammed", "loose")
"""What the numbers 0, 1, ... of `FinHealth.codes` mean."""


class FinHealth(NamedTuple):
    """The state of k fins.

    Attributes:
        jammed: (k,) bool, that stand still whatever they are told.
        angle: (k,) angle a jammed one goes to and stays at [rad]; NaN for where it was, and for all others.
        rate: (k,) fastest rate that is left [rad/s]; infinite where it is whole.
        travel: (k,2) least and largest deflection that are left [rad]; infinite where all are.
        loose: (k,) bool, that follow the flow.
    """

    jammed: NDArray[np.bool_]
    angle: Vector
    rate: Vector
    travel: NDArray[np.float64]
    loose: NDArray[np.bool_]

    @staticmethod
    def whole(k: int) -> FinHealth:
        """Nothing is wrong."""
        no = np.zeros(k, np.bool_)
        travel = np.tile([-np.inf, np.inf], (k, 1))
        return FinHealth(no, np.full(k, np.nan), np.full(k, np.inf), travel, no.copy())

    def with_fin(
        self,
        index: int,
        *,
        jammed: bool = False,
        angle: float = np.nan,
        rate: float = np.inf,
        travel: tuple[float, float] = (-np.inf, np.inf),
        loose: bool = False,
    ) -> FinHealth:
        """The same but for one fin, of which nothing else is wrong than what is said."""
        changed = FinHealth(
            self.jammed.copy(), self.angle.copy(), self.rate.copy(), self.travel.copy(), self.loose.copy()
        )
        changed.jammed[index], changed.angle[index], changed.rate[index] = jammed, angle, rate
        changed.travel[index], changed.loose[index] = travel, loose
        return changed

    @property
    def steers(self) -> NDArray[np.bool_]:
        """(k,) which fins still turn when they are told to."""
        return ~(self.jammed | self.loose)

    @property
    def codes(self) -> Vector:
        """(k,) what is wrong with each, its place in `STATES`."""
        slow, short = np.isfinite(self.rate), np.isfinite(self.travel).any(axis=1)
        return np.select([self.loose, self.jammed, short, slow], [4.0, 3.0, 2.0, 1.0], 0.0)

    def describe(self, names: tuple[str, ...]) -> str:
        """What is wrong, fin by fin, in words; "" for nothing."""
        said = []
        for i, name in enumerate(names):
            if self.loose[i]:
                said.append(f"{name} loose")
            elif self.jammed[i]:
                where = "where it was" if np.isnan(self.angle[i]) else f"at {np.degrees(self.angle[i]):.1f} deg"
                said.append(f"{name} jammed {where}")
            elif np.isfinite(self.travel[i]).any():
                low, high = np.degrees(self.travel[i])
                less, more = f"to no less than {low:.1f} deg", f"to no more than {high:.1f} deg"
                both = f"from {low:.1f} to {high:.1f} deg only"
                told = both if np.isfinite(low + high) else less if np.isfinite(low) else more
                said.append(f"{name} turns {told}")
            elif np.isfinite(self.rate[i]):
                said.append(f"{name} turns by {np.degrees(self.rate[i]):.1f} deg/s at most")
        return ", ".join(said)
