"""How a command ends: its exit code, one line for each mistake, and Ctrl-C at any moment."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from typing import NoReturn

import typer

PASS, FAIL, BAD_INPUT, NOT_JUDGED = 0, 1, 2, 3
SIGNALLED = 128
"""And the number of the signal, where one ends the process."""
INTERRUPTED = SIGNALLED + signal.SIGINT
EXIT_CODES = {"PASS": PASS, "FAIL": FAIL, "ERROR": NOT_JUDGED}
"""Of each verdict."""


def stop(code: int, message: str) -> NoReturn:
    """Say on stderr why the command ends, and end it with an exit code."""
    with suppress(OSError):  # a terminal that was closed
        typer.echo(message, err=True)
    raise typer.Exit(code)


def leave_on_interrupt() -> None:
    """From now on Ctrl-C ends the process at once: there is nothing to save while it starts up.

    Ctrl-C is left alone where somebody else decides about it, as a shell does for what runs in the background.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _leave)


def raise_on_interrupt() -> None:
    """From now on Ctrl-C is the usual exception: there is something to bring to an end."""
    if signal.getsignal(signal.SIGINT) is _leave:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _leave(*_: object) -> None:
    """End the process; an exception would be lost or renamed inside the import of a compiled library."""
    # The progress bar hides the cursor.
    erase = "\r\x1b[K\x1b[?25h" if sys.stderr.isatty() else ""
    os.write(2, f"{erase}interrupted while starting up\n".encode())
    os._exit(INTERRUPTED)
