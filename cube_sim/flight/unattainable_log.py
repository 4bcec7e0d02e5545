"""Messages about demanded wrenches that stay unattainable: one for each stretch of them, when it is over.

A fault that is found, or a thruster that comes back, ends a stretch: what dead zones swallowed before is no part of
what the fault left out of reach.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation import Status
from cube_sim.flight.rows import TickRows
from cube_sim.flight.shortfall import Shortfall, Thrust, believed_efficiency, distance_from_target
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_conditions import WRENCH_NOT_MADE
from cube_sim.spatial import Vector

PATIENCE_S = 1.0
"""A stretch is told that has lasted this long; it is over when demands have been made for as long: one at the edge of
the attainable set changes it every tick."""
OFF_M = 0.05
"""A stretch in which the vehicle comes this much further off its target is a warning, any other is none (a choice)."""


class UnattainableLog:
    """Logs from when to when demands were unattainable, how much was missing, why, and what it did to the path.

    Args:
        recorder: gets the messages.
        thrust: of the vehicle, as the controller believes.
    """

    def __init__(self, recorder: SignalStore, thrust: Thrust) -> None:
        self._recorder, self._thrust = recorder, thrust
        self._stretch: Shortfall | None = None
        self._invalid_s: float | None = None

    def quiet(self, rows: TickRows) -> bool:
        """Whether the ticks of these rows are no news."""
        return self._stretch is None and self._invalid_s is None and not rows.allocation[:, 3].any()

    def note(self, t: float, rows: TickRows, k: int, force_ratio: float) -> None:
        """Take in one tick.

        Args:
            t: its time [s].
            rows: of the flight.
            k: which of them.
            force_ratio: share of their force that the supply leaves the thrusters.
        """
        status = Status(int(rows.allocation[k, 3]))
        if status is Status.INVALID_WRENCH:
            if self._invalid_s is None:
                self._recorder.log(t, "ERROR", status.message)
            self._invalid_s = t
            return
        if self._invalid_s is not None and t - self._invalid_s >= PATIENCE_S:
            self._recorder.log(t, "INFO", "the demanded wrench is finite again")
            self._invalid_s = None
        if status is Status.EXACT and self._stretch is None:
            return
        distance = float(distance_from_target(rows, k))
        believed = believed_efficiency(rows, k)
        if self._stretch is not None and not np.array_equal(believed, self._stretch.believed):
            # What other thrusters missed, for reasons of their own, is another stretch.
            self._tell(t, self._stretch)
            if status is Status.EXACT:
                return
        stretch = self._stretch = self._stretch or Shortfall(t, distance, believed)
        stretch.watch(distance)
        if status is not Status.EXACT:
            stretch.take(t, rows, k, status, force_ratio)
        elif t - stretch.until_s >= PATIENCE_S:
            self._tell(t, stretch)

    def ends_of_runs(self, rows: TickRows) -> NDArray[np.int_]:
        """Behind which tick the ticks end that only go on with what the one before was, in a stretch, of each (n,)."""
        status = rows.allocation[:, 3]
        missed = (status != Status.EXACT) & (status != Status.INVALID_WRENCH)
        m = (rows.health.shape[1] - 2) // 2
        believed = rows.health[:, 1 + m : 1 + 2 * m]
        goes_on = missed[1:] & missed[:-1] & (believed[1:] == believed[:-1]).all(axis=1)
        breaks = np.append(np.flatnonzero(~goes_on) + 1, len(status))
        return breaks[np.searchsorted(breaks, np.arange(len(status)), side="right")]

    def go_on(self, times: Sequence[float], rows: TickRows, start: int, end: int, force_ratio: Vector) -> bool:
        """Take in many ticks at once, which are of one run with the one before.

        Args:
            times: of all rows [s].
            rows: of the flight.
            start: the first of them.
            end: behind the last.
            force_ratio: of `note`, of all rows.

        Returns:
            Whether they are taken in; else each has to be noted.
        """
        if end <= start or self._stretch is None or self._invalid_s is not None:
            return False
        self._stretch.go_on(times, rows, start, end, force_ratio)
        return True

    def finish(self, t: float) -> None:
        """Tell at the end of the flight, at t [s], of a stretch that is not over."""
        if self._stretch is not None:
            self._tell(t, self._stretch)

    def _tell(self, t: float, stretch: Shortfall) -> None:
        self._stretch = None
        if stretch.until_s - stretch.since_s < PATIENCE_S:
            return
        matters = stretch.off_m >= OFF_M
        what = f"{WRENCH_NOT_MADE[stretch.status.name]} {stretch.when}"
        how = "" if stretch.status is Status.UNPROVEN else f"; {stretch.told(self._thrust)}"
        came = f"{stretch.off_m:.2g} m" if matters else "no"
        level = "WARNING" if matters else "INFO"
        self._recorder.log(t, level, f"{what}{how}; the vehicle came {came} further off its target meanwhile")
