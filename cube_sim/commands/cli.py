"""The command line: reads arguments, calls the library, says what came out.

Whatever is slow to import (MuJoCo, Rerun, numba, pydantic, rich) is imported by the command that needs it, so
that ``cube-sim --help`` answers at once.
"""

from __future__ import annotations

import contextlib
import json as json_format
import os
import shlex
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

if TYPE_CHECKING:
    from cube_sim.simulation import Run

PASS, FAIL, BAD_INPUT, NOT_JUDGED, INTERRUPTED = 0, 1, 2, 3, 130
_TRACEBACK = "CUBE_SIM_TRACEBACK"
_EXIT_CODES = {"PASS": PASS, "FAIL": FAIL, "ERROR": NOT_JUDGED}

app = typer.Typer(
    help="Underwater vehicles in MuJoCo: real water, 3-D path following, exact thruster allocation.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def main() -> None:
    """Run the command line; the one entry of ``cube-sim`` and ``python -m cube_sim``.

    Exit code 1 says FAIL and nothing else: what nobody foresaw is one line and code 3.
    """
    # Left alone where somebody else decides about Ctrl-C, as a shell does for what runs in the background.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _leave)
    try:
        app(prog_name="cube-sim")
    except Exception as error:
        if os.environ.get(_TRACEBACK):
            traceback.print_exc()
        else:
            said = " ".join(str(error).split())
            typer.echo(f"unexpected {type(error).__name__}: {said} ({_TRACEBACK}=1 shows where)", err=True)
        sys.exit(NOT_JUDGED)
    finally:
        _raise_on_interrupt()


def _leave(*_: object) -> None:
    """Ctrl-C while starting up: there is nothing to save, and the process ends at once.

    As an exception it would be lost or renamed inside the import of a compiled library.
    """
    # The progress bar hides the cursor.
    erase = "\r\x1b[K\x1b[?25h" if sys.stderr.isatty() else ""
    os.write(2, f"{erase}interrupted while starting up\n".encode())
    os._exit(INTERRUPTED)


def _raise_on_interrupt() -> None:
    """From now on there is something to bring to an end: Ctrl-C is the usual exception."""
    if signal.getsignal(signal.SIGINT) is _leave:
        signal.signal(signal.SIGINT, signal.default_int_handler)


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


@app.command(
    epilog="Exit code: 0 PASS, every check was shown to hold; 1 FAIL, one was shown not to, whatever else could not be "
    "judged; 2 bad input, nothing is written; 3 ERROR, nothing failed but something could not be judged, or the run "
    "ended early; 130 interrupted, what was recorded stays."
)
def run(
    scenario: Annotated[Path, typer.Argument(help="Scenario file, for example scenarios/cube_helix.yaml.")],
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for the recording: new, empty, or an earlier run's, which is replaced. "
            "Default: logs/NAME-UTC_TIME."
        ),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="PATH=VALUE",
            help="Replace a value of the scenario, for example --set guidance.speed_m_s=0.3 or "
            "--set checks.0.at_most=0.2; VALUE is YAML. May be repeated.",
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Show neither progress nor result.")] = False,
) -> None:
    """Fly a scenario, record it, judge its checks."""
    name, duration_s, result = _fly(scenario, settings or [], out, hidden=quiet)
    if json:
        _print_json(result)
    elif not quiet:
        _print_table(name, duration_s, result)
    raise typer.Exit(_EXIT_CODES[result.verdict])


def _fly(scenario: Path, settings: list[str], out: Path | None, *, hidden: bool) -> tuple[str, float, Run]:
    """Load and fly; whatever goes wrong ends the command. Returns name and duration [s] of the scenario, too."""
    from cube_sim.errors import CubeSimError, DirectoryError, ModelError, RunInterrupted, ScenarioError
    from cube_sim.run_directory import check
    from cube_sim.scenario import load

    try:
        overrides = _overrides(settings)
        loaded = load(scenario, overrides)
        if out is not None:
            # Before anything slow is imported; the run looks again.
            check(out)
        from cube_sim import simulation

        name, duration_s = loaded.scenario.name, loaded.scenario.duration_s
        with _progress(name, duration_s, hidden=hidden) as show:

            def progress(simulated_s: float, whole_s: float) -> None:
                _raise_on_interrupt()
                if show is not None:
                    show(simulated_s, whole_s)

            return name, duration_s, simulation.run(scenario, overrides=overrides, out=out, progress=progress)
    except (ScenarioError, ModelError, DirectoryError) as error:
        _stop(BAD_INPUT, str(error))
    except CubeSimError as error:
        _stop(NOT_JUDGED, str(error))
    except RunInterrupted as interrupt:
        _stop(INTERRUPTED, str(interrupt))


