"""The check that the virtual target moves on along the path."""

from __future__ import annotations

from collections.abc import Collection
from typing import ClassVar

import numpy as np

from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.judged_window import JudgedWindow
from cube_sim.checks.judging import judged
from cube_sim.checks.measured import require_in_run
from cube_sim.checks.reasons import NotJudgedError, Reasons
from cube_sim.checks.samples import Samples, Signals, note_not_finite, note_other_times
from cube_sim.scenario.check_blocks import ProgressCheckBlock
from cube_sim.scenario.windows import window_of
from cube_sim.verdict import CheckResult

LAP_M = 1.0
"""A target that moves farther between two samples has begun another lap."""
AT_THE_END_M = 0.1
"""So little of the path left is its end."""


class Progress:
    """Judges a `ProgressCheckBlock`."""

    _parts: ClassVar[tuple[str, ...]] = "target.arc_length", "target.remaining"

    def __init__(self, check: ProgressCheckBlock, beforehand: Beforehand) -> None:
        self._check, self._reasons = check, Reasons()
        self._window = JudgedWindow(window_of(check, beforehand.events), beforehand)
        self._samples = [Samples(name) for name in self._parts]
        self.needs = (*self._parts, *self._window.needs)
        self._first_s = self._last_s = self._first_m = self._last_m = np.nan
        self._jumps_m, self._arrived = 0.0, False

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        self._window.take(block)
        none = np.empty((0, 2))
        gone, left = parts = [block.get(name, none) for name in self._parts]
        taken = [samples.take(rows) for samples, rows in zip(self._samples, parts, strict=True)]
        if any(taken):
            note_other_times(self._reasons, gone=gone, left=left)
        if not all(taken) or not self._reasons.none("times") or any(samples.width != 1 for samples in self._samples):
            return
        # A closed path without end has infinitely much left.
        known = np.where(np.isposinf(left), 0.0, left)
        sound = zip(self._parts, (gone, known), strict=True)
        finite = [note_not_finite(self._reasons, name, rows) for name, rows in sound]
        if not all(finite) or self._arrived:
            return
        inside = self._window.inside(gone[:, 0])
        there = np.flatnonzero(inside & (left[:, 1] < AT_THE_END_M))
        if len(there):
            self._arrived = True
            inside[there[0] + 1 :] = False
        self._go_on(gone[inside])

    def _go_on(self, rows: np.ndarray) -> None:
        """Take in rows (n, 2) of the arc length, of the window."""
        if not len(rows):
            return
        if np.isnan(self._first_s):
            self._first_s, self._first_m = rows[0].tolist()
            self._last_m = self._first_m
        steps = np.diff(np.concatenate([[self._last_m], rows[:, 1]]))
        for jump in steps[np.abs(steps) >= LAP_M].tolist():  # in one order, however the rows come
            self._jumps_m += jump
        self._last_s, self._last_m = rows[-1].tolist()

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        for samples in self._samples:
            samples.require_every_tick(recorded, duration_s, 1)
        self._reasons.require_none("times")
        for name in self._parts:
            self._reasons.require_none(name)
        gone = self._samples[0]
        require_in_run(self._window.shown(gone.end), gone.start, gone.end, 1.5 * gone.period)
        if not self._last_s > self._first_s:
            if self._arrived:
                raise NotJudgedError(f"the target is at the end of its path by {self._first_s:g} s, before it moves")
            raise NotJudgedError("the window holds too few samples to tell a speed")
        gone_m = self._last_m - self._first_m - self._jumps_m
        detail = f"{gone_m:.4g} m from {self._first_s:g} s to {self._last_s:g} s"
        return judged(self._check, gone_m / (self._last_s - self._first_s), self._last_s, detail)
