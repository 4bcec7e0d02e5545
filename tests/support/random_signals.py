"""Signals at random, sampled and on change, and the same in blocks at random."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

RUN_S = 12.0
PERIOD_S = 0.05
SAMPLED, HELD, CLOCK = "fast.values", "rare.values", "pose.position"


def random_signals(rng: np.random.Generator) -> dict[str, np.ndarray]:
    """One of every tick that settles to near nothing, one on change with a row at 0, and the clock."""
    times = np.arange(round(RUN_S / PERIOD_S) + 1) * PERIOD_S
    width = int(rng.integers(1, 4))
    fast = rng.normal(size=(len(times), width)) * np.exp(-times / rng.uniform(1.0, 20.0))[:, None]
    fast[rng.random(len(times)) < 0.2] = 0.25  # some equal to the next
    changes = np.unique(np.concatenate([[0.0], rng.uniform(0.0, RUN_S, 30), rng.choice(times, 10)]))
    rare = rng.normal(size=(len(changes), int(rng.integers(1, 3)))).round(1)
    return {
        SAMPLED: np.column_stack([times, fast]),
        HELD: np.column_stack([changes, rare]),
        CLOCK: np.column_stack([times, rng.normal(size=(len(times), 3))]),
    }


class in_random_blocks(dict):  # noqa: N801 - reads as what it does
    """The signals cut at random times, those of all at the same ones."""

    def __init__(self, signals: dict[str, np.ndarray], rng: np.random.Generator) -> None:
        super().__init__(signals)
        last = max(rows[-1, 0] for rows in signals.values())
        cuts = np.sort(rng.uniform(0.0, last, int(rng.integers(0, 25))))
        if rng.random() < 0.5:
            cuts = np.unique(np.floor(cuts))
        self._ends = [*cuts, np.inf]

    def blocks(self, names) -> Iterator[dict[str, np.ndarray]]:
        """Block after block."""
        start = -np.inf
        for end in self._ends:
            yield {n: self[n][(self[n][:, 0] > start) & (self[n][:, 0] <= end)] for n in names}
            start = end
