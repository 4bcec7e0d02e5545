"""The signals of a run that is too long to be kept in memory."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import Channel
from cube_sim.recording.reading import read_channels

CHUNKS_AT_ONCE = 60
"""Seconds of a run."""

CHANNELS_KEPT = 3
"""So many channels stay in memory of those that were asked for last."""


class RecordedSignals(Mapping[str, Rows]):
    """Everything recorded, read from the record when it is asked for: "channel.field" -> (n, 1+width).

    Args:
        path: the MCAP file, with all its rows.
        channels: the channel table.
    """

    def __init__(self, path: Path, channels: Sequence[Channel]) -> None:
        self._path, self._written = path, _identity(path)
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
            RecordingError: the record is gone, replaced by another, or damaged.
        """
        channel, columns = self._places[name]
        rows = self._rows(channel)
        return np.hstack([rows[:, :1], rows[:, columns]])

    def __contains__(self, name: object) -> bool:
        """Whether there is such a signal, without reading it."""
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        """The names, in the order of the table."""
        return iter(self._places)

    def __len__(self) -> int:
        """How many signals there are."""
        return len(self._places)

    def blocks(self, names: Collection[str]) -> Iterator[dict[str, Rows]]:
        """Rows of some signals, a minute of them at a time.

        Raises:
            RecordingError: the record is gone, replaced by another, or damaged.
        """
        self._require_the_same()
        places = {name: self._places[name] for name in names}
        channels = {channel.name for channel, _ in places.values()}
        for rows in read_channels(self._path, channels, CHUNKS_AT_ONCE) if channels else ():
            yield {
                name: np.hstack([rows[channel.name][:, :1], rows[channel.name][:, columns]])
                for name, (channel, columns) in places.items()
                if channel.name in rows
            }

    def finished(self) -> None:
        """The file has been closed by who wrote it: it is the same, though no longer what it was."""
        self._written = _identity(self._path)

    def _rows(self, channel: Channel) -> Rows:
        if channel.name not in self._kept:
            self._require_the_same()
            while len(self._kept) >= CHANNELS_KEPT:
                self._kept.popitem(last=False)
            (rows,) = read_channels(self._path, {channel.name})
            self._kept[channel.name] = rows.get(channel.name, np.empty((0, 1 + channel.width)))
        self._kept.move_to_end(channel.name)
        return self._kept[channel.name]

    def _require_the_same(self) -> None:
        """Read nothing of another run that has been recorded in the same place since."""
        now = _identity(self._path)
        if now is not None and now != self._written:
            raise RecordingError(f"{self._path}: another recording stands there now; these signals are gone")


def _identity(path: Path) -> tuple[int, int, int] | None:
    """What a file that replaces another does not share with it; None without a file."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns, found.st_size
