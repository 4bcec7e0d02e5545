"""The plots of a run beside its checks: errors, motion, wrench, thrusters, power, water, navigation, sensors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from cube_sim.recording.batch import Rows
from cube_sim.report import colours
from cube_sim.report.decimation import Values
from cube_sim.report.panel import Curve, Panel, Shade, Zone
from cube_sim.report.subject import Subject
from cube_sim.report.thruster_use import LOWER, UPPER, ThrusterUse
from cube_sim.report.traces import Trace, column, panels, signal_traces

DEAD_ZONE, SATURATION, AT_LIMIT, LOST = "#dfe3e8", "#f3c6b8", "#fbe3da", "#eceef1"
_ANGLES = ("roll", "pitch", "yaw")
_FORCES, _MOMENTS = slice(0, 3), slice(3, 6)

LIKELY = {1: 3.84, 3: 7.81}
"""What chi-square of so many degrees of freedom stays below with a probability of 95 %."""

Subjects = Sequence[Subject]


def depth_panels(subjects: Subjects) -> Iterator[Panel]:
    """Height of the vehicle and of its target."""
    traces = [
        Trace("z", "target", column("target.position", 2), "dashed"),
        Trace("z", "vehicle", column("pose.position", 2)),
    ]
    yield from panels(subjects, "Depth profile: height z", "m", traces, height=360)


def error_panels(subjects: Subjects) -> Iterator[Panel]:
    """Path errors, and the attitude with what was asked for."""
    for signal, title in (
        ("path_error.cross_track", "Cross-track error"),
        ("path_error.along", "Along-track error, ahead of the target"),
    ):
        yield from panels(subjects, title, "m", [Trace("", "", column(signal))], height=120)
    lateral = signal_traces(subjects, "path_error.lateral")
    yield from panels(subjects, "Lateral error", "m", lateral, height=120)
    yield from panels(
        subjects, "Attitude error", "deg", [Trace("", "", _in_degrees(column("path_error.attitude")))], height=120
    )
    asked = [Trace(name, "asked for", _angle("reference.quaternion", i), "dashed") for i, name in enumerate(_ANGLES)]
    actual = [Trace(name, "", _angle("pose.quaternion", i)) for i, name in enumerate(_ANGLES)]
    yield from panels(subjects, "Attitude", "deg", [*asked, *actual])


def velocity_panels(subjects: Subjects) -> Iterator[Panel]:
    """Velocity and rates in body axes, with what was asked for."""
    for field, title, unit in (("linear", "Velocity, body axes", "m/s"), ("angular", "Angular velocity", "rad/s")):
        asked = signal_traces(subjects, f"reference.{field}", "asked for", "dashed")
        yield from panels(subjects, title, unit, [*asked, *signal_traces(subjects, f"velocity.{field}")])


def wrench_panels(subjects: Subjects) -> Iterator[Panel]:
    """Demanded and allocated wrench, what is left between them, and the estimated disturbance."""
    for title, unit, only in (("Force", "N", _FORCES), ("Moment", "N m", _MOMENTS)):
        traces = [
            *signal_traces(subjects, "wrench.demanded", "demanded", "dashed", only),
            *signal_traces(subjects, "wrench.allocated", "allocated", "solid", only),
        ]
        yield from panels(subjects, f"{title}, body axes", unit, traces)
    residual = [Trace("", "", column("allocation.residual"))]
    for panel in panels(subjects, "Residual of the allocation, |A f − F|", "N", residual, height=100):
        # Rounding errors are to look like what they are.
        yield replace(panel, include=(0.0, 0.01))
    for title, unit, only in (("force", "N", _FORCES), ("moment", "N m", _MOMENTS)):
        traces = signal_traces(subjects, "wrench.disturbance", only=only)
        yield from panels(subjects, f"Estimated disturbance, {title}", unit, traces, height=110)


def thruster_panels(subjects: Subjects) -> Iterator[Panel]:
    """A panel for each thruster: force, dead zone, saturation, and where it is at a limit or gone."""
    names = list(dict.fromkeys(use.name for subject in subjects for use in subject.thrusters))
    for name in names:
        having = [(subject, use) for subject in subjects for use in subject.thrusters if use.name == name]
        alone = len(subjects) == 1
        curves = []
        for subject, use in having:
            index = subject.columns("thrusters.force_demanded").index(name)
            produced = column("thrusters.force", index)(subject)
            colour = colours.BLUE if alone else subject.colour
            label = "" if alone else subject.label + " "
            # Thin on broad: both are seen where they agree.
            curves.append(Curve(f"{label}produced", produced[:, 0], produced[:, 1], colour))
            if alone:
                curves.append(Curve("asked for", use.times, use.force, colours.BLACK, "thin"))
        subject, use = having[0]
        shades = [*_lost(subject, name), *(_at_limits(use) if alone else ())]
        others = any(not np.array_equal(each.limits, use.limits) for _, each in having)
        note = f"(bands of {subject.label})" if others else ""
        yield Panel(name, "N", tuple(curves), _bands(use), tuple(shades), height=110, note=note)


def fin_panels(subjects: Subjects) -> Iterator[Panel]:
    """Deflections wanted and had, and the moment that the fins are to make; none of a vehicle without fins."""
    traces = [
        *signal_traces(subjects, "fins.deflection_wanted", "wanted", "dashed"),
        *signal_traces(subjects, "fins.deflection", "had", "solid"),
    ]
    yield from panels(subjects, "Deflection", "rad", traces)
    traces = signal_traces(subjects, "fins.wrench", only=_MOMENTS)
    yield from panels(subjects, "Moment by deflection, body axes", "N m", traces, height=110)


def setpoint_panels(subjects: Subjects) -> Iterator[Panel]:
    """What actuators of the scenario's set-points are told, and where they stand; none where it tells none."""
    subject = next((each for each in subjects if each.has("setpoints.wanted")), None)
    if subject is None:
        return
    fields = subject.run.fields["setpoints.wanted"], subject.run.fields["setpoints.reached"]
    for k, name in enumerate(fields[0].columns):
        only, units = slice(k, k + 1), [field.units[k] for field in fields]
        wanted = signal_traces(subjects, "setpoints.wanted", "wanted", "dashed", only)
        reached = signal_traces(subjects, "setpoints.reached", "reached", "solid", only)
        if units[0] == units[1]:
            yield from panels(subjects, f"Set-point of {name}", units[0], [*wanted, *reached], height=110)
        else:
            yield from panels(subjects, f"Set-point of {name}", units[0], wanted, height=110)
            yield from panels(subjects, f"{name}, reached", units[1], reached, height=110)


