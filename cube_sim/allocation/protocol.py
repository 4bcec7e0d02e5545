"""What every way of allocating can do, a user's own included."""

from __future__ import annotations

from typing import Protocol

from numpy.typing import ArrayLike

from cube_sim.allocation.allocation import Allocation
from cube_sim.allocation.previous import PreviousForces


class WrenchAllocator(Protocol):
    """From a demanded wrench to the forces of m thrusters.

    `FaultTolerant` builds one for the thrusters that respond, whenever it learns that these are others, and asks it
    once in every control period. Any object with these four methods will do.
    """

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """Find the forces for one demanded wrench.

        Args:
            wrench: (n,) demand [N, N m] in the rows of A.
        """
        ...

    def allocate_by_priority(self, primary: ArrayLike, secondary: ArrayLike) -> Allocation:
        """Find the forces for a demand ``primary + secondary`` whose secondary part gives way where both are too much.

        An allocator that does not tell parts of a demand apart answers their sum as it answers any demand.

        Args:
            primary: (n,) [N, N m].
            secondary: (n,) [N, N m].

        Returns:
            An answer whose ``wrench_error`` is counted from the sum.
        """
        ...

    def reset(self) -> None:
        """Forget what came before, as at the start of a run."""
        ...

    def resume(self, previous: PreviousForces) -> None:
        """Go on from the forces of another allocator as if they were this one's previous answer.

        Args:
            previous: of the m thrusters.
        """
        ...
