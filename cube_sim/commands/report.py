"""``cube-sim report``: one HTML page of a run, of several side by side, or of a sweep, to send to somebody."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cube_sim.commands.beside import beside
from cube_sim.commands.ending import BAD_INPUT, NOT_JUDGED, stop
from cube_sim.commands.labels import labels
from cube_sim.errors import RecordingError
from cube_sim.whole_file import written_whole

SWEEP_FILE = "sweep.json"
"""What a folder of a sweep is known by; `cube_sim.campaign.folder` writes it."""
EPILOG = "Exit code: 0 written, whatever the verdict; 2 bad input; 3 it cannot be written."


def report(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN", help="Folders of runs, or run.mcap; or of a sweep.")],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE",
            help="Where the page goes; an earlier one is replaced. Default: beside the first run, under its name.",
        ),
    ] = None,
) -> None:
    """Write a run as one HTML page with all it needs inside; several runs side by side on one; or a sweep."""
    more = f"_and_{len(runs) - 1}_more" if len(runs) > 1 else ""
    file = beside(runs[0], ".html", more) if out is None else out
    try:
        if file.is_dir():
            raise RecordingError(f"{file}: is a folder; give the name of a file")
        if file.suffix.lower() not in (".html", ".htm") and not _is_a_stream(file):
            raise RecordingError(f"{file}: a report is a page of HTML, {file.with_suffix('.html').name} for example")
        content = _of_sweep(runs) if any((run / SWEEP_FILE).is_file() for run in runs) else _of_runs(runs)
    except RecordingError as error:
        stop(BAD_INPUT, str(error))
    try:
        with written_whole(file) as part:
            part.write_text(content, encoding="utf-8", newline="\n")
    except OSError as error:
        stop(NOT_JUDGED, f"{file}: cannot be written: {error.strerror or error}")
    typer.echo(str(file))


def _of_runs(runs: list[Path]) -> str:
    from cube_sim.runs.recorded_run import load_run

    recorded = [load_run(run) for run in runs]
    from cube_sim.report.page import report as page

    return page(recorded, labels(runs, [run.whole.name for run in recorded]))


def _of_sweep(folders: list[Path]) -> str:
    from cube_sim.campaign.result import load_sweep
    from cube_sim.report.sweep_page import sweep_report

    return sweep_report(load_sweep(folders))


def _is_a_stream(file: Path) -> bool:
    """Whether it is there and no usual file, as /dev/stdout, which loses nothing."""
    return file.exists() and not file.is_file()
