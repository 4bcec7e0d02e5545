"""How every command ends: its exit code, and one line for each mistake."""

from __future__ import annotations

import atexit
import errno
import os
import sys
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import NoReturn

import typer

from cube_sim.commands.leaving import SIGNALLED, leave_on_interrupt
from cube_sim.uninterrupted import interrupted_by, signal_of

PASS, FAIL, BAD_INPUT, NOT_JUDGED = 0, 1, 2, 3
BROKEN_PIPE = SIGNALLED + 13
"""Of who writes to somebody that no longer reads, as a shell has it."""
EPILOG = (
    "The exit codes of a command are told by its own --help. Of every command 2 is bad input, 3 an error too that "
    "nobody foresaw, 130 Ctrl-C, 143 SIGTERM, 129 SIGHUP, and 141 that nobody reads what it prints; the codes of run, "
    "replay, diff and judge say what they found, whoever reads it."
)
"""Of the help of all commands together."""
EXIT_CODES = {"PASS": PASS, "FAIL": FAIL, "ERROR": NOT_JUDGED}
"""Of each verdict."""
_TRACEBACK = "CUBE_SIM_TRACEBACK"
_OF_OUTPUT = (errno.ENOSPC, errno.EIO, errno.EFBIG, errno.EDQUOT)
"""What the system says of a place that takes no more; whoever writes a file says which."""


def stop(code: int, message: str) -> NoReturn:
    """Say on stderr why the command ends, and end it with an exit code."""
    _say(message)
    raise typer.Exit(code)


@contextmanager
def read_or_not() -> Iterator[None]:
    """Print within what may find nobody to read it, or no room: the command's code says the same."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        _write_no_more()
    except OSError as error:
        if error.filename is not None or error.errno not in _OF_OUTPUT:
            raise
        _say(_no_room(error))
        _write_no_more()


def open_what_is_closed() -> None:
    """Let what a process of a closed stdin, stdout or stderr reads be empty, and what it prints go nowhere.

    Python has None in their places, and the system would give their numbers to the next files that are opened: a
    record would hold what a library prints.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            # The lowest number that is free, and those below are taken; processes that are started get it too.
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115


def code_of(error: BaseException) -> int:
    """The exit code of a command that ends with an exception; what there is to say of it is said, in one line.

    1 says FAIL and nothing else: what nobody foresaw has code 3.
    """
    match error:
        case typer.Exit():
            return error.exit_code
        case typer.TyperException():
            _say(_usage(error))
            return getattr(error, "exit_code", BAD_INPUT)
        case KeyboardInterrupt():
            number = signal_of(error)
            _say(interrupted_by(number))
            return SIGNALLED + number
        case OSError(filename=None, errno=errno.EPIPE):
            _write_no_more()
            return BROKEN_PIPE
        case OSError(filename=None) if error.errno in _OF_OUTPUT:
            _say(_no_room(error))
            _write_no_more()
            return NOT_JUDGED
    if os.environ.get(_TRACEBACK):
        traceback.print_exception(error)
    else:
        said = " ".join(str(error).split())
        name = f"{type(error).__name__}: {said}" if said else type(error).__name__
        _say(f"unexpected {name} ({_TRACEBACK}=1 shows where)")
    return NOT_JUDGED


def end_process(code: int) -> NoReturn:
    """End the process; nothing is freed: after a flight that takes half a second, and the system does it at once.

    Threads are waited for and `atexit` is heard, as at any end of Python's. A signal ends it at once.

    Args:
        code: its exit code, unless what is left to print finds no room, or nobody to read it.
    """
    leave_on_interrupt()
    threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except OSError as error:
        code = code_of(error)
    os._exit(code)


def _usage(error: typer.TyperException) -> str:
    """What was wrong with a command's arguments, in one line; the help, where it is that."""
    told = getattr(error, "format_message", error.__str__)().strip()
    context = getattr(error, "ctx", None)
    if context is not None and told == context.get_help().strip():
        return told
    told = " ".join(told.split()).removesuffix(".").replace("Value error, ", "")
    name = " ".join(["cube-sim", *sys.argv[1:2]]) if context is None else context.command_path
    return f"{name}: {told[:1].lower()}{told[1:]}; {name} --help says what there is"


def _no_room(error: OSError) -> str:
    return f"the output cannot be written: {error.strerror}"


def _say(line: str) -> None:
    with suppress(OSError):  # a terminal that was closed
        typer.echo(line, err=True)


def _write_no_more() -> None:
    """Let what stdout still holds go nowhere: Python would try again at its end, and end with a code of its own."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
