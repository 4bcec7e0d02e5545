"""The check that no thruster is doubted that is whole."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.judging import judged
from cube_sim.checks.reasons import NotJudgedError, Reasons
from cube_sim.checks.samples import Samples, Signals, note_not_finite, note_other_times
from cube_sim.scenario.check_blocks import FalseAlarmsCheckBlock
from cube_sim.scenario.event_blocks import ThrusterEventBlock
from cube_sim.verdict import CheckResult


class FalseAlarms:
    """Judges a `FalseAlarmsCheckBlock`."""

    needs: tuple[str, ...] = "health.believed", "health.efficiency"

    def __init__(self, check: FalseAlarmsCheckBlock, beforehand: Beforehand) -> None:
        self._check, self._reasons = check, Reasons()
        self._samples = [Samples(name) for name in self.needs]
        self._recoveries_s = [
            event.at_s
            for event in beforehand.events
            if isinstance(event, ThrusterEventBlock) and event.state == "recovered"
        ]
        self._doubted: np.ndarray | None = None
        self._first_s = np.nan

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        none = np.empty((0, 2))
        believed, true = parts = [block.get(name, none) for name in self.needs]
        taken = [samples.take(rows) for samples, rows in zip(self._samples, parts, strict=True)]
        if any(taken):
            note_other_times(self._reasons, believed=believed, true=true)
        if not all(taken) or not self._reasons.none("times") or believed.shape != true.shape:
            return
        finite = [note_not_finite(self._reasons, name, rows) for name, rows in zip(self.needs, parts, strict=True)]
        if not all(finite):
            return
        times = believed[:, 0]
        alarms = (believed[:, 1:] < 1.0) & (true[:, 1:] >= 1.0)
        for at_s in self._recoveries_s:
            alarms[(times >= at_s) & (times <= at_s + self._check.recovery_s)] = False
        at = np.flatnonzero(alarms.any(axis=1))
        if len(at) and np.isnan(self._first_s):
            self._first_s = float(times[at[0]])
        of_block = np.logical_or.reduce(alarms, axis=0)
        self._doubted = of_block if self._doubted is None else np.logical_or(self._doubted, of_block)

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        for samples in self._samples:
            samples.require_every_tick(recorded, duration_s)
        self._reasons.require_none("times")
        for name in self.needs:
            self._reasons.require_none(name)
        if self._doubted is None:
            widths = " and ".join(str(samples.width) for samples in self._samples)
            raise NotJudgedError(f"{' and '.join(self.needs)} are of {widths} thrusters")
        found = np.flatnonzero(self._doubted).tolist()
        which = "" if not found else f"; columns {', '.join(map(str, found))} of {self.needs[0]}"
        at_s = self._samples[0].end if np.isnan(self._first_s) else self._first_s
        return judged(self._check, float(len(found)), at_s, f"{len(self._doubted)} thrusters{which}")
