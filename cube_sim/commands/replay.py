"""``cube-sim replay``: fly a recorded run again and compare it bit by bit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cube_sim.commands.ending import BAD_INPUT, FAIL, NOT_JUDGED, PASS, read_or_not, stop
from cube_sim.commands.output import open_no_windows, print_json
from cube_sim.commands.progress import begin_compiling, flight_progress
from cube_sim.commands.recorded_kernel import kernel_taken, take_recorded_kernel
from cube_sim.errors import CubeSimError, ModelError, RecordingError, ScenarioError

if TYPE_CHECKING:
    from cube_sim.runs.recorded_run import RecordedRun
    from cube_sim.runs.replay import Replayed

EPILOG = (
    "Exit code: 0 identical to the bit, as far as the record goes; 1 something differs; 2 bad input, or nothing this "
    "version can fly; 3 it could not be flown to its end; 130 interrupted."
)
RunArgument = Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run, or its run.mcap.")]


def replay(
    run: RunArgument,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Show neither progress nor result.")] = False,
) -> None:
    """Fly a recorded run again, from the recording alone, and compare every signal and what was said.

    Under the kernel of OpenBLAS that it was recorded with, where this machine's processor can run it.
    """
    try:
        from cube_sim.runs.recorded_run import load_run

        recorded = load_run(run)
        if not recorded.header.code:
            open_no_windows()
        take_recorded_kernel(recorded.header)
        from cube_sim.runs.replay import replay as fly_again

        begin_compiling(hidden=quiet or json)
        scenario = recorded.whole
        with flight_progress(scenario.name, scenario.duration_s, hidden=quiet or json) as progress:
            result = fly_again(recorded, progress)
    except (RecordingError, ScenarioError, ModelError) as error:
        stop(BAD_INPUT, str(error))
    except CubeSimError as error:
        stop(NOT_JUDGED, str(error))
    with read_or_not():
        if json:
            print_json(_to_dict(result))
        elif not quiet:
            for line in _lines(recorded, result):
                typer.echo(line)
    raise typer.Exit(PASS if result.identical else FAIL)


def _to_dict(result: Replayed) -> dict[str, Any]:
    kernel = kernel_taken()
    return {
        "identical": result.identical,
        "until_s": result.until_s,
        "signals": result.signals,
        "differences": [each.to_dict() for each in result.differences],
        "other_log": result.other_log,
        "other_versions": list(result.other_versions),
        "openblas_kernel": None if kernel is None else {"flown": kernel[0], "here": kernel[1]},
    }


def _lines(recorded: RecordedRun, result: Replayed) -> list[str]:
    """What there is to say of a replay."""
    whole = "" if recorded.complete else ", as far as the record goes"
    said = f"{len(recorded.log)} line{'' if len(recorded.log) == 1 else 's'} of log"
    if result.identical:
        lines = [f"identical: {result.signals} signals and {said}, to {result.until_s:g} s{whole}"]
    else:
        lines = [f"differs: {len(result.differences)} of {result.signals} signals, to {result.until_s:g} s{whole}"]
    for each in result.differences[:1]:
        unit = recorded.fields[each.signal].unit if each.signal in recorded.fields else "1"
        unit = "" if unit == "1" else f" {unit}"
        where = each.text or f"at {each.first_s:g} s; by {each.largest:.3g}{unit} at most, at {each.largest_s:g} s"
        lines.append(f"  first: {each.signal} {where}")
    if result.other_log is not None:
        before, after = result.other_log
        lines += ["  log, recorded: " + before, "  log, now:      " + after]
    if (kernel := kernel_taken()) is not None:
        lines.append(f"  OpenBLAS's kernel {kernel[0]}, as recorded; this machine takes {kernel[1]} by itself")
    return [*lines, *(f"  version: {line}" for line in result.other_versions)]