def joint_panels(subjects: Subjects) -> Iterator[Panel]:
    """Where each joint stands that the hull carries; none where it carries nothing on a joint."""
    subject = next((each for each in subjects if each.has("joints.position")), None)
    if subject is None:
        return
    field = subject.run.fields["joints.position"]
    for k, (name, unit) in enumerate(zip(field.columns, field.units, strict=True)):
        traces = signal_traces(subjects, "joints.position", only=slice(k, k + 1))
        yield from panels(subjects, f"Joint {name}", unit, traces, height=110)


def power_panels(subjects: Subjects) -> Iterator[Panel]:
    """Power of all motors, what they have drawn, voltage and charge where they change; none of a model without."""
    if not any(np.any(subject.rows("power.motor")[:, 1:] > 0) for subject in subjects):
        return
    yield from panels(subjects, "Electrical power of all motors", "W", [Trace("", "", _total_power)], height=120)
    energy = [Trace("", "", column("power.energy"))]
    yield from panels(subjects, "Energy drawn", "J", energy, height=100)
    for signal, title, unit in (("power.voltage", "Voltage", "V"), ("power.charge", "Charge left", "1")):
        if any(_changes(subject.rows(signal)[:, 1]) for subject in subjects if subject.has(signal)):
            yield from panels(subjects, title, unit, [Trace("", "", column(signal))], height=100)


