"""``cube-sim view``: a run in the Rerun viewer, or several in one view."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, NOT_JUDGED, SIGNALLED, raise_on_interrupt, stop
from cube_sim.commands.labels import labels
from cube_sim.commands.output import hush_rerun
from cube_sim.errors import RecordingError
from cube_sim.uninterrupted import StoppedError, stoppable
from cube_sim.whole_file import written_whole

EPILOG = (
    "The view is made of run.mcap, whether run.rrd is beside it or not. Exit code: 0 looked at, 2 bad input, 3 there "
    "is nothing to show it with."
)


def view(
    runs: Annotated[
        list[Path],
        typer.Argument(metavar="RUN...", help="Folders of runs, or their run.mcap; several are shown in one view."),
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
    hush_rerun()
    try:
        from cube_sim.recording.rerun.viewer import has_display, open_window, web_viewer

        if not web and save is None and not has_display():
            stop(NOT_JUDGED, "there is no screen here; --web serves the view to a browser, --save FILE.rrd writes it")
        if save is not None and save.suffix.lower() != ".rrd" and not save.is_dir():
            stop(BAD_INPUT, f"{save}: a view is a file of Rerun, {save.with_suffix('.rrd').name} for example")
        with TemporaryDirectory() as folder:
            rrd = Path(folder) / "run.rrd" if save is None else save
            _write(runs, rrd)
            if save is not None:
                typer.echo(str(save))
                return
            raise_on_interrupt()
            with stoppable():  # the viewer, a process of its own, would go on
                if not web:
                    return open_window(rrd)
                with web_viewer(rrd) as viewer:
                    typer.echo(f"{viewer.url}\nCtrl-C ends it")
                    viewer.serve()
    except RecordingError as error:
        stop(NOT_JUDGED, str(error))
    except StoppedError as stopped:
        raise typer.Exit(SIGNALLED + stopped.number) from None
    except KeyboardInterrupt:
        raise typer.Exit from None


def _write(runs: list[Path], rrd: Path) -> None:
    """Make the view; bad input ends the command."""
    from cube_sim.recording.export import rrd_from_mcap, rrd_from_records
    from cube_sim.recording.rerun.side_by_side import MOST_RUNS
    from cube_sim.runs.recorded_run import load_run

    try:
        if len(runs) > MOST_RUNS:
            raise RecordingError(f"{len(runs)} runs; a view shows up to {MOST_RUNS}")
        recorded = [load_run(run) for run in runs]
        if rrd.is_dir():
            raise RecordingError(f"{rrd}: is a folder; give the name of a file")
        with written_whole(rrd) as part:
            if len(runs) == 1:
                rrd_from_mcap(recorded[0].path, part)
            else:
                names = labels(runs, [run.scenario.name for run in recorded])
                rrd_from_records([run.path for run in recorded], names, part)
    except RecordingError as error:
        stop(BAD_INPUT, str(error))
    except (OSError, RuntimeError) as error:  # what Rerun says of a place that cannot be written is the second
        said = getattr(error, "strerror", None) or str(error)
        stop(NOT_JUDGED, f"{rrd}: cannot be written: {said}")
    for run in recorded:
        if not run.complete:
            typer.echo(f"{run.path}: {run.flaw}", err=True)
