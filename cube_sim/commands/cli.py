"""The command line: one app, its entry point, and the commands in it.

Each command is a file beside this one. Whatever is slow to import (MuJoCo, Rerun, numba, pydantic, rich) is imported
when a command runs, so that ``cube-sim --help`` answers at once.
"""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from cube_sim.commands import (
    analyze,
    diff,
    examples,
    export,
    judge,
    new,
    plot,
    recover,
    reference,
    replay,
    report,
    run,
    schema,
    signals,
    sweep,
    validate,
    view,
)
from cube_sim.commands.ending import (
    EPILOG,
    PASS,
    code_of,
    end_process,
    open_what_is_closed,
)
from cube_sim.commands.leaving import leave_on_interrupt, leave_to_others
from cube_sim.native.heap import seldom_look_for_circles

app = typer.Typer(
    help="Underwater vehicles in MuJoCo: real water, 3-D path following, exact thruster allocation.",
    epilog=EPILOG,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command(short_help="Fly scenarios, record them, judge their checks.", epilog=run.EPILOG)(run.run)
app.command(short_help="Say whether scenarios can be flown, without flying.", epilog=validate.EPILOG)(validate.validate)
app.command(short_help="Fly all samples of a scenario, count what passes.", epilog=sweep.EPILOG)(sweep.sweep)
app.command(short_help="Fly a recorded run again and compare it bit by bit.", epilog=replay.EPILOG)(replay.replay)
app.command(short_help="Compare two runs: settings, files, signals.", epilog=diff.EPILOG)(diff.diff)
app.command(short_help="Judge a recorded run again, by its checks or others.", epilog=judge.EPILOG)(judge.judge)
app.command(short_help="Write a run, or several, as one HTML page.", epilog=report.EPILOG)(report.report)
app.command(short_help="Look at a run, or several, in the Rerun viewer.", epilog=view.EPILOG)(view.view)
app.command(short_help="Draw signals of a run as PNG, SVG or PDF.", epilog=plot.EPILOG)(plot.plot)
app.command(short_help="Write a recorded run as tables, a view, inputs, a layout.", epilog=export.EPILOG)(export.export)
app.command(short_help="Save what can be read of a damaged record.", epilog=recover.EPILOG)(recover.recover)
app.command(short_help="List what a scenario records and its checks may name.", epilog=signals.EPILOG)(signals.signals)
app.command(short_help="Say what a vehicle's thrusters can do, all or some.", epilog=analyze.EPILOG)(analyze.analyze)
app.add_typer(new.app, name="new", short_help="Write a vehicle, or a first scenario for a model.")
app.command(short_help="Copy models and scenarios to start from.", epilog=examples.EPILOG)(examples.examples)
app.command(short_help="Print the JSON schema of scenario files, for editors.")(schema.schema)
app.command(short_help="Print the reference of scenarios or of recordings.")(reference.reference)


def main() -> None:
    """Run the command line, and end the process."""
    open_what_is_closed()
    leave_on_interrupt()
    seldom_look_for_circles()
    try:
        code = _code_of_command()
    except KeyboardInterrupt as late:  # the command had come to its end
        code = code_of(late)
    try:
        end_process(code)
    finally:
        leave_to_others()
    sys.exit(code)


def _code_of_command() -> int:
    """Run what was asked for; its exit code."""
    command = typer.main.get_command(app)
    try:
        with command.make_context("cube-sim", sys.argv[1:]) as context:
            command.invoke(context)
    except BaseException as error:
        leave_on_interrupt()
        return code_of(error)
    leave_on_interrupt()
    return PASS


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
