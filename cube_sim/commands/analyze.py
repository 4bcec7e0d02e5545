"""``cube-sim analyze``: what a vehicle's thrusters can do, with some of them lost too."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, stop
from cube_sim.commands.leaving import SIGNALLED, raise_on_interrupt
from cube_sim.commands.output import give_matplotlib_a_folder, open_no_windows, print_json
from cube_sim.commands.progress import loss_progress
from cube_sim.errors import ActuationError, CubeSimError
from cube_sim.uninterrupted import interrupted_by, signal_of

SCENARIO_SUFFIXES = (".yaml", ".yml", ".json")
EPILOG = "Exit code: 0 analysed, 2 bad input."


def analyze(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="MJCF file of a vehicle: models/cube.xml.")],
    lost: Annotated[
        str, typer.Option(metavar="NAMES", help="Dead thrusters, and fins that no longer steer, for example T1,T4.")
    ] = "",
    losses: Annotated[
        int, typer.Option(metavar="N", help="Tabulate every loss of up to N thrusters, at most 3, on top of --lost.")
    ] = 0,
    hull: Annotated[str | None, typer.Option(help="Which hull, when the model has several.")] = None,
    planar: Annotated[
        bool, typer.Option("--planar", help="Look at Fx, Fy and Mz only, for a vehicle kept at its depth.")
    ] = False,
    speed: Annotated[
        float | None, typer.Option(metavar="M_S", help="Speed [m/s] at which path following is judged; default 0.3.")
    ] = None,
    cost_limit: Annotated[
        float | None,
        typer.Option(
            metavar="N_PER_N",
            help="Drop the directions that cost more thruster force than this per newton of wrench, and judge what is "
            "left, as a scenario's control.cost_limit does. Default: those a hundred times as costly as the cheapest.",
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw force and torque sets and all losses of up to 3: PNG, SVG or PDF."),
    ] = None,
    stuck: Annotated[
        bool,
        typer.Option(
            "--stuck",
            help="Tabulate every single thruster dead, and stuck at half of either limit and at the limits: what is "
            "left, whether the path is followed, how fast the hull is carried off, how far it leaves its path at most. "
            "And every single fin loose, and jammed at half and all of its travel either way, flown.",
        ),
    ] = False,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="What if: --set 'site:T*.pos+=[0,0,-0.05]' moves all sites whose names begin with T, --set "
            "hull:mass=30 or 'hull:added_mass*=1.2' sets a parameter; printed beside what the model is. May be "
            "repeated.",
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print everything as JSON.")] = False,
) -> None:
    """Say what a vehicle's thrusters can do, what it loses with some of them, and whether it still follows a path."""
    open_no_windows()
    give_matplotlib_a_folder()
    from cube_sim.commands import analysis_report, analysis_tables, what_if_tables
    from cube_sim.commands.steering_speed import with_steering_speed

    try:
        raise_on_interrupt()
        _require_no_scenario(model)
        with loss_progress(hidden=json) as progress:
            before = None
            plain = {"hull": hull, "lost": lost, "planar": planar, "cost_limit": cost_limit}
            if settings:
                before = analysis_report.report_on(model, speed_m_s=speed, **plain)
            report = analysis_report.report_on(
                model,
                settings=settings or (),
                hull=hull,
                lost=lost,
                losses=losses,
                planar=planar,
                speed_m_s=speed,
                cost_limit=cost_limit,
                picture=picture,
                stuck=stuck,
                progress=progress,
            )
            if speed is None:
                at = partial(analysis_report.report_on, model, settings=settings or (), **plain)
                report = with_steering_speed(report, lambda tried: at(speed_m_s=tried))
    except CubeSimError as error:
        stop(BAD_INPUT, str(error))
    except KeyboardInterrupt as interrupt:
        number = signal_of(interrupt)
        stop(SIGNALLED + number, f"{interrupted_by(number)}; nothing was written")
    if json:
        content = analysis_report.to_dict(report)
        if before is not None:
            content |= {"set": settings, "as_it_is": analysis_report.to_dict(before)}
        print_json(content)
    else:
        if before is not None:
            what_if_tables.print_beside(before, report, settings or [])
        analysis_tables.print_report(report)


def _require_no_scenario(path: Path) -> None:
    """Refuse a scenario, with the command for its model.

    Raises:
        ActuationError: it is one.
    """
    if path.suffix.lower() not in SCENARIO_SUFFIXES or not path.is_file():
        return
    from cube_sim.scenario import load

    model, speed = "MODEL", ""
    try:
        scenario = load(path).scenario
        model, speed = os.path.relpath(scenario.model), f" --speed {scenario.guidance.speed_m_s:g}"
    except CubeSimError:  # of several vehicles, or with mistakes of its own
        pass
    raise ActuationError(f"{path}: is a scenario, and analyze takes a model: cube-sim analyze {model}{speed}")
