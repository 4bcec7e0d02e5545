"""What ends a process from outside: pieces of work that it may come before or after, not amid."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

TERMINATIONS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
GIVES_WAY = "gives_way"
"""The attribute of a handler of these that `stoppable` may take the place of."""


_held_back: list[list[Any]] = []
"""What each `uninterrupted` that lasts holds back."""


def is_asked_to_end() -> bool:
    """Whether a signal is held back at this moment."""
    return any(_held_back)


def signal_of(interrupt: KeyboardInterrupt) -> int:
    """The number of the signal that stopped something."""
    return getattr(interrupt, "number", signal.SIGINT)


def name_of(number: int) -> str:
    """What people call a signal that stops something."""
    return "Ctrl-C" if number == signal.SIGINT else signal.Signals(number).name


def interrupted_by(number: int) -> str:
    """What is said of something that a signal has stopped."""
    return "interrupted" if number == signal.SIGINT else f"interrupted by {name_of(number)}"


class StoppedError(KeyboardInterrupt):
    """A signal that asks the process to end, raised as Ctrl-C is.

    Attributes:
        number: of the signal.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(signal.Signals(number).name)


def raise_stopped(number: int, _: Any) -> None:
    """Handle a signal by a `StoppedError`."""
    raise StoppedError(number)


@contextmanager
def stoppable() -> Iterator[None]:
    """While this lasts, SIGTERM and SIGHUP are a `StoppedError`: there is something to bring to an end.

    Where somebody else has said what becomes of them, as nohup does, it stays. Afterwards they end the process again
    as they always do.
    """
    taken: list[int] = []
    if threading.current_thread() is threading.main_thread():
        taken = [number for number in TERMINATIONS if _is_free(signal.getsignal(number))]
    for number in taken:
        signal.signal(number, raise_stopped)
    try:
        yield
    finally:
        for number in taken:
            signal.signal(number, signal.SIG_DFL)


def _is_free(handler: Any) -> bool:
    return handler is signal.SIG_DFL or getattr(handler, GIVES_WAY, False)


@contextmanager
def uninterrupted(start_up: bool = False) -> Iterator[list[Any]]:
    """Hold back Ctrl-C while this lasts, then raise it: for short pieces that must not be left half done.

    So are SIGTERM and SIGHUP within `stoppable`. Where somebody else handles one of them, it is left to them.

    Args:
        start_up: whether what ends the process at once while it starts up is held back as well.

    Yields:
        What is held back by now, for pieces that can be made shorter still.
    """
    ours = {}
    if threading.current_thread() is threading.main_thread():
        handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, *TERMINATIONS)}
        ours = {number: how for number, how in handlers.items() if callable(how) and _is_held(how, start_up)}
    caught: list[Any] = []
    for number in ours:
        signal.signal(number, lambda *told: caught.append(told))
    if ours:
        _held_back.append(caught)
    try:
        yield caught
    finally:
        if ours:  # in the main thread, where what is begun last is over first
            _held_back.pop()
        for number, handler in ours.items():
            signal.signal(number, handler)
        if caught:
            ours[caught[0][0]](*caught[0])


def _is_held(handler: Callable[..., Any], start_up: bool) -> bool:
    return handler in (signal.default_int_handler, raise_stopped) or (start_up and getattr(handler, GIVES_WAY, False))
