"""Digests of what a record holds, by which a reader knows that it reads what was written, whoever copied the file.

The checksums of an MCAP file say whether its bytes were damaged since somebody wrote them. Programs that write it anew
give damaged rows a fresh checksum. These digests are of the numbers, and no other program makes them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from hashlib import sha256
from json import dumps
from typing import Any, NamedTuple

import numpy as np

from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import Channel
from cube_sim.recording.mcap.names import declaration, stamp_ns
from cube_sim.run_log import LogLine


class ChannelDigest:
    """SHA-256 of a channel's declaration, and then of its rows.

    Each number is taken as the eight bytes of a double, least significant first; row after row, the time first.

    Attributes:
        rows: how many have been taken in.
    """

    def __init__(self, channel: Channel) -> None:
        self._hash = sha256(declaration(channel).encode())
        self.rows = 0

    def take(self, rows: Rows) -> None:
        """Take in the rows that come next, (n, 1+width)."""
        self._hash.update(np.ascontiguousarray(rows, "<f8").reshape(-1).data)
        self.rows += len(rows)

    def told(self) -> dict[str, Any]:
        """Number of rows and digest, plain data."""
        return {"rows": self.rows, "sha256": self._hash.hexdigest()}


def channel_digests(channels: Sequence[Channel], rows: Mapping[str, Rows]) -> dict[str, ChannelDigest]:
    """Of each channel by name, with all its rows, if it has any."""
    found = {channel.name: ChannelDigest(channel) for channel in channels}
    for name, digest in found.items():
        if name in rows:
            digest.take(rows[name])
    return found


def log_digest(lines: Iterable[LogLine]) -> str:
    """SHA-256 of what was said: of each line its nanoseconds, level and text, as JSON."""
    said = [[stamp_ns(line.t), line.level, line.text] for line in lines]
    return sha256(dumps(said, ensure_ascii=False).encode()).hexdigest()


def head_digests(tables: Mapping[str, Mapping[str, str]], files: Mapping[str, bytes]) -> dict[str, dict[str, str]]:
    """SHA-256 of each table of texts and of each file that come before the rows, by name."""
    return {
        "tables": {name: _of_table(table) for name, table in tables.items()},
        "files": {name: sha256(data).hexdigest() for name, data in files.items()},
    }


class Other(NamedTuple):
    """Something in a record that is not as its digests have it.

    Attributes:
        text: what, in words.
        lost: whether it is merely missing: of what is there nothing is known to be changed.
    """

    text: str
    lost: bool


def others(
    digests: Mapping[str, Any],
    found: Mapping[str, ChannelDigest],
    log: Iterable[LogLine],
    head: Mapping[str, Mapping[str, str]],
) -> Iterator[Other]:
    """What is not as the digests of a record have it.

    Args:
        digests: as the record has them.
        found: of each channel as read.
        log: as read.
        head: `head_digests` of what was read.
    """
    for kind, one in (("files", "the file"), ("tables", "the table")):
        for name, digest in digests[kind].items():
            if head[kind].get(name) != digest:
                yield Other(
                    f"{one} {name!r} in it is {'not the one recorded' if name in head[kind] else 'missing'}", False
                )
    for name, told in digests["channels"].items():
        if name not in found:
            yield Other(f"the channel {name!r} is missing", True)
            continue
        if found[name].told() != told:
            count = found[name].rows
            if count == told["rows"]:
                yield Other(f"the channel {name!r} is not the one recorded", False)
            else:
                yield Other(f"it holds {count} of {told['rows']} rows of the channel {name!r}", count < told["rows"])
    for name in found:
        if name not in digests["channels"]:
            yield Other(f"the channel {name!r} is none of those recorded", False)
    if log_digest(log) != digests["log"]:
        yield Other("the log is not the one recorded", True)


def _of_table(table: Mapping[str, str]) -> str:
    return sha256(dumps(dict(table), sort_keys=True, ensure_ascii=False).encode()).hexdigest()
