"""``cube-sim view``: a run in the Rerun viewer, or several in one view."""

from __future__ import annotations

from pathlib import Path
from shutil import rmtree
from signal import SIGINT
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, NOT_JUDGED, PASS, stop
from cube_sim.commands.labels import labels
from cube_sim.commands.leaving import SIGNALLED, raise_on_interrupt
from cube_sim.commands.output import hush_rerun, open_no_windows
from cube_sim.errors import RecordingError
from cube_sim.uninterrupted import signal_of
from cube_sim.whole_file import undone_if_left, written_whole

if TYPE_CHECKING:
    from cube_sim.runs.recorded_run import RecordedRun

EPILOG = (
    "The view is made of run.mcap, whether run.rrd is beside it or not. Exit code: 0 looked at, 2 bad input, 3 there "
    "is nothing to show it with."
)


def view(
    runs: Annotated[
        list[Path],
        typer.Argument(metavar="RUN", help="Folders of runs, or their run.mcap; several are shown in one view."),
    ],
    web: Annotated[
        bool, typer.Option("--web", help="Serve the view to a browser on this machine, until Ctrl-C.")
    ] = False,
    save: Annotated[
        Path | None,
        typer.Option(metavar="FILE.rrd", help="Write the view to a file instead; an earlier one is replaced."),
    ] = None,
) -> None:
    """Look at a run, or at several on one time, in the Rerun viewer."""
    if web and save is not None:
        raise typer.BadParameter("--web shows the view and --save writes it: give one of them")
    hush_rerun()
    open_no_windows()
    recorded = _read(runs, save)
    try:
        from cube_sim.recording.rerun.viewer import has_display, open_window, web_viewer

        if not web and save is None and not has_display():
            stop(NOT_JUDGED, "there is no screen here; --web serves the view to a browser, --save FILE.rrd writes it")
        if save is not None:
            _write(runs, recorded, save)
            typer.echo(str(save))
            return
        with TemporaryDirectory() as folder, undone_if_left(lambda: rmtree(folder, ignore_errors=True)):
            rrd = Path(folder) / "run.rrd"
            _write(runs, recorded, rrd)
            raise_on_interrupt()  # the viewer, a process of its own, would go on
            if not web:
                return open_window(rrd)
            with web_viewer(rrd) as viewer:
                typer.echo(f"{viewer.url}\nCtrl-C ends it")
                viewer.serve()
    except RecordingError as error:
        stop(NOT_JUDGED, str(error))
    except KeyboardInterrupt as interrupt:  # Ctrl-C is how one ends looking
        number = signal_of(interrupt)
        raise typer.Exit(PASS if number == SIGINT else SIGNALLED + number) from None


def _read(runs: list[Path], save: Path | None) -> list[RecordedRun]:
    """Read the runs; bad input ends the command."""
    from cube_sim.recording.rerun.side_by_side import MOST_RUNS
    from cube_sim.runs.recorded_run import load_run

    try:
        if len(runs) > MOST_RUNS:
            raise RecordingError(f"{len(runs)} runs; a view shows up to {MOST_RUNS}")
        if save is not None and save.suffix.lower() != ".rrd" and not save.is_dir():
            raise RecordingError(f"{save}: a view is a file of Rerun, {save.with_suffix('.rrd').name} for example")
        recorded = [load_run(run) for run in runs]
        if save is not None and save.is_dir():
            raise RecordingError(f"{save}: is a folder; give the name of a file")
    except RecordingError as error:
        stop(BAD_INPUT, str(error))
    return recorded


def _write(runs: list[Path], recorded: list[RecordedRun], rrd: Path) -> None:
    """Make the view; bad input ends the command."""
    from cube_sim.recording.export import rrd_from_mcap, rrd_from_records

    try:
        with written_whole(rrd) as part:
            if len(runs) == 1:
                rrd_from_mcap(recorded[0].path, part)
            else:
                names = labels(runs, [run.whole.name for run in recorded])
                rrd_from_records([run.path for run in recorded], names, part)
    except RecordingError as error:
        stop(BAD_INPUT, str(error))
    except (OSError, RuntimeError) as error:  # what Rerun says of a place that cannot be written is the second
        said = getattr(error, "strerror", None) or str(error)
        stop(NOT_JUDGED, f"{rrd}: cannot be written: {said}")
    for run in recorded:
        if not run.complete:
            typer.echo(f"{run.path}: {run.flaw}", err=True)
