"""``cube-sim run``: fly a scenario, record it, judge its checks."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cube_sim.commands.account import early_end, lasted, log_lines, section
from cube_sim.commands.ending import BAD_INPUT, EXIT_CODES, NOT_JUDGED, read_or_not, stop
from cube_sim.commands.leaving import SIGNALLED
from cube_sim.commands.output import (
    console_for_tables,
    console_of_stdout,
    open_no_windows,
    print_json,
    prints_of_others,
    to_paste,
)
from cube_sim.commands.progress import begin_compiling, flight_progress
from cube_sim.commands.settings import Settings, overrides
from cube_sim.errors import CubeSimError, DirectoryError, ModelError, RunInterrupted, ScenarioError

if TYPE_CHECKING:
    from cube_sim.scenario.fleet_loading import AnyLoaded
    from cube_sim.simulation import Run

EPILOG = (
    "Exit code: 0 PASS, every check was shown to hold; 1 FAIL, one was shown not to, whatever else could not be "
    "judged; 2 bad input, nothing is written; 3 ERROR, nothing failed but something could not be judged, or the run "
    "ended early; 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP: what was recorded is closed and stays. "
    "Of several scenarios all are looked at before the first is flown, one that cannot be flown stops no other and the "
    "exit code is that of the worst: 1 where one failed, else 2, else 3. "
    "Nothing is written where that, or an error, comes before anything is flown: an earlier run in the folder stays "
    "whole until the first second of this one is recorded."
)


class Recorded(Enum):
    """What a run leaves beside its verdict."""

    FULL = "full"
    MCAP = "mcap"
    NONE = "none"


def run(
    scenarios: Annotated[
        list[Path],
        typer.Argument(
            metavar="SCENARIO",
            help="Scenario files, and folders: searched to any depth for YAML files that hold a scenario.",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for the recording: new, empty, or an earlier run's, which is replaced "
            "once the first second is flown. Of several scenarios a folder of folders, one for each, called after it. "
            "Default: logs/NAME-UTC_TIME."
        ),
    ] = None,
    settings: Settings = None,
    sample: Annotated[
        int | None,
        typer.Option(min=0, help="Fly this sample, counted from 0, of those that the scenario's samples: block has."),
    ] = None,
    record: Annotated[
        Recorded,
        typer.Option(
            help="full: run.mcap and its view run.rrd. mcap: without the view, which `cube-sim export` can make later. "
            "none: the verdict alone."
        ),
    ] = Recorded.FULL,
    live: Annotated[
        bool,
        typer.Option(
            "--live",
            help="Show the flight in a Rerun viewer on this machine while it flies. A viewer that lags, is absent or "
            "dies changes nothing.",
        ),
    ] = False,
    live_port: Annotated[int, typer.Option(min=1, max=65535, help="Where that viewer listens.")] = 9876,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Show neither progress nor result.")] = False,
) -> None:
    """Fly a scenario, or several, record them, judge their checks."""
    if len(scenarios) != 1 or scenarios[0].is_dir():
        if sample is not None or live:
            option = "--live" if live else "--sample"
            stop(BAD_INPUT, f"{option} is of one scenario; {len(scenarios)} files or folders were given")
        raise typer.Exit(_fly_several(scenarios, settings, out, record, json=json, quiet=quiet))
    scenario = scenarios[0]
    with prints_of_others(json):
        given = scenario, settings, sample, out, record, live_port if live else None
        name, duration_s, result = _fly(*given, hidden=quiet)
    with read_or_not():
        if json:
            _print_json(result)
        elif not quiet:
            _print_table(name, duration_s, result, record)
    raise typer.Exit(EXIT_CODES[result.verdict])


def _fly(
    scenario: Path,
    settings: list[str] | None,
    sample: int | None,
    out: Path | None,
    record: Recorded,
    live: int | None,
    *,
    hidden: bool,
) -> tuple[str, float, Run]:
    """Load and fly; whatever goes wrong ends the command. Returns name and duration [s] of the scenario, too."""
    from cube_sim.native.heap import keep_little
    from cube_sim.run_directory import require_writable
    from cube_sim.scenario.fleet_loading import has_own_code, load_any

    keep_little()
    if record is Recorded.FULL and live is None:
        from cube_sim.recording.rerun.apart import begin

        begin()
    try:
        loaded = load_any(scenario, overrides(settings))
        if out is not None:
            # Before anything slow is imported; the run looks again.
            require_writable(out)
        if live is not None:
            _require_a_record(record)
            live = live if _somebody_listens(live) else None
        if not has_own_code(loaded):
            open_no_windows()
        if sample is not None:
            from cube_sim.campaign import sampling

            loaded = sampling.sample(loaded, sample)
        from cube_sim import simulation

        begin_compiling(hidden=hidden)
        name, duration_s = loaded.scenario.name, loaded.scenario.duration_s
        with flight_progress(name, duration_s, hidden=hidden) as progress:
            kept = record is not Recorded.NONE
            flown = simulation.fly(
                loaded, out=out, progress=progress, record=record.value, live=live, keep_signals=kept
            )
            return name, duration_s, flown
    except (ScenarioError, ModelError, DirectoryError) as error:
        stop(BAD_INPUT, str(error))
    except CubeSimError as error:
        stop(NOT_JUDGED, str(error))
    except RunInterrupted as interrupt:
        said = [] if hidden else log_lines(interrupt.log)
        stop(SIGNALLED + interrupt.number, "\n".join([*said, str(interrupt)]))


def _fly_several(
    places: list[Path], settings: list[str] | None, out: Path | None, record: Recorded, *, json: bool, quiet: bool
) -> int:
    """Look at all, fly those that can be flown, tell of each; the exit code. An interrupt ends the command."""
    from cube_sim.commands import several
    from cube_sim.commands.skipped import said_of_others
    from cube_sim.commands.validating import validated
    from cube_sim.native.heap import keep_little
    from cube_sim.scenario.finding import find

    keep_little()
    if record is Recorded.FULL:
        from cube_sim.recording.rerun.apart import begin

        begin()
    try:
        values, found = overrides(settings), find(places)
    except ScenarioError as error:
        stop(BAD_INPUT, str(error))
    outcomes: dict[Path, several.ScenarioOutcome] = {}
    flyable: dict[Path, AnyLoaded] = {}
    for file in found.scenarios:
        try:
            with prints_of_others(json):
                flyable[file] = validated(file, values)
        except ScenarioError as error:
            outcomes[file] = several.invalid(file, error)
            typer.echo(str(error), err=True)
    try:
        chosen = several.folders(out, flyable)
    except DirectoryError as error:
        stop(BAD_INPUT, str(error))
    if flyable:
        begin_compiling(hidden=quiet)
    interrupted: RunInterrupted | None = None
    for file, loaded in flyable.items():
        try:
            named = loaded.scenario.name, loaded.scenario.duration_s
            with prints_of_others(json), flight_progress(*named, hidden=quiet) as progress:
                outcomes[file] = several.fly_one(file, loaded, chosen[file], record.value, progress)
        except RunInterrupted as interrupt:
            interrupted = interrupt
            break
    told = [outcomes[file] for file in found.scenarios if file in outcomes]
    with read_or_not():
        if json:
            print_json([outcome.content for outcome in told])
        elif not quiet:
            console = console_for_tables()
            console.print(several.table_of(told, [file for file in found.scenarios if file not in outcomes]))
            for line in said_of_others(found.others):
                console.print(line, soft_wrap=True, markup=False, highlight=False)
    if interrupted is not None:
        stop(SIGNALLED + interrupted.number, str(interrupted))
    return several.exit_code(told)


def _require_a_record(record: Recorded) -> None:
    if record is Recorded.NONE:
        stop(BAD_INPUT, "--live shows what is recorded; it does not go with --record none")


def _somebody_listens(port: int) -> bool:
    """Whether there is a viewer; says so where there is none."""
    from cube_sim.recording.live import somebody_listens

    found = somebody_listens(port)
    if not found:
        typer.echo(f"no viewer listens at port {port}, one is started by: rerun; flying on without it", err=True)
    return found


def _print_json(result: Run) -> None:
    from cube_sim.verdict import Flown, to_dict

    flown = Flown(result.simulated_s, result.ended_early, result.log)
    content = to_dict(result.verdict, result.checks, result.real_time_factor, result.versions, flown)
    content["directory"] = str(result.directory)
    print_json(content)


def _print_table(name: str, duration_s: float, result: Run, record: Recorded) -> None:
    from cube_sim.commands.result_table import result_table
    from cube_sim.run_directory import RRD_FILE

    console = console_of_stdout()
    title = f"{name}: {lasted(result, duration_s)}, {result.real_time_factor:.1f} x real time"
    console.print(result_table(title, result.verdict, result.checks, early_end(result)))
    kept = "verdict" if record is Recorded.NONE else "recording"
    lines = [*section("log:", log_lines(result.log)), "", f"{kept}: {result.directory}"]
    if record is Recorded.FULL and not any(line.text.startswith(RRD_FILE) for line in result.log):
        lines.append(f"look at it: {to_paste('view', result.directory)}")
    for line in lines:
        console.print(line, soft_wrap=True, markup=False, highlight=False)
