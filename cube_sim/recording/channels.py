"""The channel table: everything a run records, declared once, with widths and units.

The whole table is written into each recording. Names are what checks and readers rely on; a changed text changes the
bytes of every recording.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

XYZ = ("x", "y", "z")
WXYZ = ("w", "x", "y", "z")
WRENCH = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
LIMITS = ("F_max-", "F_DZ-", "F_DZ+", "F_max+")

TICK_HZ = 50.0
ON_CHANGE = 0.0


@dataclass(frozen=True)
class Field:
    """One quantity of a channel.

    Attributes:
        name: key of the quantity within its channel.
        width: how many numbers it has.
        unit: SI unit, "1" for a pure number; one unit for all its numbers, or two where a wrench needs them.
        doc: what it is, in one line, with the frame it is expressed in.
        columns: a name for each of its numbers, or () when they have none.
        labels: what the values 0, 1, 2 ... mean when the quantity is a code, or ().
    """

    name: str
    width: int
    unit: str
    doc: str
    columns: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a field whose names do not fit its width."""
        if self.width < 1:
            raise ValueError(f"field {self.name!r} has width {self.width}; the smallest is 1")
        if self.columns and len(self.columns) != self.width:
            raise ValueError(f"field {self.name!r} has width {self.width} but {len(self.columns)} column names")

    @property
    def units(self) -> tuple[str, ...]:
        """The unit of each of its numbers."""
        units = self.unit.split(", ")
        if len(units) != self.width:  # one for all, or one for each half: forces and torques
            units = [units[0]] * (self.width // 2) + [units[-1]] * (self.width - self.width // 2)
        return tuple(units)

    @property
    def is_single_number(self) -> bool:
        """Whether it is one number by its nature, not a list that happens to have one entry (one thruster)."""
        return self.width == 1 and not self.columns


@dataclass(frozen=True)
class Channel:
    """A row of numbers that is recorded together.

    Attributes:
        name: topic of the channel.
        fields: its quantities, in the order in which a row holds them.
        rate: rows per simulated second, or ``ON_CHANGE`` when a row comes only with a change.
    """

    name: str
    fields: tuple[Field, ...]
    rate: float = TICK_HZ

    @cached_property
    def width(self) -> int:
        """How many numbers a row holds, the time not counted."""
        return sum(field.width for field in self.fields)

    @cached_property
    def every_tick(self) -> bool:
        """Whether there is a row at each control period: not of what tells a change, nor of a sensor's readings."""
        return self.rate != ON_CHANGE and all(field.name != "taken_at" for field in self.fields)

    @cached_property
    def columns(self) -> tuple[slice, ...]:
        """Where each field lies in a row whose column 0 is the time."""
        ends = [1]
        for field in self.fields:
            ends.append(ends[-1] + field.width)
        return tuple(slice(a, b) for a, b in pairwise(ends))


def units_of(channels: Iterable[Channel]) -> dict[str, tuple[str, ...]]:
    """The unit of each number of every signal, by "channel.field"."""
    return {f"{channel.name}.{field.name}": field.units for channel in channels for field in channel.fields}


def held_signals(channels: Iterable[Channel]) -> frozenset[str]:
    """The signals of which a row holds until the next, as "channel.field"."""
    return frozenset(f"{c.name}.{field.name}" for c in channels if c.rate == ON_CHANGE for field in c.fields)


SUPPLY = ("motor", "energy", "voltage", "charge")
"""Fields of the channel `power`, in their order."""


DISTURBANCE = Channel(
    "disturbance",
    (
        Field("force", 3, "N", "true force of what pushes the vehicle, body axes", XYZ),
        Field("torque", 3, "N m", "its true torque about the body origin, body axes", XYZ),
    ),
)
"""Recorded where a scenario has `force` events."""
_NO_POWER = (
    "the model does not state the power of each thruster (NAME:thruster_power, or NAME:propeller_efficiency of one that"
    " is a propeller in its inflow)"
)
WHY_NOT_SUPPLIED = {
    "motor": _NO_POWER,
    "energy": _NO_POWER,
    "voltage": "the model does not state one voltage for all thrusters (NAME:thruster_voltage)",
    "charge": "the scenario has no battery",
}
"""Why a quantity of `SUPPLY` is not recorded."""


def why_absent(signal: str) -> str:
    """Why a run may not have recorded a signal that others do; "" where no run does."""
    channel, _, quantity = signal.partition(".")
    if channel == "power" and quantity in SUPPLY:
        return WHY_NOT_SUPPLIED[quantity]
    if channel == "fins":
        return "the vehicle has no fin that a servo turns"
    if channel == "fin_health":
        return "the scenario has no event of kind fins"
    if channel == "setpoints":
        return "the scenario has no setpoints, and no event of kind setpoint"
    if channel == "joints":
        return "the vehicle carries nothing on a joint"
    if channel == DISTURBANCE.name:
        return "the scenario has no event of kind force"
    if channel == "phase":
        return "no phase of the scenario has a time limit" if quantity == "late" else "the scenario has no phases"
    if channel in ("navigation", "navigation_error"):
        return "the scenario has no navigation block"
    sensor = channel.removeprefix("sensor_")
    return f"the scenario has no sensor {sensor!r}" if sensor != channel else ""


def _power(thrusters: tuple[str, ...], known: tuple[str, ...]) -> tuple[Channel, ...]:
    fields = (
        Field("motor", len(thrusters), "W", "electrical power of each motor", thrusters),
        Field("energy", 1, "J", "what the motors have drawn since the start"),
        Field("voltage", 1, "V", "what feeds the motors"),
        Field("charge", 1, "1", "share of the battery's capacity left"),
    )
    recorded = tuple(field for field in fields if field.name in known)
    return (Channel("power", recorded),) if recorded else ()


def _fins(fins: tuple[str, ...]) -> tuple[Channel, ...]:
    if not fins:
        return ()
    made = "what the fins are to make by these deflections, a part of wrench.allocated, body axes"
    fields = (
        Field("deflection_wanted", len(fins), "rad", "angle each fin is to turn to", fins),
        Field("deflection", len(fins), "rad", "angle each fin stands at", fins),
        Field("wrench", 6, "N, N m", made, WRENCH),
    )
    return (Channel("fins", fields),)


def _fin_health(fins: tuple[str, ...]) -> tuple[Channel, ...]:
    if not fins:
        return ()
    codes = "0 whole, 1 slow, 2 short of travel, 3 jammed, 4 loose"
    fields = (
        Field("state", len(fins), "1", f"what is truly wrong with each fin: {codes}", fins),
        Field("believed", len(fins), "1", "the same as the controller believes it", fins),
    )
    return (Channel("fin_health", fields, ON_CHANGE),)


def _setpoints(names: tuple[str, ...], units: tuple[tuple[str, str], ...]) -> tuple[Channel, ...]:
    if not names:
        return ()
    wanted, reached = (", ".join(unit) for unit in zip(*units, strict=True))
    fields = (
        Field("wanted", len(names), wanted, "what each actuator of the scenario's set-points is told", names),
        Field("reached", len(names), reached, "where each stands: its joint, or the volume of ballast", names),
    )
    return (Channel("setpoints", fields),)


def _joints(positions: tuple[tuple[str, str], ...], velocities: tuple[tuple[str, str], ...]) -> tuple[Channel, ...]:
    if not positions:
        return ()
    names, units = zip(*positions, strict=True)
    stands = "where each joint of what the hull carries stands; a ball by its quaternion"
    rates, rate_units = zip(*velocities, strict=True)
    fields = (
        Field("position", len(names), ", ".join(units), stands, names),
        Field("velocity", len(rates), ", ".join(rate_units), "how fast each of them moves", rates),
    )
    return (Channel("joints", fields),)


@lru_cache(maxsize=16)  # of many flights it is the same
def _phase(names: tuple[str, ...], timed: bool) -> tuple[Channel, ...]:
    flown = Field("index", 1, "1", "which phase is flown, a code", (), names)
    late = Field("late", 1, "1", "how many phases before have run out of time")
    return (Channel("phase", (flown, late) if timed else (flown,), ON_CHANGE),) if names else ()


@lru_cache(maxsize=16)  # of many flights it is the same
def channel_table(
    thrusters: tuple[str, ...],
    path_points: int,
    allocation_status: tuple[str, ...] = (),
    authority: tuple[str, ...] = (),
    supply: tuple[str, ...] = SUPPLY,
    pushed: bool = False,
    phases: tuple[str, ...] = (),
    timed: bool = False,
    fins: tuple[str, ...] = (),
    setpoints: tuple[str, ...] = (),
    setpoint_units: tuple[tuple[str, str], ...] = (),
    failing: tuple[str, ...] = (),
    joint_positions: tuple[tuple[str, str], ...] = (),
    joint_velocities: tuple[tuple[str, str], ...] = (),
) -> tuple[Channel, ...]:
    """Declare what a run of a vehicle with these thrusters records.

    Args:
        thrusters: names of the m thrusters, in the order of the columns of A.
        path_points: n, the points of the polyline by which the path is displayed.
        allocation_status: what the status codes 0, 1, 2 ... of the allocation mean.
        authority: what the codes of the vehicle's authority mean.
        supply: which of `SUPPLY` are known; the others are not recorded.
        pushed: whether something pushes the vehicle.
        phases: names of the phases, if there are any.
        timed: whether any of them has a time limit.
        fins: names of the fins that servos turn, if there are any.
        setpoints: names of the actuators that the scenario commands, if there are any.
        setpoint_units: of each, that of its command and that of what it has reached.
        failing: names of the fins again, where the scenario has any of them fail.
        joint_positions: name and unit of each number of position of what the hull carries on joints, if it does.
        joint_velocities: the same of velocity.

    Returns:
        The channels in the order in which they are written.
    """
    m = len(thrusters)
    and_fins = ", with what fins make" if fins else ""
    with_fins = " + fins.wrench" if fins else ""
    thruster_wrench = tuple(f"{component}/{thruster}" for component in WRENCH for thruster in thrusters)
    thruster_limits = tuple(f"{thruster}/{limit}" for thruster in thrusters for limit in LIMITS)
    path_columns = tuple(f"{i}/{axis}" for i in range(path_points) for axis in XYZ)
    return (
        Channel(
            "actuation",
            (
                Field("matrix", 6 * m, "N/N, N m/N", "A of F_B = A f as believed, row-major (6, m)", thruster_wrench),
                Field(
                    "limits", 4 * m, "N", "dead zone and saturation of each motor as believed, (m, 4)", thruster_limits
                ),
            ),
            ON_CHANGE,
        ),
        Channel(
            "path",
            (Field("points", 3 * path_points, "m", "polyline of the whole path, world axes", path_columns),),
            ON_CHANGE,
        ),
        Channel(
            "pose",
            (
                Field("position", 3, "m", "p_WB, body origin in world axes", XYZ),
                Field("quaternion", 4, "1", "q_WB, body to world", WXYZ),
            ),
        ),
        Channel(
            "velocity",
            (
                Field("linear", 3, "m/s", "velocity of the body origin over ground, body axes", XYZ),
                Field("angular", 3, "rad/s", "angular velocity, body axes", XYZ),
            ),
        ),
        Channel(
            "target",
            (
                Field("arc_length", 1, "m", "where the virtual target is on the path"),
                Field("remaining", 1, "m", "arc length from the virtual target to the end of the path"),
                Field("position", 3, "m", "virtual target, world axes", XYZ),
                Field("quaternion", 4, "1", "path frame [T N1 N2] to world at the virtual target", WXYZ),
            ),
        ),
        Channel(
            "path_error",
            (
                Field("along", 1, "m", "s1, vehicle ahead of the virtual target along the tangent"),
                Field("lateral", 2, "m", "y1 and z1, offset along the path's normals N1 and N2", ("y1", "z1")),
                Field(
                    "cross_track",
                    1,
                    "m",
                    "distance across the path, sqrt(y1^2 + z1^2); at a point, `along` comes on top",
                ),
                Field("attitude", 1, "rad", "angle of the rotation between desired and actual attitude"),
            ),
        ),
        Channel(
            "reference",
            (
                Field("linear", 3, "m/s", "desired velocity of the body origin, body axes", XYZ),
                Field("angular", 3, "rad/s", "desired angular velocity, body axes", XYZ),
                Field("quaternion", 4, "1", "desired attitude, body to world", WXYZ),
            ),
        ),
        Channel(
            "wrench",
            (
                Field("demanded", 6, "N, N m", "F_B asked for by the control law, body axes", WRENCH),
                Field("allocated", 6, "N, N m", f"A f of the allocated forces{and_fins}, body axes", WRENCH),
                Field("disturbance", 6, "N, N m", "estimated disturbance, body axes", WRENCH),
            ),
        ),
        Channel(
            "allocation",
            (
                Field("residual", 1, "N", f"norm of A f{with_fins} - F_B"),
                Field("cost", 1, "N^2", "f' f, what the allocation minimises"),
                Field("status", 1, "1", "how the allocation ended, a code", (), allocation_status),
                Field("subset", m, "1", "side of the dead zone each motor works on, -1, 0 or +1", thrusters),
            ),
        ),
        Channel(
            "thrusters",
            (
                Field("force_demanded", m, "N", "allocated force of each motor", thrusters),
                Field("command", m, "1", "command sent to each motor, -1 to 1", thrusters),
                Field("force", m, "N", "force each motor produces, after its lag and characteristic", thrusters),
            ),
        ),
        *_power(thrusters, supply),
        Channel(
            "health",
            (
                Field("efficiency", m, "1", "share of its force each motor truly gives, 0 dead or stuck", thrusters),
                Field("believed", m, "1", "the same as the controller believes it", thrusters),
                Field("authority", 1, "1", "how the vehicle flies, a code", (), authority),
            ),
        ),
        Channel(
            "water",
            (
                Field("current", 3, "m/s", "velocity of the water at the vehicle, world axes", XYZ),
                Field("estimated", 3, "m/s", "the same as the controller estimates it", XYZ),
            ),
        ),
        *((DISTURBANCE,) if pushed else ()),
        *_fins(fins),
        *_setpoints(setpoints, setpoint_units),
        *_joints(joint_positions, joint_velocities),
        *_fin_health(failing),
        *_phase(phases, timed),
    )
