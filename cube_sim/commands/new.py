"""``cube-sim new``: a first scenario for a model; ``cube-sim new vehicle`` is a model in the first place."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from cube_sim.commands import new_vehicle
from cube_sim.commands.ending import BAD_INPUT, stop
from cube_sim.commands.output import open_no_windows, to_paste
from cube_sim.commands.progress import begin_compiling
from cube_sim.errors import CubeSimError
from cube_sim.whole_file import written_whole

EPILOG = (
    "Exit code: 0 written, 2 there is a file already, or the model flies none of what is tried; nothing is written."
)


class ScenarioUnlessNamed(TyperGroup):
    """`new MODEL` is `new scenario MODEL`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """See click."""
        named = args and (args[0] in self.commands or args[0] in ctx.help_option_names)
        return super().parse_args(ctx, args if named or not args else ["scenario", *args])


def scenario(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="MJCF file of a vehicle: models/cube.xml.")],
    file: Annotated[
        Path | None,
        typer.Argument(metavar="FILE", help="Scenario file to write. Default: MODEL_first.yaml in this folder."),
    ] = None,
    hull: Annotated[str | None, typer.Option(help="Which hull, when the model has several.")] = None,
) -> None:
    """Write a first scenario for a model, with remarks.

    The model is asked for its thrusters and what they can do. Paths are flown, the most telling first, until one is
    followed: that one is written, with checks that it passes.
    """
    file = file or Path(f"{model.stem}_first.yaml")
    if file.exists() or file.is_symlink():
        stop(BAD_INPUT, f"{file}: is there already; give another name")
    if not file.parent.is_dir():
        stop(BAD_INPUT, f"{file}: there is no folder {file.parent}")
    open_no_windows()
    begin_compiling(hidden=False)
    try:
        what = write_scenario(model, file, hull)
    except CubeSimError as error:
        stop(BAD_INPUT, str(error))
    except OSError as error:
        stop(BAD_INPUT, f"{file}: cannot be written: {error.strerror}")
    typer.echo(f"{file}: {what}")
    typer.echo(f"fly it:  {to_paste('run', file)}")


def write_scenario(model: Path, file: Path, hull: str | None, voltages: tuple[float, float] | None = None) -> str:
    """Write a first scenario for a model; what it flies, in words.

    Args:
        model: the MJCF file.
        file: to be written.
        hull: its name, where the model has several.
        voltages: of a battery, empty and full [V]; None for none.

    Raises:
        CubeSimError: the model cannot be flown, or flies nothing that is tried.
        OSError: the file cannot be written.
    """
    from cube_sim.commands.analysis_report import report_on
    from cube_sim.commands.drafted_battery import drafted_battery
    from cube_sim.commands.starter import NoStarterError, candidates_by_fins, head_of, starter_for, text_of

    report = report_on(model, hull=hull)
    tried = None
    if report.vehicle.fins is not None and not report.analysis.verdict.follows:
        tried = tuple(candidates_by_fins())
        speeds = [each.speed_m_s for each in tried]
        judged = {speed: report_on(model, hull=hull, speed_m_s=speed) for speed in speeds}
        tried = tuple(each for each in tried if judged[each.speed_m_s].analysis.verdict.follows)
        if not tried:
            names, last = ", ".join(report.vehicle.fins.names), judged[speeds[-1]].analysis.verdict
            raise NoStarterError(
                f"{model}: with its fins ({names}) it follows paths at none of the speeds that are tried, "
                f"{speeds[0]:g} to {speeds[-1]:g} m/s: {last.reason}"
            )
    battery = None if voltages is None else drafted_battery(report.vehicle.thrusters, *voltages)
    chosen = starter_for(model, hull, tried, battery)
    if tried is not None:
        report = report_on(model, hull=hull, speed_m_s=chosen.candidate.speed_m_s)
    thrusters, head = report.vehicle.thrusters.names, head_of(report)
    text = text_of(chosen.candidate, model, hull, chosen.limits, file.parent, head, chosen.measured, thrusters, battery)
    with written_whole(file) as part:
        part.write_text(text, encoding="utf-8")
    return chosen.candidate.what


app = typer.Typer(
    cls=ScenarioUnlessNamed,
    help="Write a first scenario for a model (`new MODEL`), or all of a vehicle (`new vehicle NAME`).",
    no_args_is_help=True,
    rich_markup_mode=None,
)
app.command(short_help="Write a first scenario for a model; the word may be left out.", epilog=EPILOG)(scenario)
app.command(
    "vehicle", short_help="Write a vehicle from a mass, a mesh or size, and thrusters.", epilog=new_vehicle.EPILOG
)(new_vehicle.vehicle)
