"""What is known of the thrusters: whole, weak, dead or stuck."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.spatial import Vector


class Health(NamedTuple):
    """The state of m thrusters.

    Attributes:
        efficiency: (m,) share of its force a thruster gives: 1 whole, 0 dead.
        stuck: (m,) force [N] a thruster holds whatever it is told; NaN where it responds.
    """

    efficiency: Vector
    stuck: Vector

    @staticmethod
    def whole(m: int) -> Health:
        """Nothing is wrong."""
        return Health(np.ones(m), np.full(m, np.nan))

    @property
    def responsive(self) -> np.ndarray:
        """(m,) bool: which thrusters still do what they are told, weakly perhaps."""
        return (self.efficiency > 0.0) & np.isnan(self.stuck)

    def with_thruster(self, index: int, efficiency: float = 1.0, stuck: float = np.nan) -> Health:
        """The same but for one thruster."""
        changed = Health(self.efficiency.copy(), self.stuck.copy())
        changed.efficiency[index], changed.stuck[index] = efficiency, stuck
        return changed

    def equals(self, other: Health) -> bool:
        """Whether both say the same of every thruster."""
        return np.array_equal(self.efficiency, other.efficiency) and np.array_equal(self.stuck, other.stuck, True)

    def describe(self, names: tuple[str, ...]) -> str:
        """What is wrong, thruster by thruster, in words."""
        said = []
        for name, efficiency, stuck in zip(names, self.efficiency, self.stuck, strict=True):
            if not np.isnan(stuck):
                said.append(f"{name} stuck at {stuck:.1f} N")
            elif efficiency == 0.0:
                said.append(f"{name} dead")
            elif efficiency < 1.0:
                said.append(f"{name} at {100.0 * efficiency:.0f} %")
        return ", ".join(said) or "all thrusters whole"
