"""``cube-sim new vehicle``: a vehicle's model, scenario and test from what its owner knows."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, stop
from cube_sim.commands.output import to_paste
from cube_sim.commands.progress import begin_compiling
from cube_sim.errors import CubeSimError, ShapeError
from cube_sim.whole_file import undone_if_left

if TYPE_CHECKING:
    from cube_sim.vehicle.known_thrusters import KnownThruster
    from cube_sim.vehicle_draft.hull import HullDraft
    from cube_sim.vehicle_draft.thruster_places import ThrusterPlace

EPILOG = (
    "Exit code: 0 written, 2 something given is wrong, and nothing is written; or the vehicle flies none of what is "
    "tried, and model and test are written without a scenario."
)
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_THRUSTER = "NAME=x,y,z:axis:TYPE"
_CONFTEST = '"""Scenarios below this folder are tests."""\n\npytest_plugins = ["cube_sim.testing"]\n'


def vehicle(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Of the vehicle, and of the folder that is written.")],
    mass_kg: Annotated[float | None, typer.Option(metavar="KG", help="Mass, as a scale shows it.")] = None,
    mesh: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Closed surface of the hull, .obj or .stl, x forward.")
    ] = None,
    size_m: Annotated[
        str | None, typer.Option(metavar="L,W,H", help="Size of a box instead of a mesh: length, width, height [m].")
    ] = None,
    unit: Annotated[
        str | None, typer.Option(metavar="UNIT", help="Of the mesh: m (the default), cm, mm, in or ft.")
    ] = None,
    frame: Annotated[
        str,
        typer.Option(
            metavar="FRAME",
            help="Of all that is given: FLU (y left, z up) or FRD (y right, z down); x is forward. A URDF is FLU.",
        ),
    ] = "FLU",
    thruster: Annotated[
        list[str] | None,
        typer.Option(
            metavar=_THRUSTER, help="Place [m], way it pushes, type; once for each: T1=0.15,-0.11,0:1,1,0:T200."
        ),
    ] = None,
    thrusters: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV instead: name,x_m,y_m,z_m,axis_x,axis_y,axis_z,type."),
    ] = None,
    thruster_table: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV of more types: thruster,voltage_V,pulse_us,force_kgf,power_W."),
    ] = None,
    voltage_v: Annotated[
        float | None,
        typer.Option(metavar="V", help="Of the thrusters' curves. Default: that of your own table, if it is one; 16."),
    ] = None,
    battery_v: Annotated[
        str | None,
        typer.Option(
            metavar="EMPTY,FULL",
            help="Of a battery, 12.8,16.8: the thrusters get their curves at all published voltages about these.",
        ),
    ] = None,
    centre_of_mass_m: Annotated[
        str | None,
        typer.Option(metavar="X,Y,Z", help="Default: below the centre of buoyancy by a twentieth of the height."),
    ] = None,
    urdf: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Mass, centre of mass and inertia of all links of a URDF, instead of --mass-kg."
        ),
    ] = None,
    neutral: Annotated[
        bool, typer.Option("--neutral", help="Displace what it weighs, whatever mesh or box enclose.")
    ] = False,
) -> None:
    """Write a vehicle: a commented MJCF, a scenario that it passes, and a test.

    Volume, centre of buoyancy, inertia, added mass and drag come from the mesh or the box, thrust from published
    tables. What is an estimate says so in the file. On a terminal you are asked for what is missing.
    """
    from cube_sim.hull_shape.reading import FRAMES, UNITS
    from cube_sim.vehicle.known_thrusters import known_at_voltages, known_names, known_thruster
    from cube_sim.vehicle.thruster_tables import read_tables
    from cube_sim.vehicle_draft.thruster_places import places_from, places_of_file, places_of_flags, require_near

    if not _NAME.fullmatch(name):
        stop(BAD_INPUT, f"{name}: is no name of a vehicle; letters, digits and _ are right, a letter first")
    folder = Path(name)
    if folder.is_symlink() or (folder.exists() and (not folder.is_dir() or any(folder.iterdir()))):
        stop(BAD_INPUT, f"{folder}: is there already; give another name")
    if frame.upper() not in FRAMES:
        stop(BAD_INPUT, f"--frame {frame}: {' or '.join(FRAMES)} is right")
    if unit is not None and unit not in UNITS:
        stop(BAD_INPUT, f"--unit {unit}: {', '.join(UNITS)} are right")
    if mesh is not None and size_m is not None:
        stop(BAD_INPUT, "--mesh and --size-m: one of the two says what the hull is")
    if unit is not None and size_m is not None:
        stop(BAD_INPUT, "--unit and --size-m: the unit is that of a mesh; a size is in metres")
    if mass_kg is not None and urdf is not None:
        stop(BAD_INPUT, "--mass-kg and --urdf: one of the two says what the vehicle weighs")
    if thruster and thrusters is not None:
        stop(BAD_INPUT, "--thruster and --thrusters: one of the two says where they are")
    turn = frame.upper()
    try:
        tables = None if thruster_table is None else read_tables(thruster_table)
    except CubeSimError as error:
        stop(BAD_INPUT, str(error))
    types = known_names(tables)
    if sys.stdin is not None and sys.stdin.isatty():
        mass_kg = typer.prompt("Mass [kg]", type=float) if mass_kg is None and urdf is None else mass_kg
        if mesh is None and size_m is None:
            told = typer.prompt("Mesh of the hull (.obj, .stl), or length,width,height [m]")
            mesh, size_m = (Path(told), None) if Path(told).suffix.lower() in (".obj", ".stl") else (None, told)
        if not thruster and thrusters is None:
            thruster = _asked_thrusters(turn, types)
    needed = {
        "--mass-kg or --urdf": mass_kg is not None or urdf is not None,
        "--mesh or --size-m": mesh is not None or size_m is not None,
        "--thruster or --thrusters": bool(thruster) or thrusters is not None,
    }
    missing = [option for option, given in needed.items() if not given]
    if missing:
        stop(BAD_INPUT, f"missing: {', '.join(missing)}; see {to_paste('new', 'vehicle', '--help')}")
    try:
        if mass_kg is not None and not 0.0 < mass_kg < 1e9:
            raise ShapeError(f"--mass-kg {mass_kg:g}: a mass [kg] is positive")
        places = (
            places_of_flags(thruster or [], turn, types)
            if thrusters is None
            else places_of_file(thrusters, turn, types)
        )
        named = dict.fromkeys(at.kind for at in places)
        own = {volts for kind in named for volts in (tables or {}).get(kind, ())}
        volts = next(iter(own)) if voltage_v is None and len(own) == 1 else voltage_v
        at_voltages = {}
        if battery_v is not None:
            empty, full = _battery(battery_v)
            at_voltages = {kind: known_at_voltages(kind, empty, full, tables) for kind in named}
            volts = 0.5 * (empty + full) if volts is None else volts
            for several in at_voltages.values():
                if not several[0].voltage <= volts <= several[-1].voltage:
                    raise ShapeError(f"--voltage-v {volts:g}: the battery's, {empty:g} to {full:g} V, is right")
        kinds = {kind: known_thruster(kind, volts, tables) for kind in named}
        hull = _hull(mass_kg, mesh, size_m, unit or "m", turn, centre_of_mass_m, neutral, urdf)
        places = places_from(hull.origin, places)
        require_near(places, hull.middle, hull.size)
        voltages = None if battery_v is None else _battery(battery_v)
        _write(name, folder, hull, places, kinds, at_voltages, voltages)
    except CubeSimError as error:
        stop(BAD_INPUT, str(error))
    except OSError as error:
        stop(BAD_INPUT, f"{error.filename or folder}: cannot be written: {error.strerror}")


def _asked_thrusters(frame: str, types: tuple[str, ...]) -> list[str]:
    """Thrusters as flags have them, asked for one after the other; what is none is asked for again."""
    from cube_sim.vehicle_draft.thruster_places import places_of_flags

    typer.echo(f"Thrusters, as {_THRUSTER} ({', '.join(types)}), for example T1=0.15,-0.11,0:1,1,0:T200; empty: done")
    given: list[str] = []
    while told := typer.prompt(f"Thruster {len(given) + 1}", default="", show_default=False):
        try:
            places_of_flags([*given, told], frame, types)
        except CubeSimError as error:
            typer.echo(str(error), err=True)
            continue
        given.append(told)
    return given


def _hull(
    mass: float | None,
    mesh: Path | None,
    size: str | None,
    unit: str,
    frame: str,
    centre: str | None,
    neutral: bool,
    urdf: Path | None,
) -> HullDraft:
    from cube_sim.hull_shape.reading import FRAMES, read_mesh
    from cube_sim.vehicle_draft.hull import WeighedMass, hull_of_box, hull_of_mesh, mass_of

    surface = None if mesh is None else read_mesh(mesh, unit, frame)
    begin_compiling(hidden=False)
    centre_of_mass = None if centre is None else FRAMES[frame] @ _numbers("--centre-of-mass-m", centre)
    weighed = mass_of(mass or 0.0, centre_of_mass)
    if urdf is not None:
        from cube_sim.vehicle_draft.urdf import read_urdf

        links = read_urdf(urdf)
        weighed = WeighedMass(
            links.mass,
            links.centre_of_mass if centre_of_mass is None else centre_of_mass,
            links.inertia,
            f"{links.links} links of {urdf.name}",
        )
    if mesh is not None and surface is not None:
        return hull_of_mesh(surface, mesh.name, weighed, neutral)
    extent = _numbers("--size-m", size or "")
    if min(extent) <= 0.0:
        raise ShapeError(f"--size-m {size}: length, width and height [m] are positive")
    return hull_of_box(weighed, extent, neutral)


def _numbers(option: str, text: str) -> list[float]:
    try:
        values = [float(word) for word in re.split("[,x ]+", text.strip())]
    except ValueError:
        values = []
    if len(values) != 3 or not all(abs(value) < 1e6 for value in values):
        raise ShapeError(f"{option} {text}: three numbers [m] are right, for example 0.46,0.34,0.25")
    return values


def _battery(text: str) -> tuple[float, float]:
    try:
        empty, full = (float(word) for word in re.split("[,x ]+", text.strip()))
    except ValueError:
        empty, full = 0.0, 0.0
    if not 0.0 < empty <= full < 1e6:
        raise ShapeError(f"--battery-v {text}: two voltages [V], empty and full, are right, for example 12.8,16.8")
    return empty, full


def _take_away(files: Sequence[Path], folders: Sequence[Path]) -> None:
    for file in files:
        with suppress(OSError):
            file.unlink(missing_ok=True)
    for folder in folders:
        with suppress(OSError):
            folder.rmdir()


def _write(
    name: str,
    folder: Path,
    hull: HullDraft,
    places: list[ThrusterPlace],
    kinds: dict[str, KnownThruster],
    at_voltages: dict[str, tuple[KnownThruster, ...]],
    voltages: tuple[float, float] | None,
) -> None:
    from cube_sim.commands.new import write_scenario
    from cube_sim.vehicle_draft.hull import DENSITY, GRAVITY
    from cube_sim.vehicle_draft.mjcf_text import mesh_text, mjcf_text
    from cube_sim.vehicle_draft.own_tests import own_tests

    lift = (DENSITY * hull.volume - hull.mass) * GRAVITY
    files = {
        folder / "models" / f"{name}.xml": mjcf_text(name, hull, places, kinds, at_voltages),
        folder / "tests" / f"test_{name}.py": own_tests(name, hull, places, lift),
        folder / "conftest.py": _CONFTEST,
    }
    if (surface := mesh_text(hull)) is not None:
        files[folder / "models" / f"{name}.obj"] = surface
    model, scenario = folder / "models" / f"{name}.xml", folder / "scenarios" / f"{name}_first.yaml"
    whole = [*files, scenario]
    parents = sorted({file.parent for file in whole} - {folder})
    made = parents if folder.is_dir() else [*parents, folder]
    what, refused = "", None
    with undone_if_left(lambda: _take_away(whole, made)):
        for parent in parents:
            parent.mkdir(parents=True, exist_ok=True)
        for file, text in files.items():
            file.write_text(text, encoding="utf-8")
        try:
            what = write_scenario(model, scenario, None, voltages)
        except CubeSimError as error:
            refused = error
    for file in files:
        typer.echo(file)
    for remark in (*hull.remarks, *(remark for kind in kinds.values() for remark in kind.remarks)):
        typer.echo(f"NOTE: {remark}", err=True)
    if refused is not None:
        scenario.parent.rmdir()
        typer.echo(
            f"{model}: no scenario is written; `{to_paste('analyze', model)}` says what its thrusters can do", err=True
        )
        raise refused
    typer.echo(f"{scenario}: {what}")
    typer.echo()
    typer.echo(f"look at it:  {to_paste('analyze', model)}")
    typer.echo(f"fly it:      {to_paste('run', scenario)}")
    typer.echo(f"test it:     pytest {folder}")
