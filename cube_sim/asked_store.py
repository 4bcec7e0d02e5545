"""Rows that are judged and put into numbers as they come; of the signals, those asked for alone are kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from cube_sim.flight_statistics import CHANNELS, FlightStatistics
from cube_sim.judged_store import JudgedStore
from cube_sim.recording.batch import Batch, BySignal, Rows, Sink, signals
from cube_sim.recording.channels import Channel


class AskedStore(JudgedStore):
    """What the loop calls where a verdict, statistics and some signals are wanted.

    Args:
        channels: the channel table.
        judge: of the rows.
        names: of the signals to keep, "channel.field".

    Attributes:
        statistics: of the rows that have been handed on.
    """

    def __init__(self, channels: Sequence[Channel], judge: Sink, names: Sequence[str]) -> None:
        super().__init__(channels, judge)
        self.statistics = FlightStatistics()
        self._kept: dict[str, list[Rows]] = {name: [] for name in names}
        asked = {*CHANNELS, *(name.rpartition(".")[0] for name in names)}
        self._channels = tuple(channel for channel in channels if channel.name in asked)

    @property
    def signals(self) -> Mapping[str, Rows]:
        """Those asked for, "channel.field" -> (n, 1+width), column 0 the time [s]."""
        empty = {channel.name: np.empty((0, 1 + channel.width)) for channel in self._channels}
        nothing = signals(self._channels, empty)
        return BySignal[Rows]({name: np.concatenate([nothing[name], *rows]) for name, rows in self._kept.items()})

    def _keep(self, batch: Batch) -> None:
        super()._keep(batch)
        came = tuple(channel for channel in self._channels if channel.name in batch.rows)
        named = signals(came, batch.rows)
        if "pose.position" in named:
            self.statistics.take(named)
        for name, rows in self._kept.items():
            if name in named:
                rows.append(named[name].copy())
