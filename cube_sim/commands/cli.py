"""The command line: one app, its entry point, and the commands in it.

Each command is a file beside this one. Whatever is slow to import (MuJoCo, Rerun, numba, pydantic, rich) is imported
when a command runs, so that ``cube-sim --help`` answers at once.
"""

from __future__ import annotations

import errno
import os
import sys
import traceback
from contextlib import suppress
from typing import Annotated

import typer

from cube_sim.commands import (
    analyze,
    diff,
    examples,
    export,
    judge,
    plot,
    recover,
    reference,
    replay,
    report,
    run,
    schema,
    signals,
    view,
)
from cube_sim.commands.ending import NOT_JUDGED, end_process, leave_on_interrupt, raise_on_interrupt

_TRACEBACK = "CUBE_SIM_TRACEBACK"
_OF_OUTPUT = (errno.ENOSPC, errno.EIO, errno.EFBIG, errno.EDQUOT)
"""What the system says of a place that takes no more; whoever writes a file says which."""

app = typer.Typer(
    help="Underwater vehicles in MuJoCo: real water, 3-D path following, exact thruster allocation.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command(epilog=run.EPILOG)(run.run)
app.command(epilog=replay.EPILOG)(replay.replay)
app.command(epilog=diff.EPILOG)(diff.diff)
app.command(epilog=judge.EPILOG)(judge.judge)
app.command(epilog=report.EPILOG)(report.report)
app.command(epilog=view.EPILOG)(view.view)
app.command(epilog=plot.EPILOG)(plot.plot)
app.command(epilog=export.EPILOG)(export.export)
app.command(epilog=recover.EPILOG)(recover.recover)
app.command(epilog=signals.EPILOG)(signals.signals)
app.command(epilog=analyze.EPILOG)(analyze.analyze)
app.command(epilog=examples.EPILOG)(examples.examples)
app.command()(schema.schema)
app.command()(reference.reference)


def main() -> None:
    """Run the command line; the one entry of ``cube-sim`` and ``python -m cube_sim``.

    Exit code 1 says FAIL and nothing else: what nobody foresaw is one line and code 3.
    """
    leave_on_interrupt()
    try:
        app(prog_name="cube-sim")
    except SystemExit as end:
        end_process(end.code)
        raise
    except Exception as error:
        if os.environ.get(_TRACEBACK):
            traceback.print_exc()
        elif isinstance(error, OSError) and error.filename is None and error.errno in _OF_OUTPUT:
            typer.echo(f"the output cannot be written: {error.strerror}", err=True)
            _write_no_more()
        else:
            said = " ".join(str(error).split())
            typer.echo(f"unexpected {type(error).__name__}: {said} ({_TRACEBACK}=1 shows where)", err=True)
        sys.exit(NOT_JUDGED)
    finally:
        raise_on_interrupt()


def _write_no_more() -> None:
    """Let what stdout still holds go nowhere: Python would try again at its end, and end with a code of its own."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(version("cube-sim"))
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    pass


if __name__ == "__main__":
    main()
