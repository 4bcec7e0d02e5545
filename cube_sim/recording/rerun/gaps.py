"""Where a record lacks ticks, as one that was damaged does: nothing is drawn as flown there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import Channel

_MISSING = 1.5
"""Rows further apart than this many periods have others missing between them."""


class Gaps:
    """Finds gaps in rows that come batch by batch."""

    def __init__(self, channels: Sequence[Channel]) -> None:
        self._sampled = {channel.name for channel in channels if channel.every_tick}
        self._last: dict[str, float] = {}
        self._period_s: float | None = None

    def broken(self, channel: str, rows: Rows) -> Rows:
        """The next rows of a channel, with a row of NaN where others are missing before or between them."""
        if channel not in self._sampled or not len(rows):
            return rows
        before = self._last.get(channel, float(rows[0, 0]))
        self._last[channel] = float(rows[-1, 0])
        steps = np.diff(rows[:, 0], prepend=before)
        if self._period_s is None and len(rows) > 1:
            self._period_s = float(np.median(steps[1:]))
        if self._period_s is None:
            return rows
        after = np.flatnonzero(steps > _MISSING * self._period_s)
        if not after.size:
            return rows
        starts = rows[after, 0] - steps[after] + self._period_s
        whole = np.insert(rows, after, np.nan, axis=0)
        whole[after + np.arange(len(after)), 0] = starts
        return whole
