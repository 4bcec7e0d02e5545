"""``cube-sim report``: one HTML page of a run, or of several side by side, to send to somebody."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, NOT_JUDGED, stop
from cube_sim.commands.labels import labels
from cube_sim.errors import RecordingError
from cube_sim.run_directory import MCAP_FILE, RESOLVED_FILE

EPILOG = "Exit code: 0 written, whatever the verdict; 2 bad input; 3 it cannot be written."


def report(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN...", help="Folders of runs, or their run.mcap.")],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE",
            help="Where the page goes; an earlier one is replaced. Default: beside the first run, under its name.",
        ),
    ] = None,
) -> None:
    """Write a run as one HTML page with all it needs inside; several runs side by side on one."""
    file = _beside(runs) if out is None else out
    try:
        if file.is_dir():
            raise RecordingError(f"{file}: is a folder; give the name of a file")
        from cube_sim.runs.recorded_run import load_run

        recorded = [load_run(run) for run in runs]
        from cube_sim.report.page import report as page

        content = page(recorded, labels(runs, [run.scenario.name for run in recorded]))
    except RecordingError as error:
        stop(BAD_INPUT, str(error))
    try:
        file.write_text(content, encoding="utf-8", newline="\n")
    except OSError as error:
        stop(NOT_JUDGED, f"{file}: cannot be written: {error.strerror or error}")
    typer.echo(str(file))


def _beside(runs: Sequence[Path]) -> Path:
    """Not inside a run's folder, which holds nothing but what the run writes there."""
    first = runs[0].resolve() if runs[0].name in ("", "..") else runs[0]
    if first.name == MCAP_FILE and first.with_name(RESOLVED_FILE).is_file():
        first = first.absolute().parent
    name = first.name if first.is_dir() else first.stem
    more = f"_and_{len(runs) - 1}_more" if len(runs) > 1 else ""
    return first.with_name(f"{name}{more}.html")
