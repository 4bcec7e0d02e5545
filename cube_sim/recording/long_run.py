"""The signals of a run that is too long to be kept in memory."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import Channel
from cube_sim.recording.mcap.names import FORMAT
from cube_sim.recording.reading import read_channels

CHUNKS_AT_ONCE = 60
"""Seconds of a run."""

CHANNELS_KEPT = 3
"""So many channels stay in memory of those that were asked for last."""


class RecordedRows(Mapping[str, Rows]):
    """All rows of each channel (n, 1+width), read from the record when they are asked for.

    Args:
        path: the MCAP file, with all its rows.
        channels: of which there are rows.
        format_: of the recording.
    """

    def __init__(self, path: Path, channels: Sequence[Channel], format_: str = FORMAT) -> None:
        self._path, self._format = path, format_
        self._channels = {channel.name: channel for channel in channels}
        self._written = _identity(path)
        self._kept: OrderedDict[str, Rows] = OrderedDict()

    def __getitem__(self, name: str) -> Rows:
        """Those of one channel, column 0 the time [s].

        Raises:
            KeyError: no such channel.
            RecordingError: the record is gone, replaced by another, or damaged.
        """
        channel = self._channels[name]
        if name not in self._kept:
            self.require_the_same()
            while len(self._kept) >= CHANNELS_KEPT:
                self._kept.popitem(last=False)
            (rows,) = read_channels(self._path, {name}, format_=self._format)
            self._kept[name] = rows.get(name, np.empty((0, 1 + channel.width)))
        self._kept.move_to_end(name)
        return self._kept[name]

    def __contains__(self, name: object) -> bool:
        """Whether there is such a channel, without reading it."""
        return name in self._channels

    def __iter__(self) -> Iterator[str]:
        """The names."""
        return iter(self._channels)

    def __len__(self) -> int:
        """How many channels there are."""
        return len(self._channels)

    def finished(self) -> None:
        """The file has been closed by who wrote it: it is the same, though no longer what it was."""
        self._written = _identity(self._path)

    def require_the_same(self) -> None:
        """Read nothing of another run that has been recorded in the same place since.

        Raises:
            RecordingError: there is one.
        """
        now = _identity(self._path)
        if now is not None and now != self._written:
            raise RecordingError(f"{self._path}: another recording stands there now; these signals are gone")


class RecordedSignals(Mapping[str, Rows]):
    """Everything recorded, read from the record when it is asked for: "channel.field" -> (n, 1+width).

    Args:
        path: the MCAP file, with all its rows.
        channels: the channel table.
    """

    def __init__(self, path: Path, channels: Sequence[Channel]) -> None:
        self._path, self._recorded = path, RecordedRows(path, channels)
        self._places = {
            f"{channel.name}.{field.name}": (channel, columns)
            for channel in channels
            for field, columns in zip(channel.fields, channel.columns, strict=True)
        }

    def __getitem__(self, name: str) -> Rows:
        """One signal, column 0 the time [s].

        Raises:
            KeyError: no such signal.
            RecordingError: the record is gone, replaced by another, or damaged.
        """
        channel, columns = self._places[name]
        rows = self._recorded[channel.name]
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
        self._recorded.require_the_same()
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
        self._recorded.finished()


def _identity(path: Path) -> tuple[int, int, int] | None:
    """What a file that replaces another does not share with it; None without a file."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns, found.st_size
