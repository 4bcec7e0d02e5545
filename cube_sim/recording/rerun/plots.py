"""Which curves and lanes the Rerun view shows, by name; the sink fills them, the blueprint lays them out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.recording.channels import Channel, Field
from cube_sim.recording.rerun import palette
from cube_sim.recording.rerun.palette import Rgb

Values = NDArray[np.float64]


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
        derived: what is drawn of the field's numbers (n, width), (n, curves); None for themselves.
        dots: whether every number is a dot of its own, as readings are.
    """

    channel: str
    field: str
    entity: str
    names: tuple[str, ...]
    colours: tuple[Rgb, ...]
    columns: tuple[int, ...] = ()
    width: float = 1.5
    derived: Callable[[Values], Values] | None = None
    dots: bool = False

    def values(self, numbers: Values) -> Values:
        """What is drawn of the field's numbers (n, width): (n, curves)."""
        if self.derived is not None:
            return self.derived(numbers)
        return numbers[:, list(self.columns)] if self.columns else numbers


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
        thruster: whose force takes the state to `AT_LIMIT` while it is at a limit; None for a code by itself.
    """

    channel: str
    field: str
    column: int
    entity: str
    states: dict[int, tuple[str, Rgb]]
    bounds: tuple[float, ...] = ()
    thruster: int | None = None


ERROR, ATTITUDE, FORCE, MOMENT = "/plot/path_error", "/plot/attitude", "/plot/force", "/plot/moment"
NAVIGATION, WATER, POWER = "/plot/navigation", "/plot/water", "/plot/power"
VELOCITY, HEIGHT, HEADING = "/plot/velocity", "/plot/height", "/plot/heading"
BATTERY, SURPRISE = "/plot/battery", "/plot/surprise"
THRUSTERS, FINS, LANES, HEALTH = "/plot/thrusters", "/plot/fins", "/state", "/health"
SETPOINTS, JOINTS = "/plot/setpoints", "/plot/joints"

_BRIGHT, _DARK = (palette.ORANGE, palette.SKY, palette.GREEN), ((84, 60, 8), (30, 62, 82), (8, 60, 44))
"""Colours of x, y and z: thin bright lines on broad dark ones, so that both are seen where they agree."""
AT_LIMIT = 2
"""Beyond the side of its dead zone: a thruster at the limit on that side, -2 or +2."""

_SIDES = {
    -1: ("reverse", palette.REVERSE),
    0: ("off", palette.IDLE),
    1: ("forward", palette.FORWARD),
    -AT_LIMIT: ("at lower limit", palette.BAD),
    AT_LIMIT: ("at upper limit", palette.BAD),
}
_HEALTH = {0: ("dead or stuck", palette.BAD), 1: ("weak", palette.ORANGE), 2: ("whole", palette.GREEN)}
HEALTH_BOUNDS = (1e-9, 1.0)
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
    return [*_errors(table), *_motion(table), *_forces(table), *_supply(table), *_navigation(table)]


_Table = Mapping[str, Mapping[str, Field]]


def _errors(table: _Table) -> Iterator[Curves]:
    if errors := table.get("path_error"):
        yield _single(errors["cross_track"], "path_error", ERROR, "cross-track", palette.ORANGE)
        yield _single(errors["along"], "path_error", ERROR, "along", palette.SKY)
        yield _single(errors["attitude"], "path_error", ATTITUDE, "attitude", palette.PURPLE)


def _motion(table: _Table) -> Iterator[Curves]:
    """What the vehicle does on what it is asked to do: a thin bright line on a broad dark one."""
    if "reference" in table and "velocity" in table:
        asked, flown = (tuple(f"{axis} {what} [m/s]" for axis in "xyz") for what in ("asked for", "flown"))
        yield Curves("reference", "linear", f"{VELOCITY}/asked", asked, _DARK, width=6.0)
        yield Curves("velocity", "linear", f"{VELOCITY}/flown", flown, _BRIGHT)
    if "target" in table and "pose" in table:
        target = ("z of the target [m]",)
        yield Curves("target", "position", f"{HEIGHT}/target", target, (_DARK[0],), (2,), 6.0)
        yield Curves("pose", "position", f"{HEIGHT}/vehicle", ("z of the vehicle [m]",), (palette.ORANGE,), (2,))
    if "reference" in table and "pose" in table:
        for channel, entity, colour, width in (
            ("reference", "asked for", _DARK[1], 6.0),
            ("pose", "flown", palette.SKY, 1.5),
        ):
            name, place = (f"{entity} [deg]",), f"{HEADING}/{entity.replace(' ', '_')}"
            yield Curves(channel, "quaternion", place, name, (colour,), width=width, derived=headings_deg)
    if "water" in table:
        for field, colours, width in (("current", _DARK, 7.0), ("estimated", _BRIGHT, 1.5)):
            names = tuple(f"{axis} {'true' if field == 'current' else field} [m/s]" for axis in ("x", "y", "z"))
            yield Curves("water", field, f"{WATER}/{field}", names, colours, width=width)


def _forces(table: _Table) -> Iterator[Curves]:
    if "wrench" in table:
        # Allocated is a broad dark band and demanded a thin bright line on it, which leaves the band where they differ.
        for entity, axes, unit, columns in (
            (FORCE, ("Fx", "Fy", "Fz"), "N", (0, 1, 2)),
            (MOMENT, ("Mx", "My", "Mz"), "N m", (3, 4, 5)),
        ):
            for field, colours, width in (("allocated", _DARK, 7.0), ("demanded", _BRIGHT, 1.5)):
                names = tuple(f"{axis} {field} [{unit}]" for axis in axes)
                yield Curves("wrench", field, f"{entity}/{field}", names, colours, columns, width)
    if thrusters := table.get("thrusters"):
        force = thrusters["force"]
        names = tuple(f"{name} [{force.unit}]" for name in force.columns)
        yield Curves("thrusters", "force", THRUSTERS, names, tuple(palette.series(force.width)))
    yield from _fins(table)
    yield from _setpoints(table)
    if joints := table.get("joints", {}).get("position"):
        names = tuple(f"{name} [{unit}]" for name, unit in zip(joints.columns, joints.units, strict=True))
        yield Curves("joints", "position", JOINTS, names, tuple(palette.series(joints.width)))


def _setpoints(table: _Table) -> Iterator[Curves]:
    """What each actuator has reached on what it is told: a thin bright line on a broad dark one."""
    for field, width, share in (("wanted", 6.0, 0.35), ("reached", 1.5, 1.0)):
        if told := table.get("setpoints", {}).get(field):
            names = tuple(f"{name} {field} [{unit}]" for name, unit in zip(told.columns, told.units, strict=True))
            colours = _shaded(told.width, share)
            yield Curves("setpoints", field, f"{SETPOINTS}/{field}", names, colours, width=width)


def _shaded(count: int, share: float) -> tuple[Rgb, ...]:
    series = np.array(palette.series(count))
    return tuple((int(r), int(g), int(b)) for r, g, b in (share * series).tolist())


def _fins(table: _Table) -> Iterator[Curves]:
    """What each fin stands at on what it is to turn to: a thin bright line on a broad dark one."""
    for field, what, width, share in (("deflection_wanted", "wanted", 6.0, 0.35), ("deflection", "had", 1.5, 1.0)):
        if deflection := table.get("fins", {}).get(field):
            names = tuple(f"{name} {what} [deg]" for name in deflection.columns)
            colours = _shaded(deflection.width, share)
            yield Curves("fins", field, f"{FINS}/{what}", names, colours, width=width, derived=np.degrees)


def _supply(table: _Table) -> Iterator[Curves]:
    power = table.get("power", {})
    if "motor" in power:
        drawn = power["motor"]
        names = tuple(f"{name} [{drawn.unit}]" for name in drawn.columns)
        yield Curves("power", "motor", f"{POWER}/motor", names, tuple(palette.series(drawn.width)))
    if "voltage" in power:
        yield _single(power["voltage"], "power", BATTERY, "voltage", palette.SKY)
    if "charge" in power:
        place, name = f"{BATTERY}/charge", ("charge left [%]",)
        yield Curves("power", "charge", place, name, (palette.GREEN,), derived=lambda share: 100 * share)


def _navigation(table: _Table) -> Iterator[Curves]:
    if "navigation_error" in table:
        # A broad dark line for what the estimate thinks it may be off by, a thin bright one for what it is off by.
        sigma = tuple(f"{axis} sigma [m]" for axis in ("x", "y", "z"))
        error = tuple(f"{axis} error [m]" for axis in ("x", "y", "z"))
        yield Curves("navigation", "position_sigma", f"{NAVIGATION}/sigma", sigma, _DARK, width=5.0)
        yield Curves("navigation_error", "position", f"{NAVIGATION}/error", error, _BRIGHT)
    judged = [name for name, fields in table.items() if name.startswith("sensor_") and "surprise" in fields]
    for channel, colour in zip(judged, palette.series(len(judged)), strict=True):
        sensor = channel.removeprefix("sensor_")
        yield Curves(channel, "surprise", f"{SURPRISE}/{sensor}", (f"{sensor} [1]",), (colour,), dots=True)
    if "sensor_depth" in table and "depth" in table["sensor_depth"]:
        yield Curves(
            *("sensor_depth", "depth", f"{HEIGHT}/read", ("read [m]",), (palette.SKY,)),
            derived=np.negative,
            dots=True,
        )
    if "sensor_heading" in table and "heading" in table["sensor_heading"]:
        yield Curves(
            *("sensor_heading", "heading", f"{HEADING}/read", ("read [deg]",), (palette.ORANGE,)),
            derived=np.degrees,
            dots=True,
        )


def headings_deg(quaternions: Values) -> Values:
    """Azimuth of the body's x axis (n, 1) [deg], by (n, 4) wxyz; a gap where it jumps by a whole turn."""
    w, x, y, z = quaternions.T
    heading = np.degrees(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
    heading[1:][np.abs(np.diff(heading)) > 180] = np.nan
    return heading[:, None]


def lanes(channels: Sequence[Channel]) -> list[Lane]:
    """List the state lanes of a run.

    They show which phase of the mission is flown, how the allocation ended, how the vehicle flies and on which side of
    its dead zone each thruster works.
    Beside them stands the health of each thruster, the true one and the one the controller believes in.
    """
    found = []
    for channel in channels:
        for field in channel.fields:
            if (channel.name, field.name) == ("allocation", "subset"):
                found += [
                    Lane(channel.name, field.name, i, f"{LANES}/{name}", _SIDES, thruster=i)
                    for i, name in enumerate(field.columns)
                ]
            elif channel.name == "phase" and field.labels:
                legs = zip(field.labels, palette.series(len(field.labels)), strict=True)
                found.append(Lane(channel.name, field.name, 0, f"{LANES}/phase", dict(enumerate(legs))))
            elif field.labels and not channel.name.startswith("sensor_"):  # what became of readings has its plot
                states = {code: (label, _CODES.get(label, palette.ORANGE)) for code, label in enumerate(field.labels)}
                name = channel.name if field.name == "status" else field.name
                found.append(Lane(channel.name, field.name, 0, f"{LANES}/{name}", states))
            elif channel.name == "health":
                name = "believed" if field.name == "believed" else "true"
                found += [
                    Lane(channel.name, field.name, i, f"{HEALTH}/{thruster}/{name}", _HEALTH, HEALTH_BOUNDS)
                    for i, thruster in enumerate(field.columns)
                ]
    return found


def _single(field: Field, channel: str, parent: str, name: str, colour: Rgb) -> Curves:
    return Curves(channel, field.name, f"{parent}/{field.name}", (f"{name} [{field.unit}]",), (colour,))
