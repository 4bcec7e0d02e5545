"""``cube-sim export``: a recorded run as CSV, Parquet, or its view made again."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, NOT_JUDGED, stop
from cube_sim.commands.leaving import SIGNALLED, raise_on_interrupt
from cube_sim.commands.output import hush_rerun, open_no_windows
from cube_sim.commands.replay import RunArgument
from cube_sim.errors import RecordingError
from cube_sim.run_directory import RRD_FILE
from cube_sim.uninterrupted import interrupted_by, signal_of
from cube_sim.whole_file import filled_whole

if TYPE_CHECKING:
    from cube_sim.runs.recorded_run import RecordedRun

EPILOG = "Exit code: 0 written, 2 bad input, 3 it cannot be written, 130 interrupted: nothing is left of it."


class Format(Enum):
    """What is written."""

    CSV = "csv"
    PARQUET = "parquet"
    RRD = "rrd"
    INPUTS = "inputs"
    LAYOUT = "layout"


_OF_CHANNELS = (Format.CSV, Format.PARQUET)
"""What has a file per channel."""


def export(
    run: RunArgument,
    to: Annotated[Path, typer.Argument(metavar="FOLDER", help="Where the files go: new, or empty.")],
    format_: Annotated[
        Format,
        typer.Option(
            "--format",
            help="csv and parquet: a file per channel, names and units in its header, codes as numbers and as words. "
            "rrd: the view for the Rerun viewer. inputs: the scenario and every file it flies on, ready to be run. "
            "layout: how Foxglove and Lichtblick show run.mcap.",
        ),
    ] = Format.CSV,
    channels: Annotated[
        list[str] | None,
        typer.Option("--channel", metavar="NAME", help="Only this one, of csv or parquet. May be repeated."),
    ] = None,
) -> None:
    """Write a recorded run in another form."""
    if channels and format_ not in _OF_CHANNELS:
        formats = " and ".join(each.value for each in _OF_CHANNELS)
        raise typer.BadParameter(f"--channel is of {formats}; {format_.value} is made of the whole run")
    hush_rerun()
    open_no_windows()
    try:
        from cube_sim.runs.recorded_run import load_run

        recorded = load_run(run)
        known = [channel.name for channel in recorded.recording.channels]
        for name in channels or []:
            if name not in known:
                raise RecordingError(f"--channel {name}: no such channel; there are {', '.join(known)}")
        if to.exists() and (not to.is_dir() or any(to.iterdir())):
            raise RecordingError(f"{to}: is not an empty folder")
        raise_on_interrupt()
        with filled_whole(to):
            files = _written(recorded, to, format_, channels or ())
    except RecordingError as error:
        stop(BAD_INPUT, str(error))
    except (OSError, RuntimeError) as error:  # what Rerun says of a place that cannot be written is the second
        stop(NOT_JUDGED, f"{to}: cannot be written: {getattr(error, 'strerror', None) or error}")
    except KeyboardInterrupt as interrupt:
        number = signal_of(interrupt)
        stop(SIGNALLED + number, f"{to}: {interrupted_by(number)}, nothing is written")
    for file in files:
        typer.echo(str(file))
    if recorded.flaw and format_ not in (Format.INPUTS, Format.LAYOUT):
        typer.echo(f"{recorded.path}: {recorded.flaw}", err=True)


def _written(recorded: RecordedRun, to: Path, format_: Format, channels: Sequence[str]) -> list[Path]:
    """Write the files; which they are."""
    if format_ is Format.RRD:
        from cube_sim.recording.export import rrd_from_mcap

        rrd_from_mcap(recorded.path, to / RRD_FILE)
        return [to / RRD_FILE]
    if format_ is Format.INPUTS:
        from cube_sim.recording.saved_inputs import save_inputs

        return [save_inputs(recorded.header, to)]
    if format_ is Format.LAYOUT:
        from cube_sim.recording.mcap.viewer_layout import viewer_layout

        layout = to / "layout.json"
        layout.write_text(
            viewer_layout(recorded.recording.channels, recorded.recording.vehicle, tuple(recorded.header.vehicles))
        )
        return [layout]
    from cube_sim.runs.tables import tables_of, write_csv, write_parquet

    write = write_csv if format_ is Format.CSV else write_parquet
    return [write(table, to) for table in tables_of(recorded, channels)]
