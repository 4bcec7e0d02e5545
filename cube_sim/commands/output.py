"""What commands print alike: JSON, and tables that fit a terminal, a file or a pipe."""

from __future__ import annotations

import errno
import json
import logging
import os
import shlex
import shutil
import sys
from contextlib import AbstractContextManager, nullcontext, redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from rich.console import Console

NAME = "cube-sim"
FILE_WIDTH = 160
"""Columns a table may take where nobody folds lines: in a file or a pipe."""


def hush_rerun() -> None:
    """Let Rerun, which is imported later, say nothing in its own words: what fails is told by whoever asked for it."""
    os.environ.setdefault("RUST_LOG", "off")


def open_no_windows() -> None:
    """Let MuJoCo, which is imported later, not look for what draws windows, a tenth of a second and another process.

    Not where code of the user's own is flown: that may draw.
    """
    os.environ.setdefault("MUJOCO_GL", "disable")


def to_paste(*arguments: object) -> str:
    """A command of this program as a line that works when it is pasted into the shell that called this one.

    `.venv/bin/cube-sim` and `python -m cube_sim` are called as they were, unless what is meant is on the PATH.

    Args:
        arguments: behind the program's name.
    """
    called = Path(sys.argv[0])
    found = shutil.which(NAME)
    if called.name == "__main__.py":
        program = [sys.executable, "-m", "cube_sim"]
    elif called.name == NAME and called.is_file() and (found is None or not Path(found).samefile(called)):
        program = [sys.argv[0]]
    else:
        program = [NAME]
    return shlex.join([*program, *map(str, arguments)])


def give_matplotlib_a_folder() -> None:
    """Let matplotlib, which is imported later, keep its list of fonts where the user says that all is kept.

    A user without a home would be told at every picture that the list is made once more.
    """
    named = os.environ.get("CUBE_SIM_CACHE_DIR")
    if named and os.access(named, os.W_OK | os.X_OK):
        os.environ.setdefault("MPLCONFIGDIR", os.path.join(named, "matplotlib"))
    elif not os.path.isabs(os.path.expanduser("~")):
        logging.getLogger("matplotlib").setLevel(logging.ERROR)


def prints_of_others(json: bool) -> AbstractContextManager[object]:
    """Where code of the user's own prints to: beside the result where that is JSON, which has stdout for itself."""
    return redirect_stdout(sys.stderr) if json else nullcontext()


def print_json(content: Any) -> None:
    """Print plain data as indented JSON.

    Raises:
        ValueError: a number is NaN or infinite, which JSON cannot say.
    """
    typer.echo(json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False))


def console_of_stdout() -> Console:
    """A console to which nobody may listen any more: that is an error of the system's, as of any other print."""
    from rich.console import Console

    class StdoutConsole(Console):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE))

    return StdoutConsole()


def console_for_tables() -> Console:
    """That console as wide as the terminal, or at least `FILE_WIDTH` where there is none."""
    console = console_of_stdout()
    if not console.is_terminal:
        console.width = max(console.width, FILE_WIDTH)
    return console
