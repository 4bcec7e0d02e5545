"""``cube-sim plot``: a run as a figure for a publication."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cube_sim.commands.beside import beside
from cube_sim.commands.ending import BAD_INPUT, NOT_JUDGED, stop
from cube_sim.commands.output import give_matplotlib_a_folder
from cube_sim.commands.replay import RunArgument
from cube_sim.errors import RecordingError
from cube_sim.whole_file import written_whole

if TYPE_CHECKING:
    from cube_sim.runs.recorded_run import RecordedRun

EPILOG = "Exit code: 0 written, 2 bad input, 3 it cannot be written. The same run gives the same bytes."


def plot(
    run: RunArgument,
    signals: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SIGNAL",
            help="What is drawn, a panel each: path_error.cross_track, thrusters.force, thrusters.force.T3. Default: "
            "the path from above, heights, path errors, force demanded, thrusters.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Figure to write, .png, .svg or .pdf by its suffix; an earlier one is replaced. Default: a .png "
            "beside the run, under its name.",
        ),
    ] = None,
    width_mm: Annotated[
        float,
        typer.Option(
            min=55.0,
            max=1000.0,
            help="Width of the figure [mm]; below 120 the path is above the curves, not beside them.",
        ),
    ] = 170.0,
    from_s: Annotated[float | None, typer.Option(metavar="S", help="Start of the time drawn [s].")] = None,
    to_s: Annotated[float | None, typer.Option(metavar="S", help="End of the time drawn [s].")] = None,
    vehicle: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Of several vehicles, the one that is drawn. Default: errors and distances."),
    ] = None,
) -> None:
    """Draw signals of a run, with units, limits of checks and events, as PNG, SVG or PDF."""
    file = beside(run, ".png") if out is None else out
    try:
        give_matplotlib_a_folder()
        from cube_sim.report.figure import FORMATS, save_figure

        if file.suffix.lower() not in FORMATS:
            raise RecordingError(f"{file}: a figure is one of {', '.join(FORMATS)}")
        from cube_sim.report import colours
        from cube_sim.report.subject import Subject
        from cube_sim.runs.recorded_run import load_run

        recorded = load_run(run)
        drawn, signals = _drawn(recorded, vehicle, signals)
        # What is outside the run would leave its curves no room.
        start = 0.0 if from_s is None or from_s < 0.0 else from_s
        end = recorded.recorded_s if to_s is None or to_s > recorded.recorded_s else to_s
        if start >= recorded.recorded_s:
            raise RecordingError(f"--from-s {start:g}: the run ends at {recorded.recorded_s:g} s")
        if not start < end:
            raise RecordingError(f"there is nothing to draw from {start:g} s to {end:g} s")
        window = None if from_s is None and to_s is None else (start, end)
        subject = Subject(drawn, drawn.scenario.name, colours.BLUE)
        with written_whole(file) as part:
            save_figure(subject, signals or (), part, width_mm, window)
    except RecordingError as error:
        stop(BAD_INPUT, str(error))
    except ImportError:
        stop(NOT_JUDGED, "figures need matplotlib, which is not installed: pip install matplotlib")
    except OSError as error:
        stop(NOT_JUDGED, f"{file}: cannot be written: {error.strerror or error}")
    typer.echo(str(file))
    if not recorded.complete:
        typer.echo(f"{recorded.path}: {recorded.flaw}", err=True)


def _drawn(recorded: RecordedRun, vehicle: str | None, signals: list[str] | None) -> tuple[RecordedRun, list[str]]:
    """What is drawn of a run, and which of its signals; none for the usual ones.

    Raises:
        RecordingError: no such vehicle.
    """
    wanted = list(signals or ())
    if vehicle is not None:
        if vehicle not in recorded.vehicles:
            there = f"there are {', '.join(recorded.vehicles)}" if recorded.vehicles else "the run is of one alone"
            raise RecordingError(f"--vehicle {vehicle}: no such vehicle; {there}")
        return recorded.vehicles[vehicle], wanted
    if not recorded.vehicles:
        return recorded, wanted
    usual = [name for name in recorded.fields if name.endswith("/path_error.cross_track")]
    usual += [name for name in recorded.fields if name.startswith("distance.")]
    return recorded.together, wanted or usual
