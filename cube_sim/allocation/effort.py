"""What allocating has cost."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Effort:
    """What allocating has cost so far, for benchmarks and for doubt.

    Attributes:
        nodes: points or projections looked at by the searches.
        qps: problems given to ProxQP.
        disagreements: times ProxQP did not confirm the search, whose answer was used all the same.
        unproven: times a search could not prove its answer to be the best.
    """

    nodes: int = 0
    qps: int = 0
    disagreements: int = 0
    unproven: int = 0

    def add(self, nodes: int, unproven: int) -> None:
        """Count what searches have cost."""
        self.nodes += nodes
        self.unproven += unproven
