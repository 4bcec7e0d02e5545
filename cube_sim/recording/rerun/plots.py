"""Which curves and lanes the Rerun view shows, by name; the sink fills them, the blueprint lays them out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cube_sim.recording.channels import Channel, Field
from cube_sim.recording.rerun import palette
from cube_sim.recording.rerun.palette import Rgb


@dataclass(frozen=True)
class Curves:
    """Curves drawn as one Rerun entity.

    Attributes:
        channel: where the numbers are recorded.
        field: which of them.
        entity: Rerun path.
        names: of the curves, with their unit.
        colours: one per curve.
        columns: which numbers of the field are drawn, or () for all.
        width: line width [points].
    """

    channel: str
    field: str
    entity: str
    names: tuple[str, ...]
    colours: tuple[Rgb, ...]
    columns: tuple[int, ...] = ()
    width: float = 1.5


@dataclass(frozen=True)
class Lane:
    """A coloured lane of a state that changes now and then.

    Attributes:
        channel: where the code is recorded.
        field: which field of it.
        column: which number of the field.
        entity: Rerun path; its last part names the lane.
        states: label and colour by code.
        bounds: increasing; where given, the number is no code yet: 0 below the first bound, 1 from there on, ...
    """

    channel: str
    field: str
    column: int
    entity: str
    states: dict[int, tuple[str, Rgb]]
    bounds: tuple[float, ...] = ()


ERROR, ATTITUDE, FORCE, MOMENT = "/plot/path_error", "/plot/attitude", "/plot/force", "/plot/moment"
NAVIGATION, WATER, POWER = "/plot/navigation", "/plot/water", "/plot/power"
THRUSTERS, LANES, HEALTH = "/plot/thrusters", "/state", "/health"

_BRIGHT, _DARK = (palette.ORANGE, palette.SKY, palette.GREEN), ((84, 60, 8), (30, 62, 82), (8, 60, 44))
"""Colours of x, y and z: thin bright lines on broad dark ones, so that both are seen where they agree."""
_SIDES = {-1: ("reverse", palette.REVERSE), 0: ("off", palette.IDLE), 1: ("forward", palette.FORWARD)}
_HEALTH = {0: ("dead or stuck", palette.BAD), 1: ("weak", palette.ORANGE), 2: ("whole", palette.GREEN)}
_HEALTH_BOUNDS = (1e-9, 1.0)
_CODES = {
    "EXACT": palette.GREEN,
    "HOLONOMIC": palette.GREEN,
    "LEVEL": palette.GREEN,
    "SAFE": palette.BAD,
    "INVALID_WRENCH": palette.BAD,
    "FORBIDDEN_FORCE": palette.BAD,
}
"""Colours of the codes that say all is well, or nothing is; the others are in between."""


def curves(channels: Sequence[Channel]) -> list[Curves]:
    """List the curves of a run."""
    table = {channel.name: {field.name: field for field in channel.fields} for channel in channels}
    found = []
    if errors := table.get("path_error"):
        found += [
            _single(errors["cross_track"], "path_error", ERROR, "cross-track", palette.ORANGE),
            _single(errors["along"], "path_error", ERROR, "along", palette.SKY),
            _single(errors["attitude"], "path_error", ATTITUDE, "attitude", palette.PURPLE),
        ]
    if "navigation_error" in table:
        # A broad dark line for what the estimate thinks it may be off by, a thin bright one for what it is off by.
        sigma = tuple(f"{axis} sigma [m]" for axis in ("x", "y", "z"))
        error = tuple(f"{axis} error [m]" for axis in ("x", "y", "z"))
        found += [
            Curves("navigation", "position_sigma", f"{NAVIGATION}/sigma", sigma, _DARK, width=5.0),
            Curves("navigation_error", "position", f"{NAVIGATION}/error", error, _BRIGHT),
        ]
    if "water" in table:
        for field, colours, width in (("current", _DARK, 7.0), ("estimated", _BRIGHT, 1.5)):
            names = tuple(f"{axis} {'true' if field == 'current' else field} [m/s]" for axis in ("x", "y", "z"))
            found.append(Curves("water", field, f"{WATER}/{field}", names, colours, width=width))
    if "wrench" in table:
        # Allocated is a broad dark band and demanded a thin bright line on it, which leaves the band where they differ.
        for entity, axes, unit, columns in (
            (FORCE, ("Fx", "Fy", "Fz"), "N", (0, 1, 2)),
            (MOMENT, ("Mx", "My", "Mz"), "N m", (3, 4, 5)),
        ):
            for field, colours, width in (("allocated", _DARK, 7.0), ("demanded", _BRIGHT, 1.5)):
                names = tuple(f"{axis} {field} [{unit}]" for axis in axes)
                found.append(Curves("wrench", field, f"{entity}/{field}", names, colours, columns, width))
    if thrusters := table.get("thrusters"):
        force = thrusters["force"]
        names = tuple(f"{name} [{force.unit}]" for name in force.columns)
        found.append(Curves("thrusters", "force", THRUSTERS, names, tuple(palette.series(force.width))))
    if power := table.get("power"):
        drawn = power["motor"]
        names = tuple(f"{name} [{drawn.unit}]" for name in drawn.columns)
        found += [
            Curves("power", "motor", f"{POWER}/motor", names, tuple(palette.series(drawn.width))),
            _single(power["voltage"], "power", POWER, "voltage", palette.PATH),
        ]
    return found


def lanes(channels: Sequence[Channel]) -> list[Lane]:
    """List the state lanes of a run.

    They show how the allocation ended, how the vehicle flies and on which side of its dead zone each thruster works.
    Beside them stands the health of each thruster, the true one and the one the controller believes in.
    """
    found = []
    for channel in channels:
        for field in channel.fields:
            if (channel.name, field.name) == ("allocation", "subset"):
                found += [
                    Lane(channel.name, field.name, i, f"{LANES}/{name}", _SIDES) for i, name in enumerate(field.columns)
                ]
            elif field.labels:
                states = {code: (label, _CODES.get(label, palette.ORANGE)) for code, label in enumerate(field.labels)}
                name = channel.name if field.name == "status" else field.name
                found.append(Lane(channel.name, field.name, 0, f"{LANES}/{name}", states))
            elif channel.name == "health":
                name = "believed" if field.name == "believed" else "true"
                found += [
                    Lane(channel.name, field.name, i, f"{HEALTH}/{thruster}/{name}", _HEALTH, _HEALTH_BOUNDS)
                    for i, thruster in enumerate(field.columns)
                ]
    return found


def _single(field: Field, channel: str, parent: str, name: str, colour: Rgb) -> Curves:
    return Curves(channel, field.name, f"{parent}/{field.name}", (f"{name} [{field.unit}]",), (colour,))
