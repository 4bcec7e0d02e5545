"""``cube-sim export``: a recorded run as CSV, Parquet, or its view made again."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, NOT_JUDGED, stop
from cube_sim.commands.replay import RunArgument
from cube_sim.errors import RecordingError

EPILOG = "Exit code: 0 written, 2 bad input, 3 it cannot be written."


class Format(Enum):
    """What is written."""

    CSV = "csv"
    PARQUET = "parquet"
    RRD = "rrd"
    INPUTS = "inputs"
    LAYOUT = "layout"


def export(
    run: RunArgument,
    to: Annotated[Path, typer.Argument(metavar="FOLDER", help="Where the files go: new, or empty.")],
    format_: Annotated[
        Format,
        typer.Option(
            "--format",
            help="csv and parquet: a file per channel, names and units in its header. rrd: the view for the Rerun "
            "viewer. inputs: the scenario and every file it flies on, ready to be run. layout: how Foxglove and "
            "Lichtblick show run.mcap.",
        ),
    ] = Format.CSV,
    channels: Annotated[
        list[str] | None, typer.Option("--channel", metavar="NAME", help="Only this one. May be repeated.")
    ] = None,
) -> None:
    """Write a recorded run in another form."""
    try:
        from cube_sim.runs.recorded_run import load_run

        recorded = load_run(run)
        known = [channel.name for channel in recorded.recording.channels]
        for name in channels or []:
            if name not in known:
                raise RecordingError(f"--channel {name}: no such channel; there are {', '.join(known)}")
        if to.exists() and (not to.is_dir() or any(to.iterdir())):
            raise RecordingError(f"{to}: is not an empty folder")
        to.mkdir(parents=True, exist_ok=True)
        if format_ is Format.RRD:
            from cube_sim.recording.export import rrd_from_mcap

            files = [to / "run.rrd"]
            rrd_from_mcap(recorded.path, files[0])
        elif format_ is Format.INPUTS:
            from cube_sim.recording.saved_inputs import save_inputs

            files = [save_inputs(recorded.header, to)]
        elif format_ is Format.LAYOUT:
            from cube_sim.recording.mcap.viewer_layout import viewer_layout

            files = [to / "layout.json"]
            files[0].write_text(viewer_layout(recorded.recording.channels, recorded.recording.vehicle))
        else:
            from cube_sim.runs.tables import tables_of, write_csv, write_parquet

            write = write_csv if format_ is Format.CSV else write_parquet
            files = [write(table, to) for table in tables_of(recorded, channels or ())]
    except RecordingError as error:
        stop(BAD_INPUT, str(error))
    except OSError as error:
        stop(NOT_JUDGED, f"{to}: cannot be written: {error.strerror or error}")
    for file in files:
        typer.echo(str(file))
    if recorded.flaw and format_ not in (Format.INPUTS, Format.LAYOUT):
        typer.echo(f"{recorded.path}: {recorded.flaw}", err=True)
