"""The window of a check, which the run itself may open and close."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.reasons import NotJudgedError
from cube_sim.checks.samples import Array, Samples, Signals
from cube_sim.scenario.windows import TimeWindow, phase_index

PHASE = "phase.index"
"""The signal that says which phase is flown: a row at the tick at which one begins."""


class JudgedWindow:
    """From when to when a check looks at a run, as far as its rows have shown that.

    The tick at which a phase is over is its last: the window of the next one begins after it.

    Args:
        window: that the check asks for.
        beforehand: what is known of the run.

    Attributes:
        start_s: its start [s]; -inf for that of the run, inf as long as its phase has not begun.
        end_s: its end [s]; inf for that of the run, or as long as its phase goes on.
        after: whether the start itself does not belong to it.
        needs: names of the signals that open and close it.
    """

    def __init__(self, window: TimeWindow, beforehand: Beforehand) -> None:
        self._asked = window
        self._phase = None if window.phase is None else phase_index(window.phase, beforehand.phases)
        self._begun, self._over = Samples(PHASE), False
        self.after = False
        self.needs: tuple[str, ...] = () if window.phase is None else (PHASE,)
        if window.phase is None:
            self.start_s = -np.inf if window.start_s is None else window.start_s
            self.end_s = np.inf if window.end_s is None else window.end_s
        else:
            self.start_s = self.end_s = np.inf

    def of_other(self, last_s: float) -> JudgedWindow:
        """The same seconds of another run.

        Args:
            last_s: the last instant at which was looked in this one, where its own window is open [s].
        """
        window = self.shown(last_s)
        other = JudgedWindow(TimeWindow(window.start_s, last_s if window.end_s is None else window.end_s), Beforehand())
        other.after = self.after
        return other

    def take(self, block: Signals) -> None:
        """See `Judge`; to be called before the other rows of the block are looked at."""
        rows = block.get(PHASE)
        if self._phase is None or rows is None or not self._begun.take(rows):
            return
        for t, index in rows[:, :2].tolist():
            if index == self._phase and not np.isfinite(self.start_s):  # a later row of it says how it ended
                from_s, to_s, _ = self._asked
                self.start_s = t + (from_s or 0.0)
                self.after = not from_s and index > 0
                self.end_s = np.inf if to_s is None else t + to_s
            elif index > self._phase and not self._over:
                self.end_s, self._over = min(self.end_s, t), True

    def inside(self, times: Array) -> NDArray[np.bool_]:
        """Which of some instants (n,) [s] belong to it."""
        begun = times > self.start_s if self.after else times >= self.start_s
        return begun & (times <= self.end_s)

    def shown(self, recorded_s: float) -> TimeWindow:
        """It in seconds of the run, once nothing comes any more.

        Args:
            recorded_s: until when there are rows [s].

        Raises:
            NotJudgedError: its phase was not flown, or not for so long.
        """
        if self._asked.phase is None:
            return self._asked
        phase = f"phase '{self._asked.phase}'"
        if self._phase is None:
            raise NotJudgedError(f"the run has no {phase}")
        if not np.isfinite(self.start_s):
            raise NotJudgedError(f"{phase} was never entered")
        end = min(self.end_s, recorded_s)
        if not self.start_s < end:
            raise NotJudgedError(f"{phase} was over at {end:g} s, the window starts at {self.start_s:g} s")
        return TimeWindow(self.start_s, end)
