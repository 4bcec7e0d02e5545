"""Pieces of work that an interrupt may come before or after, not amid."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def uninterrupted() -> Iterator[list[Any]]:
    """Hold back Ctrl-C while this lasts, then raise it: for short pieces that must not be left half done.

    Where somebody else handles SIGINT, as the command line does, it is left to them.

    Yields:
        What is held back by now, for pieces that can be made shorter still.
    """
    ours = threading.current_thread() is threading.main_thread()
    if not ours or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield []
        return
    caught: list[Any] = []
    signal.signal(signal.SIGINT, lambda *told: caught.append(told))
    try:
        yield caught
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if caught:
            raise KeyboardInterrupt
