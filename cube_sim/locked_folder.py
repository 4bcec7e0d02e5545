"""A folder that one process holds at a time, by a lock that the system lets go when the process ends."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

try:
    import fcntl
except ImportError:  # no such locks on Windows
    fcntl = None


class FolderHeldError(Exception):
    """Another process holds it."""


@contextlib.contextmanager
def held(place: Path, *, with_others: bool = False) -> Iterator[None]:
    """Hold a folder, or a file, as long as the context lasts; where the file system knows no locks, it is not closed.

    The lock is on the thing itself: nothing is left of it, however the process ends.

    Args:
        place: what is there already.
        with_others: whether others may hold it too who say the same.

    Raises:
        FolderHeldError: somebody else does.
        OSError: it cannot be opened.
    """
    if fcntl is None:
        yield
        return
    opened = os.open(place, os.O_RDONLY)
    try:
        try:
            fcntl.flock(opened, (fcntl.LOCK_SH if with_others else fcntl.LOCK_EX) | fcntl.LOCK_NB)
        except BlockingIOError:
            raise FolderHeldError(str(place)) from None
        except OSError:
            pass  # a file system without locks
        yield
    finally:
        os.close(opened)