def water_panels(subjects: Subjects) -> Iterator[Panel]:
    """The current, and the controller's estimate of it."""
    true = signal_traces(subjects, "water.current", "true", "dashed")
    estimated = signal_traces(subjects, "water.estimated", "estimated")
    yield from panels(subjects, "Current, world axes", "m/s", [*true, *estimated])


def navigation_panels(subjects: Subjects) -> Iterator[Panel]:
    """Errors of the estimate, within what it takes for possible, and its biases."""
    for error, sigma, title in (
        ("position", "position_sigma", "Error of the estimated position"),
        ("velocity", "velocity_sigma", "Error of the estimated velocity"),
        ("attitude", "attitude_sigma", "Error of the estimated attitude"),
    ):
        signal = f"navigation_error.{error}"
        for trace in signal_traces(subjects, signal):
            index = "xyz".find(trace.component)
            for panel in panels(subjects, f"{title}, {trace.component}", _unit(subjects, signal), [trace], height=90):
                zones = _sigma_zones(subjects, f"navigation.{sigma}", index) if len(subjects) == 1 else ()
                curves = tuple(Curve("", *_xy(curve), colours.BLUE) for curve in panel.curves)
                yield Panel(panel.title, panel.unit, panel.curves if len(subjects) > 1 else curves, zones, height=90)
    for field, title in (("gyro_bias", "Gyro bias"), ("accelerometer_bias", "Accelerometer bias")):
        traces = signal_traces(subjects, f"navigation_error.{field}")
        unit = _unit(subjects, f"navigation_error.{field}")
        yield from panels(subjects, f"{title}, estimated less true", unit, traces, height=100)


def sensor_panels(subjects: Subjects) -> Iterator[Panel]:
    """What each sensor read, what that said beyond the estimate, and which readings were kept out."""
    names = [f"sensor_{name}" for name in sensor_names(subjects)]
    for name in names:
        channel = next(s for s in subjects if any(c.name == name for c in s.run.recording.channels))
        fields = next(c for c in channel.run.recording.channels if c.name == name).fields
        for field in fields:
            if field.name in ("taken_at", "surprise", "outcome"):
                continue
            shown = f"{name.removeprefix('sensor_')}: {field.name.replace('_', ' ')}"
            yield from _with_outcomes(
                panels(subjects, shown, field.unit, signal_traces(subjects, f"{name}.{field.name}"), height=100),
                subjects,
                name,
                field.name,
            )
        surprise = [Trace("", "", column(f"{name}.surprise"))]
        for panel in panels(subjects, f"{name.removeprefix('sensor_')}: surprise, chi-square", "1", surprise):
            likely = LIKELY.get(channel.run.fields[f"{name}.innovation"].width)
            curves = [*_as_dots(panel.curves)]
            if likely is not None and len(panel.curves[0].times):
                ends = panel.curves[0].times[[0, -1]]
                curves.append(Curve("95 % stay below", ends, np.full(2, likely), colours.BLACK, "dashed"))
            yield Panel(panel.title, panel.unit, tuple(curves), logarithmic=True, height=90)


def sensor_names(subjects: Subjects) -> list[str]:
    """Of the sensors that any run has."""
    found = [channel.name for subject in subjects for channel in subject.run.recording.channels]
    return [name.removeprefix("sensor_") for name in dict.fromkeys(found) if name.startswith("sensor_")]


def _with_outcomes(made: Iterator[Panel], subjects: Subjects, name: str, field: str) -> Iterator[Panel]:
    """Readings as dots, a cross on those that the gate kept out."""
    for panel in made:
        if name == "sensor_imu":
            yield panel
            continue
        curves = list(_as_dots(panel.curves))
        if field == "innovation" and len(subjects) == 1:
            outcome = subjects[0].rows(f"{name}.outcome")
            for curve in panel.curves:
                out = outcome[:, 1] == 1 if len(outcome) == len(curve.times) else np.zeros(len(curve.times), bool)
                if out.any():
                    kept = Curve("kept out", curve.times[out], curve.values[out], colours.BAD, "crosses")
                    curves.append(kept)
        yield Panel(panel.title, panel.unit, tuple(curves), height=panel.height)


