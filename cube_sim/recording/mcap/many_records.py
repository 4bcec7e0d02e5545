"""Records that are written at the end of a file, kept small until then: a long run has one for each second."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

AT_ONCE = 1000
"""So many records are packed together."""
_FASTEST = 1


class ManyRecords:
    """Bytes of records in their order."""

    def __init__(self) -> None:
        self._packed: list[bytes] = []
        self._last: list[bytes] = []

    def append(self, record: bytes) -> None:
        """Add one."""
        self._last.append(record)
        if len(self._last) == AT_ONCE:
            self._packed.append(zlib.compress(b"".join(self._last), _FASTEST))
            self._last = []

    def __len__(self) -> int:
        """How many there are."""
        return AT_ONCE * len(self._packed) + len(self._last)

    def __iter__(self) -> Iterator[bytes]:
        """All bytes of them, some records at a time."""
        for packed in self._packed:
            yield zlib.decompress(packed)
        yield b"".join(self._last)
