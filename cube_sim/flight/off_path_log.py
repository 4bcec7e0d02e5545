"""Messages about a vehicle that stays off its path, whatever the cause: one for each spell."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cube_sim.control.authority import Authority
from cube_sim.flight.rows import TickRows
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_conditions import OFF_PATH

OFF_M = 0.5
"""Within this a vehicle is on its path (a choice)."""
PATIENCE_S = 20.0
"""It stays off once it has come no nearer for this long (a choice)."""
NEARER = 0.05
"""Share of its distance by which it has to come nearer within that time (a choice)."""
OF_LATE_S, EVERY_S = 10.0, 1.0
"""One that has been carried off and comes nearer by as much within the last 10 s is no news either; a distance is kept
every second for it (choices)."""
BACK_S = 5.0
"""It is on its path again once it has been for this long: one that swings about it is not (a choice)."""


class OffPathLog:
    """Logs that a vehicle has been off its path, or its place, for a while without coming nearer, and when it is back.

    A path that is given up is another message's.

    Args:
        recorder: gets the messages.
    """

    def __init__(self, recorder: SignalStore) -> None:
        self._recorder = recorder
        self._since_s: float | None = None
        self._nearest_m, self._nearest_s, self._off_s = np.inf, 0.0, 0.0
        self._told = False
        self._past: deque[tuple[float, float]] = deque()

    def quiet(self, rows: TickRows) -> bool:
        """Whether the ticks of these rows are no news."""
        return self._since_s is None and not (off_path_m(rows) >= OFF_M).any()

    def note(self, t: float, rows: TickRows, k: int) -> None:
        """Take in one tick, at t [s], of which rows there is row k."""
        self.note_all([t], rows.part(k, k + 1), 0, 1)

    def note_all(self, times: Sequence[float], rows: TickRows, start: int, end: int) -> None:
        """Take in ticks one after the other.

        Args:
            times: of all rows [s].
            rows: of the flight.
            start: the first of them.
            end: behind the last.
        """
        part = rows.part(start, end)
        if self.quiet(part):
            return
        given_up = part.health[:, -1] == Authority.SAFE
        for t, off, lost in zip(times[start:end], off_path_m(part).tolist(), given_up.tolist(), strict=True):
            self._note(t, off, lost)

    def _note(self, t: float, off_m: float, given_up: bool) -> None:
        if off_m < OFF_M:
            if self._since_s is not None and t - self._off_s >= BACK_S:
                self._since_s = None
                if self._told:
                    self._told = False
                    self._recorder.log(t, "INFO", OFF_PATH.ends)
            return
        if self._since_s is None:
            self._since_s, self._nearest_m = t, np.inf
            self._past.clear()
        self._off_s = t
        if not self._past or t - self._past[-1][0] >= EVERY_S:
            self._past.append((t, off_m))
        while len(self._past) > 1 and t - self._past[1][0] >= OF_LATE_S:
            self._past.popleft()
        if given_up or off_m <= (1.0 - NEARER) * self._nearest_m:
            self._nearest_m, self._nearest_s = off_m, t
        elif not self._told and t - self._nearest_s >= PATIENCE_S and not self._comes_nearer(t, off_m):
            self._told = True
            text = f"{off_m:.2g} m from it, farther than {OFF_M:g} m since {self._since_s:.2f} s, and comes no nearer"
            self._recorder.log(t, "WARNING", f"{OFF_PATH.begins}{text}")

    def _comes_nearer(self, t: float, off_m: float) -> bool:
        """Whether it does of late, from wherever it has been carried meanwhile."""
        before, was_m = self._past[0]
        return t - before >= OF_LATE_S and off_m <= (1.0 - NEARER) * was_m


def off_path_m(rows: TickRows) -> NDArray[np.float64]:
    """(n,) how far a vehicle is from its path [m]; from its end, or its place, where nothing of it remains."""
    along, cross = rows.path_error[:, 1], rows.path_error[:, 4]
    return np.where(rows.target[:, 2] > 0.0, cross, np.hypot(along, cross))