def _as_dots(curves: Sequence[Curve]) -> tuple[Curve, ...]:
    return tuple(Curve(curve.label, *_xy(curve), curve.colour, "dots") for curve in curves)


def _xy(curve: Curve) -> tuple[Rows, Rows]:
    return curve.times, curve.values


def _unit(subjects: Subjects, signal: str) -> str:
    return next((subject.unit(signal) for subject in subjects if subject.has(signal)), "")


def _sigma_zones(subjects: Subjects, signal: str, index: int) -> tuple[Zone, ...]:
    rows = subjects[0].rows(signal)
    if not len(rows) or index < 0:
        return ()
    sigma = rows[:, 1 + index]
    return (Zone("± 2 sigma of the filter", rows[:, 0], -2 * sigma, 2 * sigma, "#d5e6f3", steps=False),)


def _bands(use: ThrusterUse) -> tuple[Zone, ...]:
    times, lowest, dead_below, dead_above, highest = use.limits.T
    gone = (lowest >= 0) & (highest <= 0)
    lowest, highest = np.where(gone, np.nan, lowest), np.where(gone, np.nan, highest)
    beyond = np.full(len(times), np.inf)
    return (
        Zone("dead zone", times, dead_below, dead_above, DEAD_ZONE),
        Zone("saturation", times, highest, beyond, SATURATION),
        Zone("", times, -beyond, lowest, SATURATION),
    )


def _at_limits(use: ThrusterUse) -> Iterator[Shade]:
    """Stretches at a limit, those that a reader could not tell apart drawn as one."""
    apart = float(use.times[-1] - use.times[0]) / 400
    merged: list[tuple[float, float]] = []
    for a, b in use.spans(LOWER, UPPER):
        if merged and a - merged[-1][1] < apart:
            merged[-1] = merged[-1][0], b
        else:
            merged.append((a, b))
    return (Shade(a, b, AT_LIMIT) for a, b in merged)


def _lost(subject: Subject, name: str) -> Iterator[Shade]:
    """Where the thruster truly gives nothing."""
    rows = column("health.efficiency", subject.columns("health.efficiency").index(name))(subject)
    if not len(rows):
        return
    gone = np.concatenate([[False], rows[:, 1] == 0, [False]])
    for a, b in np.flatnonzero(np.diff(gone)).reshape(-1, 2).tolist():
        yield Shade(float(rows[a, 0]), float(rows[b - 1, 0]), LOST)


def _changes(values: Values) -> bool:
    values = values[np.isfinite(values)]
    return len(values) > 0 and bool(np.ptp(values) > 0)


def _total_power(subject: Subject) -> Rows:
    rows = subject.rows("power.motor")
    return np.column_stack([rows[:, 0], rows[:, 1:].sum(axis=1)])


def _in_degrees(rows_of: Callable[[Subject], Rows]) -> Callable[[Subject], Rows]:
    return lambda subject: rows_of(subject) * np.array([1.0, np.degrees(1.0)])


def _angle(signal: str, index: int) -> Callable[[Subject], Rows]:
    """Roll, pitch or yaw of R = Rz(yaw) Ry(pitch) Rx(roll) [deg]; a gap where it jumps by a whole turn."""

    def rows(subject: Subject) -> Rows:
        found = subject.rows(signal)
        if found.shape[1] != 5:
            return np.empty((0, 2))
        w, x, y, z = found[:, 1:].T
        if index == 0:
            angle = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
        elif index == 1:
            angle = np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))
        else:
            angle = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        angle = np.degrees(angle)
        # A curve across the whole plot would be read as motion.
        jumps = np.flatnonzero(np.abs(np.diff(angle)) > 180)
        angle[jumps] = np.nan
        return np.column_stack([found[:, 0], angle])

    return rows