@app.command(epilog="Exit code: 0 analysed, 2 bad input.")
def analyze(
    model: Annotated[Path, typer.Argument(help="MJCF file of a vehicle, for example models/cube.xml.")],
    lost: Annotated[str, typer.Option(metavar="NAMES", help="Dead thrusters, for example T1,T4.")] = "",
    losses: Annotated[
        int, typer.Option(metavar="N", help="Tabulate every loss of up to N thrusters, at most 3, on top of --lost.")
    ] = 0,
    hull: Annotated[str | None, typer.Option(help="Which hull, when the model has several.")] = None,
    planar: Annotated[
        bool, typer.Option("--planar", help="Look at Fx, Fy and Mz only, for a vehicle kept at its depth.")
    ] = False,
    speed: Annotated[
        float | None, typer.Option(metavar="M_S", help="Speed [m/s] at which path following is judged; default 0.3.")
    ] = None,
    cost_limit: Annotated[
        float | None,
        typer.Option(
            metavar="N_PER_N",
            help="Drop the directions that cost more thruster force than this per newton of wrench, and judge what is "
            "left, as a scenario's control.cost_limit does. Default: those a hundred times as dear as the cheapest.",
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw force and torque sets and all losses of up to 3: PNG, SVG or PDF."),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print everything as JSON.")] = False,
) -> None:
    """Say what a vehicle's thrusters can do, what it loses with some of them, and whether it still follows a path."""
    from cube_sim.commands import analyze, analyze_tables
    from cube_sim.errors import CubeSimError

    try:
        _raise_on_interrupt()
        with analyze_tables.progress(hidden=json or not sys.stderr.isatty()) as progress:
            report = analyze.analyze(
                model,
                hull=hull,
                lost=lost,
                losses=losses,
                planar=planar,
                speed_m_s=speed,
                cost_limit=cost_limit,
                picture=picture,
                progress=progress,
            )
    except CubeSimError as error:
        _stop(BAD_INPUT, str(error))
    except KeyboardInterrupt:
        _stop(INTERRUPTED, "interrupted; nothing was written")
    if json:
        typer.echo(json_format.dumps(analyze.to_dict(report), indent=2, ensure_ascii=False, allow_nan=False))
    else:
        analyze_tables.print_report(report)


@app.command()
def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    from cube_sim.scenario.json_schema import json_schema

    typer.echo(json_schema(), nl=False)


def _overrides(settings: list[str]) -> dict[str, Any]:
    """Turn ``path=value`` arguments into overrides.

    Raises:
        ScenarioError: one mistake per argument that is not a path and a YAML value.
    """
    from cube_sim.errors import ScenarioError
    from cube_sim.scenario.document import parse_value

    overrides: dict[str, Any] = {}
    mistakes: list[str] = []
    for setting in settings:
        path, equals, text = setting.partition("=")
        path = path.strip()
        if not equals or not path:
            mistakes.append(f"--set {setting}: write PATH=VALUE, for example duration_s=60")
        elif path in overrides:
            mistakes.append(f"--set {setting}: {path} is set twice")
        else:
            try:
                overrides[path] = parse_value(text)
            except ValueError as error:
                mistakes.append(f"--set {setting}: {error}")
    if mistakes:
        raise ScenarioError(mistakes)
    return overrides


def _stop(code: int, message: str) -> NoReturn:
    typer.echo(message, err=True)
    raise typer.Exit(code)


@contextlib.contextmanager
def _progress(name: str, duration_s: float, *, hidden: bool) -> Iterator[Callable[[float, float], None] | None]:
    """A bar on the terminal while a run lasts; yields what the run calls with (simulated, whole) seconds."""
    if hidden or not sys.stderr.isatty():
        yield None
        return
    import time

    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.completed:.0f} of {task.total:.0f} s simulated"),
        TextColumn("{task.fields[factor]}", markup=False),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(name, total=duration_s, factor="")
        started: float | None = None

        def update(simulated_s: float, whole_s: float) -> None:
            nonlocal started
            now = time.perf_counter()
            if started is None:
                # The first report: loading and compiling are over, nothing has moved yet.
                started = now
            factor = f"{simulated_s / (now - started):.1f} x real time" if simulated_s > 0 and now > started else ""
            bar.update(task, completed=simulated_s, total=whole_s, factor=factor)

        yield update


def _print_json(result: Run) -> None:
    from cube_sim.verdict import to_dict

    content = to_dict(result.verdict, result.checks, result.real_time_factor, result.versions)
    content["directory"] = str(result.directory)
    typer.echo(json_format.dumps(content, indent=2, ensure_ascii=False, allow_nan=False))


def _print_table(name: str, duration_s: float, result: Run) -> None:
    from rich.console import Console

    from cube_sim.commands.result_table import result_table

    console = Console()
    title = f"{name}: {duration_s:g} s simulated, {result.real_time_factor:.1f} x real time"
    console.print(result_table(title, result.verdict, result.checks))
    console.print()
    for line in (
        f"recording: {result.directory}",
        f"look at it: rerun {shlex.quote(str(result.directory / 'run.rrd'))}",
    ):
        console.print(line, soft_wrap=True, markup=False, highlight=False)


if __name__ == "__main__":
    main()
