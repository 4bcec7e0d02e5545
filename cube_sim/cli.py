"""The command line: reads arguments, calls the library, says what came out.

Whatever is slow to import (MuJoCo, Rerun, numba, pydantic, rich) is imported by the command that needs it, so
that ``cube-sim --help`` answers at once.
"""

from __future__ import annotations

import contextlib
import json as json_format
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

if TYPE_CHECKING:
    from .simulation import Run

PASS, FAIL, BAD_INPUT, NOT_JUDGED, INTERRUPTED = 0, 1, 2, 3, 130
_EXIT_CODES = {"PASS": PASS, "FAIL": FAIL, "ERROR": NOT_JUDGED}

app = typer.Typer(
    help="Underwater vehicles in MuJoCo: real water, 3-D path following, exact thruster allocation.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def main() -> None:
    """Run the command line; the one entry of ``cube-sim`` and ``python -m cube_sim``."""
    app(prog_name="cube-sim")


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
    epilog="Exit code: 0 PASS, 1 FAIL, 2 bad input (nothing is written), 3 ERROR (could not be judged), "
    "130 interrupted (what was recorded stays)."
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
    from .errors import CubeSimError, ModelError, RecordingError, ScenarioError
    from .run_directory import check, default_directory
    from .scenario import load

    try:
        overrides = _overrides(settings or [])
        loaded = load(scenario, overrides)
        directory = out if out is not None else default_directory(loaded.scenario.name)
        check(directory)
    except (ScenarioError, RecordingError) as error:
        _stop(BAD_INPUT, str(error))

    try:
        from . import simulation

        with _progress(loaded.scenario.name, loaded.scenario.duration_s, hidden=quiet) as progress:
            result = simulation.run(scenario, overrides=overrides, out=directory, progress=progress)
    except (ScenarioError, ModelError) as error:
        _stop(BAD_INPUT, str(error))
    except CubeSimError as error:
        _stop(NOT_JUDGED, str(error))
    except KeyboardInterrupt:
        _stop(
            INTERRUPTED, f"interrupted; {f'recorded so far: {directory}' if directory.exists() else 'nothing recorded'}"
        )
    if json:
        _print_json(result)
    elif not quiet:
        _print_table(loaded.scenario.name, loaded.scenario.duration_s, result)
    raise typer.Exit(_EXIT_CODES[result.verdict])


@app.command(epilog="Exit code: 0 analysed, 2 bad input.")
def analyze(
    model: Annotated[Path, typer.Argument(help="MJCF file of a vehicle, for example models/cube.xml.")],
    lost: Annotated[str, typer.Option(metavar="NAMES", help="Dead thrusters, for example T1,T4.")] = "",
    losses: Annotated[int, typer.Option(metavar="N", help="Tabulate every loss of up to N thrusters, at most 3.")] = 0,
    hull: Annotated[str | None, typer.Option(help="Which hull, when the model has several.")] = None,
    planar: Annotated[
        bool, typer.Option("--planar", help="Look at Fx, Fy and Mz only, for a vehicle kept at its depth.")
    ] = False,
    speed: Annotated[
        float | None, typer.Option(metavar="M_S", help="Speed [m/s] at which path following is judged; default 0.3.")
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw force and torque sets and all losses of up to 3: PNG, SVG or PDF."),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print everything as JSON.")] = False,
) -> None:
    """Say what a vehicle's thrusters can do, what it loses with some of them, and whether it still follows a path."""
    from . import analyze_command, analyze_tables
    from .errors import CubeSimError

    try:
        with analyze_tables.progress(hidden=json or not sys.stderr.isatty()) as progress:
            report = analyze_command.analyze(
                model,
                hull=hull,
                lost=lost,
                losses=losses,
                planar=planar,
                speed_m_s=speed,
                picture=picture,
                progress=progress,
            )
    except CubeSimError as error:
        _stop(BAD_INPUT, str(error))
    except KeyboardInterrupt:
        _stop(INTERRUPTED, "interrupted; nothing was written")
    if json:
        typer.echo(json_format.dumps(analyze_command.to_dict(report), indent=2, ensure_ascii=False, allow_nan=False))
    else:
        analyze_tables.print_report(report)


@app.command()
def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    from .scenario.json_schema import json_schema

    typer.echo(json_schema(), nl=False)


def _overrides(settings: list[str]) -> dict[str, Any]:
    """Turn ``path=value`` arguments into overrides.

    Raises:
        ScenarioError: one mistake per argument that is not a path and a YAML value.
    """
    from .errors import ScenarioError
    from .scenario.document import parse_value

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
    from .verdict import to_dict

    content = to_dict(result.verdict, result.checks, result.real_time_factor, result.versions)
    content["directory"] = str(result.directory)
    typer.echo(json_format.dumps(content, indent=2, ensure_ascii=False, allow_nan=False))


def _print_table(name: str, duration_s: float, result: Run) -> None:
    from rich.console import Console

    from .result_table import result_table

    console = Console()
    title = f"{name}: {duration_s:g} s simulated, {result.real_time_factor:.1f} x real time"
    console.print(result_table(title, result.verdict, result.checks))
    console.print()
    for line in (
        f"recording: {result.directory}",
        f"look at it: rerun {shlex.quote(str(result.directory / 'run.rrd'))}",
    ):
        console.print(line, soft_wrap=True, markup=False, highlight=False)
