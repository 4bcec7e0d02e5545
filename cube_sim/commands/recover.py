"""``cube-sim recover``: what is left of a damaged record, as a record that can be read."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, NOT_JUDGED, stop
from cube_sim.commands.output import hush_rerun, open_no_windows
from cube_sim.commands.replay import RunArgument
from cube_sim.errors import RecordingError, ScenarioError
from cube_sim.run_directory import MCAP_FILE, record_of

EPILOG = (
    "Exit code: 0 recovered, whatever is missing, or nothing to recover; 2 bad input, or nothing can be read; 3 it "
    "cannot be written."
)


def recover(
    run: RunArgument,
    output: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "--output",
            metavar="FOLDER",
            help="Where the record and its view go: new, empty, or that of an earlier run, which is replaced once "
            "the new record is whole. Default: beside the run, its name and _recovered.",
        ),
    ] = None,
) -> None:
    """Save what can be read of a record that was cut off or damaged, and say which rows of which channels are missing.

    What is saved never counts as a complete run.
    """
    hush_rerun()
    open_no_windows()
    try:
        record = record_of(run)
        from cube_sim.runs.recovery import recover as save

        saved = save(record, _beside(run) if output is None else output)
    except (RecordingError, ScenarioError) as error:
        stop(BAD_INPUT, str(error))
    except OSError as error:
        stop(NOT_JUDGED, f"{output or _beside(run)}: cannot be written: {error.strerror or error}")
    if isinstance(saved, str):
        typer.echo(f"{record}: {saved}")
        return
    typer.echo(f"recovered up to {saved.recorded_s:g} s: {saved.directory}")
    if saved.refused:
        typer.echo(f"  refused as it was: {saved.refused}")
    for line in saved.dropped:
        typer.echo(f"  dropped: {line}")
    if saved.changed:
        typer.echo(f"  not to be trusted: {saved.changed}")
    for line in saved.missing:
        typer.echo(f"  missing: {line}")
    if saved.view:
        typer.echo(f"  no view: {saved.view}")


def _beside(run: Path) -> Path:
    """A folder named after the run's, or after its record."""
    place = run.resolve()
    if place.name == MCAP_FILE:
        place = place.parent
    return place.with_name(f"{place.name if place.is_dir() else place.stem}_recovered")
