"""The signals of a run that is too long to be kept in memory."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import Channel
from cube_sim.recording.reading import read_channel

CHANNELS_KEPT = 3
"""So many channels stay in memory of those that were asked for last."""


class RecordedSignals(Mapping[str, Rows]):
    """Everything recorded, read from the record when it is asked for: "channel.field" -> (n, 1+width).

    Args:
        path: the MCAP file, finished.
        channels: the channel table.
    """

    def __init__(self, path: Path, channels: Sequence[Channel]) -> None:
        self._path = path
        self._places = {
            f"{channel.name}.{field.name}": (channel, columns)
            for channel in channels
            for field, columns in zip(channel.fields, channel.columns, strict=True)
        }
        self._kept: OrderedDict[str, Rows] = OrderedDict()

    def __getitem__(self, name: str) -> Rows:
        """One signal, column 0 the time [s].

        Raises:
            KeyError: no such signal.
            RecordingError: the record is gone, or damaged.
        """
        channel, columns = self._places[name]
        rows = self._rows(channel)
        return np.hstack([rows[:, :1], rows[:, columns]])

    def __iter__(self) -> Iterator[str]:
        """The names, in the order of the table."""
        return iter(self._places)

    def __len__(self) -> int:
        """How many signals there are."""
        return len(self._places)

    def _rows(self, channel: Channel) -> Rows:
        if channel.name not in self._kept:
            while len(self._kept) >= CHANNELS_KEPT:
                self._kept.popitem(last=False)
            self._kept[channel.name] = read_channel(self._path, channel)
        self._kept.move_to_end(channel.name)
        return self._kept[channel.name]
