"""The check that the end of the path is reached."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from cube_sim.checks.judging import Largest, judged
from cube_sim.checks.reasons import Reasons
from cube_sim.checks.samples import Samples, Signals, note_not_finite, note_other_times
from cube_sim.scenario.check_blocks import PathEndCheckBlock
from cube_sim.verdict import CheckResult


class PathEnd:
    """Judges a `PathEndCheckBlock`."""

    needs: tuple[str, ...] = "target.remaining", "target.position", "pose.position"
    _widths = 1, 3, 3

    def __init__(self, check: PathEndCheckBlock) -> None:
        self._check, self._reasons = check, Reasons()
        self._samples = [Samples(name) for name in self.needs]
        self._nearest, self._left = Largest(), np.nan

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        none = np.empty((0, 2))
        remaining, target, vehicle = parts = [block.get(name, none) for name in self.needs]
        taken = [samples.take(rows) for samples, rows in zip(self._samples, parts, strict=True)]
        if any(taken):
            note_other_times(self._reasons, remaining=remaining, target=target, vehicle=vehicle)
        if not all(taken) or any(s.width != width for s, width in zip(self._samples, self._widths, strict=True)):
            return
        finite = [note_not_finite(self._reasons, name, rows) for name, rows in zip(self.needs, parts, strict=True)]
        if not (self._reasons.none("times") and all(finite)):
            return
        # An arc is never shorter than its chord, so this bounds the distance to the end from above.
        distance = np.linalg.norm(vehicle[:, 1:] - target[:, 1:], axis=1) + np.abs(remaining[:, 1])
        nearest = self._nearest.take(-distance, remaining[:, 0])
        if nearest is not None:
            self._left = remaining[nearest, 1]

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        for samples, width in zip(self._samples, self._widths, strict=True):
            samples.require_every_tick(recorded, duration_s, width)
        self._reasons.require_none("times")
        for name in self.needs:
            self._reasons.require_none(name)
        detail = f"nearest to the end with {self._left:.3g} m of path left to the target"
        return judged(self._check, -self._nearest.value, self._nearest.at_s, detail)
