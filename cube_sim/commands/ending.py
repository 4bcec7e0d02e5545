"""How a command ends: its exit code, one line for each mistake, and Ctrl-C at any moment."""

from __future__ import annotations

import atexit
import os
import signal
import sys
import threading
from contextlib import suppress
from typing import NoReturn

import typer

from cube_sim.uninterrupted import GIVES_WAY, TERMINATIONS

PASS, FAIL, BAD_INPUT, NOT_JUDGED = 0, 1, 2, 3
SIGNALLED = 128
"""And the number of the signal, where one ends the process."""
INTERRUPTED = SIGNALLED + signal.SIGINT
EXIT_CODES = {"PASS": PASS, "FAIL": FAIL, "ERROR": NOT_JUDGED}
"""Of each verdict."""
_untidied: list[bool] = []
_USUAL = {signal.SIGINT: signal.default_int_handler, **dict.fromkeys(TERMINATIONS, signal.SIG_DFL)}
"""What becomes of a signal unless somebody says otherwise."""


def stop(code: int, message: str) -> NoReturn:
    """Say on stderr why the command ends, and end it with an exit code."""
    with suppress(OSError):  # a terminal that was closed
        typer.echo(message, err=True)
    raise typer.Exit(code)


def leave_on_interrupt() -> None:
    """From now on Ctrl-C, SIGTERM and SIGHUP end the process at once: there is nothing to save while it starts up.

    One of them is left alone where somebody else decides about it, as a shell does about Ctrl-C for what runs in the
    background, and nohup about SIGHUP.
    """
    if threading.current_thread() is not threading.main_thread():
        return
    for number, usual in _USUAL.items():
        if signal.getsignal(number) is usual:
            signal.signal(number, _leave)


def raise_on_interrupt() -> None:
    """From now on Ctrl-C is the usual exception: there is something to bring to an end. The others are as usual too."""
    for number, usual in _USUAL.items():
        if signal.getsignal(number) is _leave:
            signal.signal(number, usual)


def _leave(number: int, _: object) -> None:
    """End the process; an exception would be lost or renamed inside the import of a compiled library."""
    # The progress bar hides the cursor.
    # Nothing is imported here: who has not loaded this writes nothing.
    written = sys.modules.get("cube_sim.run_directory")
    by = "" if number == signal.SIGINT else f" by {signal.Signals(number).name}"
    lost = "; nothing is recorded" if written is not None and written.abandon() else ""
    with suppress(OSError):  # a terminal that was closed
        erase = "\r\x1b[K\x1b[?25h" if sys.stderr.isatty() else ""
        os.write(2, f"{erase}interrupted{by} while starting up{lost}\n".encode())
    os._exit(SIGNALLED + number)


setattr(_leave, GIVES_WAY, True)


def leave_untidied() -> None:
    """Let `end_process` free nothing: tidying up after a flight takes half a second, and the system does it at once."""
    _untidied[:] = [True]


def end_process(code: int | str | None) -> None:
    """End the process of a command that said `leave_untidied`; return where none has, or its words find no reader.

    Threads are waited for and `atexit` is heard, as at any end of Python's.

    Args:
        code: of the `SystemExit` that ends the command.
    """
    if not _untidied or isinstance(code, str):
        return
    threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except OSError:
        return
    os._exit(code or 0)
