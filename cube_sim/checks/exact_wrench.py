"""The check that allocated forces make the demanded wrench wherever it is attainable."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from cube_sim.checks.judging import Largest, judged
from cube_sim.checks.reasons import NotJudgedError, Reasons
from cube_sim.checks.samples import Held, Samples, Signals, note_not_finite, note_other_times
from cube_sim.scenario.check_blocks import ExactWrenchCheckBlock
from cube_sim.verdict import CheckResult

EXACT = 0
"""Value of allocation.status at a tick whose wrench is attainable."""

FORCE, WRENCH, STATUS, MATRIX = "thrusters.force_demanded", "wrench.demanded", "allocation.status", "actuation.matrix"
FINS = "fins.wrench"
"""Recorded of a vehicle with fins only: they make a part of the wrench."""


class ExactWrench:
    """Judges an `ExactWrenchCheckBlock`."""

    needs: tuple[str, ...] = FORCE, WRENCH, STATUS, MATRIX, FINS

    def __init__(self, check: ExactWrenchCheckBlock) -> None:
        self._check, self._reasons = check, Reasons()
        self._force, self._wrench, self._status, self._matrix = (Samples(name) for name in self.needs[:-1])
        self._held = Held(self._matrix, self._reasons)
        self._worst, self._attainable = Largest(), 0

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        none = np.empty((0, 2))
        force, wrench, status, changed, fins = (block.get(name, none) for name in self.needs)
        if len(fins) == len(wrench) and len(fins):
            wrench = np.column_stack([wrench[:, 0], wrench[:, 1:] - fins[:, 1:]])  # what is left to the thrusters
        sampled = zip((self._force, self._wrench, self._status), (force, wrench, status), strict=True)
        self._matrix.take(changed)
        taken = [samples.take(rows) for samples, rows in sampled]
        if any(taken):
            note_other_times(self._reasons, force=force, wrench=wrench, status=status)
        sound = all(taken) and self._wrench.width == 6 and self._status.width == 1
        attainable = np.zeros(0, bool)
        if sound:
            sound = note_not_finite(self._reasons, STATUS, status) and self._reasons.none("times")
            attainable = status[:, 1] == EXACT
        if sound:
            self._attainable += int(attainable.sum())
            force, wrench = force[attainable], wrench[attainable]
            sound = note_not_finite(self._reasons, FORCE, force)
            sound = note_not_finite(self._reasons, WRENCH, wrench) and sound
        times = force[:, 0] if sound else np.zeros(0)
        matrix, m = self._held.take(changed, times), self._force.width
        if matrix is None:
            return
        if matrix.shape[1] != 6 * m:
            text = f"{MATRIX} has {matrix.shape[1]} columns, {m} thrusters need {6 * m}"
            self._reasons.note("columns", text)
            return
        A = matrix.reshape(len(times), 6, m)
        achieved = np.zeros((len(times), 6))
        for j in range(m):  # in one order on every machine: the residual is recorded
            achieved += A[:, :, j] * force[:, 1 + j, None]
        self._worst.take(np.linalg.norm(achieved - wrench[:, 1:], axis=1), times)

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        self._force.require_every_tick(recorded, duration_s)
        self._wrench.require_every_tick(recorded, duration_s, 6)
        self._status.require_every_tick(recorded, duration_s, 1)
        self._reasons.require_none("times")
        self._reasons.require_none(STATUS)
        if not self._attainable:
            raise NotJudgedError(f"no wrench of {len(self._status)} was attainable")
        self._reasons.require_none(FORCE)
        self._reasons.require_none(WRENCH)
        self._held.require(recorded)
        self._reasons.require_none("columns")
        detail = f"attainable at {self._attainable} of {len(self._status)} ticks"
        return judged(self._check, self._worst.value, self._worst.at_s, detail)
