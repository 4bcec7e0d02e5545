"""What ends a process from outside: pieces of work that it may come before or after, not amid."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

TERMINATIONS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
_SIGNALS = (signal.SIGINT, *TERMINATIONS)
GIVES_WAY = "gives_way"
"""The attribute of a handler of these that `stoppable` may take the place of."""


class _Piece:
    """A piece of work that is not interrupted, and what is held back meanwhile.

    Args:
        twice: whether a second signal interrupts it after all.
    """

    def __init__(self, twice: bool) -> None:
        self.caught: list[Any] = []
        self.handlers: dict[int, Callable[..., Any]] = {}
        self._twice = twice

    def hold(self, number: int, handler: Callable[..., Any]) -> None:
        """From now on hold a signal back, for this handler."""
        self.handlers[number] = handler
        signal.signal(number, self._hear)

    def _hear(self, *told: Any) -> None:
        if self._twice and self.caught:
            self.caught.clear()
            self.handlers[told[0]](*told)
        else:
            self.caught.append(told)

    def let_go(self) -> None:
        for number, handler in self.handlers.items():
            signal.signal(number, handler)
        for told in [told for told in self.caught if told[0] in self.handlers][:1]:
            self.handlers[told[0]](*told)


_pieces: list[_Piece] = []
"""Those that last, of the main thread: the outermost first."""


def is_asked_to_end() -> bool:
    """Whether a signal is held back at this moment."""
    return any(piece.caught for piece in _pieces)


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

    So is Ctrl-C a KeyboardInterrupt where it would end the process at once. Within `uninterrupted`, however deep, all
    of them wait for the end of its outermost piece from now on, those too that are held back already.

    Where somebody else has said what becomes of them, as nohup does, it stays. Afterwards SIGTERM and SIGHUP end the
    process again as they always do.
    """
    taken: list[int] = []
    if threading.current_thread() is threading.main_thread():
        taken = [number for number in (signal.SIGINT, *TERMINATIONS) if _is_free(number)]
    for number in taken:
        _raise_from_now_on(number)
    try:
        yield
    finally:
        for number in taken:
            if number in TERMINATIONS:
                signal.signal(number, signal.SIG_DFL)


def _is_free(number: int) -> bool:
    held = [piece.handlers[number] for piece in _pieces if number in piece.handlers]
    handler = held[0] if held else signal.getsignal(number)
    return (handler is signal.SIG_DFL and number in TERMINATIONS) or getattr(handler, GIVES_WAY, False)


def _raise_from_now_on(number: int) -> None:
    handler = signal.default_int_handler if number == signal.SIGINT else raise_stopped
    if not _pieces:
        signal.signal(number, handler)
        return
    outermost, *inner = _pieces
    outermost.hold(number, handler)
    for piece in inner:
        piece.handlers.pop(number, None)
        outermost.caught += [told for told in piece.caught if told[0] == number]


@contextmanager
def uninterrupted(start_up: bool = False, twice: bool = False) -> Iterator[None]:
    """Hold back Ctrl-C while this lasts, then raise it: for short pieces that must not be left half done.

    So are SIGTERM and SIGHUP within `stoppable`. Where somebody else handles one of them, it is left to them.

    Args:
        start_up: whether what ends the process at once while it starts up is held back as well.
        twice: whether a second signal does not wait: for pieces that may take long.
    """
    piece = _Piece(twice)
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    held = {number for outer in _pieces for number in outer.handlers}  # asking the system takes longer
    try:
        _pieces.append(piece)
        for number in _SIGNALS:
            if number not in held and callable(handler := signal.getsignal(number)) and _is_held(handler, start_up):
                piece.hold(number, handler)
        yield
    finally:
        if piece in _pieces:
            _pieces.remove(piece)
        piece.let_go()


def _is_held(handler: Callable[..., Any], start_up: bool) -> bool:
    return handler in (signal.default_int_handler, raise_stopped) or (start_up and getattr(handler, GIVES_WAY, False))
