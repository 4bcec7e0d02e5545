"""A recording read once, some seconds of it in memory at a time."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np

from cube_sim.recording.batch import Rows
from cube_sim.recording.digests import ChannelDigest
from cube_sim.recording.long_run import RecordedRows
from cube_sim.recording.mcap.names import RUN_METADATA
from cube_sim.recording.mcap.passing import NotInOrderError, chunks_in_passing
from cube_sim.recording.mcap.reader import McapContents
from cube_sim.recording.messages import RecordedMessages
from cube_sim.recording.reading import Recording, read_end, read_header

BLOCK_BYTES = 4_000_000
"""So much of the file, uncompressed, is handed on together: about a minute."""


class OnePass:
    """Reads what `read_recording` reads, if the rows stand in the order of time; any other file it refuses.

    Args:
        path: the MCAP file.

    Raises:
        RecordingError: as `read_recording`; a `NotInOrderError` where the file has to be read as a whole.
    """

    def __init__(self, path: Path) -> None:
        self._contents = McapContents(path)
        chunks = chunks_in_passing(self._contents)
        first = next(chunks, b"")
        self._chunks = chain((first,), chunks)
        self._header, self._vehicle = read_header(self._contents)
        self._format = self._contents.metadata[RUN_METADATA]["format"]
        declared = RecordedMessages(path, self._format)
        declared.take(first)
        self._channels = tuple(declared.channels.values())
        self._messages = RecordedMessages(path, self._format)
        self._digests = {channel.name: ChannelDigest(channel) for channel in self._channels}
        self._last_s = {channel.name: -np.inf for channel in self._channels}
        self._past_s = -np.inf

    @property
    def beginning(self) -> Recording:
        """The recording without rows and end, as far as is known from its beginning."""
        return Recording(self._header, self._vehicle, self._channels, rows={}, log=())

    def blocks(self) -> Iterator[dict[str, Rows]]:
        """Go through the file.

        Yields:
            Rows of each channel that has any, (n, 1+width), column 0 the time [s], in the order of their writing and
            of time. Whoever has the rows before a whole second, up to the last row of all, has them all.

        Raises:
            RecordingError: as at the beginning.
        """
        size = 0
        for chunk in self._chunks:
            self._messages.take(chunk)
            size += len(chunk)
            if size >= BLOCK_BYTES:
                yield self._following()
                size = 0
        yield self._following()

    def finish(self) -> Recording:
        """The whole recording, once the blocks are through; its rows are read from the file when they are asked for.

        Raises:
            RecordingError: as at the beginning.
        """
        header, vehicle = read_header(self._contents)  # a second run may have come behind the first
        recorded = [channel for channel in self._channels if self._digests[channel.name].rows]
        rows = RecordedRows(self._contents.path, recorded, self._format)
        read = Recording(header, vehicle, self._channels, rows, self._messages.lines())
        return read_end(self._contents, read, self._digests)

    def _following(self) -> dict[str, Rows]:
        found = {name: rows for name, rows in self._messages.following_rows().items() if len(rows)}
        if tuple(self._messages.channels.values()) != self._channels:
            raise NotInOrderError(f"{self._contents.path} declares channels after its beginning")
        for name, rows in found.items():
            times = rows[:, 0]
            earliest = max(self._past_s, self._last_s[name])
            if not (np.isfinite(times).all() and times[0] >= earliest and np.all(times[1:] >= times[:-1])):
                raise NotInOrderError(f"{self._contents.path} has rows of {name!r} out of the order of time")
            self._digests[name].take(rows)
            self._last_s[name] = float(times[-1])
        self._past_s = np.floor(max(self._last_s.values(), default=-np.inf))
        return found
