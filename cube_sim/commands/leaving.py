"""Ctrl-C, SIGTERM and SIGHUP at any moment of a command.

Nothing is imported here that takes time: what loads the rest of a command line can be interrupted already.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from cube_sim.uninterrupted import GIVES_WAY, TERMINATIONS, interrupted_by, raise_stopped

SIGNALLED = 128
"""And the number of the signal, where one ends the process."""
_USUAL: dict[int, Any] = {signal.SIGINT: signal.default_int_handler, **dict.fromkeys(TERMINATIONS, signal.SIG_DFL)}
"""What becomes of a signal unless somebody says otherwise."""
_RAISES: dict[int, Any] = {signal.SIGINT: signal.default_int_handler, **dict.fromkeys(TERMINATIONS, raise_stopped)}


def leave_on_interrupt() -> None:
    """From now on Ctrl-C, SIGTERM and SIGHUP end the process at once: there is nothing to save.

    One of them is left alone where somebody else decides about it, as a shell does about Ctrl-C for what runs in the
    background, and nohup about SIGHUP.
    """
    _handle(dict.fromkeys(_USUAL, _leave))


def raise_on_interrupt() -> None:
    """From now on they are exceptions, KeyboardInterrupt and `StoppedError`: there is something to bring to an end."""
    _handle(_RAISES)


def leave_to_others() -> None:
    """From now on they are what they usually are."""
    _handle(_USUAL)


def _handle(handlers: Mapping[int, Any]) -> None:
    """Let these handle signals that nobody else handles."""
    if threading.current_thread() is threading.main_thread():
        for number, handler in handlers.items():
            if signal.getsignal(number) in (_leave, _USUAL[number], _RAISES[number]):
                signal.signal(number, handler)


def _leave(number: int, _: object) -> None:
    """End the process; an exception would be lost or renamed inside the import of a compiled library."""
    # Nothing is imported here: who has not loaded these, or not yet all of them, writes nothing.
    undo, nothing = (
        _loaded(*each) for each in (("whole_file", "undo_unfinished"), ("run_directory", "nothing_recorded"))
    )
    lost = " while starting up; nothing is recorded" if nothing is not None and nothing() else ""
    if undo is not None:
        undo()
    with suppress(OSError):  # a terminal that was closed
        erase = "\r\x1b[K\x1b[?25h" if sys.stderr.isatty() else ""  # the progress bar hides the cursor
        os.write(2, f"{erase}{interrupted_by(number)}{lost}\n".encode())
    os._exit(SIGNALLED + number)


def _loaded(module: str, function: str) -> Callable[[], Any] | None:
    return getattr(sys.modules.get(f"cube_sim.{module}"), function, None)


setattr(_leave, GIVES_WAY, True)
