"""Refusals before the run: what a scenario asks for that its vehicle, or any run, cannot give."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from cube_sim.baseline import baseline_signal
from cube_sim.errors import RecordingError, ScenarioError
from cube_sim.guidance.path import Path
from cube_sim.mission.channels import why_unknown
from cube_sim.mission.sensor_faults import impossible_faults
from cube_sim.mission.stopping import impossible_stops
from cube_sim.nearest import among, counted
from cube_sim.recording.channels import ON_CHANGE, SUPPLY, Channel, units_of
from cube_sim.scenario import Loaded, Scenario
from cube_sim.scenario.check_blocks import BaselineCheckBlock
from cube_sim.scenario.check_windows import statistics_of, windows_of
from cube_sim.scenario.event_blocks import ThrusterEventBlock
from cube_sim.scenario.fin_event_block import FinEventBlock
from cube_sim.scenario.named_signals import signal_mistakes, unit_mistakes
from cube_sim.vehicle.vehicle import Vehicle

SAME_DEPTH_M = 0.05
"""By how much a vehicle that cannot change depth may start above or below its path."""

SAME_DEG = 1e-3
"""By so much an angle may be beyond a fin's travel, which files have in radians."""


def require_signals(loaded: Loaded, vehicle: Vehicle, channels: tuple[Channel, ...]) -> None:
    """Refuse checks of signals that no run records, or no run of this vehicle."""
    widths = {f"{channel.name}.{field.name}": field.width for channel in channels for field in channel.fields}

    def why_absent(signal: str) -> str:
        channel, _, quantity = signal.partition(".")
        supplied = channel == "power" and quantity in SUPPLY
        return why_unknown(quantity, loaded.scenario, vehicle) if supplied else ""

    unknown = [
        *signal_mistakes(loaded.scenario.checks, widths, why_absent),
        *unit_mistakes(loaded.scenario.checks, units_of(channels)),
        *impossible_stops(loaded.scenario, channels),
    ]
    found = unknown or [
        *_other_times(loaded.scenario, channels),
        *_too_few_rows(loaded.scenario, channels),
        *_no_baselines(loaded.scenario, channels),
    ]
    mistakes = [loaded.mistake(*each) for each in found]
    if mistakes:
        raise ScenarioError(mistakes)


def _too_few_rows(scenario: Scenario, channels: tuple[Channel, ...]) -> Iterator[tuple[str, str]]:
    """Checks of windows that cannot hold the samples their statistic takes; what comes on change needs none."""
    channel_of = {f"{channel.name}.{field.name}": channel for channel in channels for field in channel.fields}
    period = scenario.control_period_s
    for i, check in enumerate(scenario.checks):
        for asked, window, place, key in statistics_of(check, scenario.events):
            channel, signal = channel_of[asked.signal], asked.signal
            if channel.rate == ON_CHANGE:
                continue
            start, end = window.within(scenario.duration_s)
            if channel.every_tick:
                times = np.arange(scenario.ticks + 1) * period
                count, apart = int(((times >= start) & (times <= end)).sum()), period
            else:  # nobody knows when a reading arrives
                count, apart = int((end - start) * channel.rate) + 1, 1.0 / channel.rate
            needed = 1 if asked.statistic == "final" else 2
            if count < needed:
                holds = ("" if channel.every_tick else "at most ") + ("one sample" if count else "no sample")
                text = f"the window {start:g} s to {end:g} s holds {holds} of {signal}, which has one every {apart:g} s"
                where = f"checks.{i}.{place}.{key}" if place else f"checks.{i}.{key}"
                yield where, f"{text}; {asked.statistic} needs {needed}"


def _other_times(scenario: Scenario, channels: tuple[Channel, ...]) -> Iterator[tuple[str, str]]:
    """Signals that are to be taken away from others, and have no rows at the same times."""
    channel_of = {f"{channel.name}.{field.name}": channel for channel in channels for field in channel.fields}
    for i, check in enumerate(scenario.checks):
        for signal, _, place, key, beside in check.named_signals:
            if not beside:
                continue
            one, other = channel_of[signal], channel_of[beside]
            if one.name != other.name and not (one.every_tick and other.every_tick):
                where = f"checks.{i}.{place}.{key}" if place else f"checks.{i}.{key}"
                yield where, f"{signal} and {beside} have no rows at the same times: one of them is not of every tick"


def _no_baselines(scenario: Scenario, channels: tuple[Channel, ...]) -> Iterator[tuple[str, str]]:
    """Checks of an earlier run that does not have what they compare."""
    of_signal = {f"{c.name}.{field.name}": (c, field) for c in channels for field in c.fields}
    for i, check in enumerate(scenario.checks):
        if not isinstance(check, BaselineCheckBlock):
            continue
        channel, field = of_signal[check.signal]
        whole, place = check.asked is None, f"checks.{i}.record"
        try:
            rows, unit = baseline_signal(check.record, check.signal)
        except RecordingError as error:
            yield place, str(error)
            continue
        if rows.shape[1] != 1 + field.width or unit not in ("", field.unit):
            there = f"{rows.shape[1] - 1} columns in {unit or 'a unit it does not say'}"
            yield place, f"{check.signal} has {there} there, {field.width} in {field.unit} here"
            continue
        _, end = windows_of(check, scenario.events)[0].within(scenario.duration_s)
        if channel.rate == ON_CHANGE:
            continue
        step = float(np.median(np.diff(rows[:, 0]))) if len(rows) > 1 else np.inf
        if whole and not channel.every_tick:
            text = f"readings of {channel.name} come at times of their own: compare a statistic of {check.signal}"
            yield f"checks.{i}.signal", text
        elif whole and not abs(step - scenario.control_period_s) <= 1e-6:
            text = f"{check.signal} has a row every {step:g} s there, every {scenario.control_period_s:g} s here"
            yield place, f"{text}: compare a statistic"
        elif rows[-1, 0] + 1.5 * step < end:
            yield place, f"{check.signal} ends at {rows[-1, 0]:g} s there, the window at {end:g} s"


def require_a_value_per_thruster(loaded: Loaded, vehicle: Vehicle) -> None:
    """Refuse lists that do not have an entry for each thruster."""
    allocation, names, mistakes = loaded.scenario.allocation, vehicle.thrusters.names, []
    lists = {
        "allocation.target_N": allocation.target_N,
        "allocation.thruster_weights": allocation.thruster_weights,
        "telemetry.thruster_gains": loaded.scenario.telemetry.thruster_gains,
    }
    for key, values in lists.items():
        if values is not None and len(values) != len(names):
            text = f"{counted(len(values), 'number')} for {len(names)} thrusters; the model has {', '.join(names)}"
            mistakes.append(loaded.mistake(key, text))
    if mistakes:
        raise ScenarioError(mistakes)


def too_slow_period(loaded: Loaded, times: Mapping[str, float]) -> list[str]:
    """Mistakes, at most one: a control period longer than the shortest time by which its loops are given.

    A loop that removes a share 1 / T of its error per second removes more than all of it in a longer period.

    Args:
        loaded: the scenario.
        times: dotted path of the value that gives a loop's time -> that time [s].
    """
    period, shortest = loaded.scenario.control_period_s, min(times, key=lambda key: times[key])
    if period <= times[shortest]:
        return []
    text = f"{period:g} s is longer than the {times[shortest]:g} s that {shortest} asks for: the loop would be unstable"
    return [loaded.mistake("control_period_s", text, because=shortest)]


def wrong_depth(loaded: Loaded, path: Path, height: float | None = None) -> list[str]:
    """Mistakes, at most one: a vehicle that cannot change its depth is at another depth than its path.

    Args:
        loaded: the scenario.
        path: to be flown.
        height: at which it is [m]; None for where it starts.
    """
    if height is not None:
        there = float(path.at(0.0).position[2])
        text = f"lies at z = {there:g} m, the vehicle stays at z = {height:g} m: nothing it is asked for changes depth"
        return [] if abs(height - there) <= SAME_DEPTH_M else [loaded.mistake("path", text)]
    at, there = loaded.scenario.initial.position_m[2], float(path.at(0.0).position[2])
    if abs(at - there) <= SAME_DEPTH_M:
        return []
    text = (
        f"starts at z = {at:g} m, the path lies at z = {there:g} m, and nothing the controller asks for changes depth"
    )
    return [loaded.mistake("initial.position_m", text, because="path")]


def require_possible_events(loaded: Loaded, vehicle: Vehicle) -> None:
    """Refuse events that cannot happen to this vehicle."""
    thrusters, duration = vehicle.thrusters, loaded.scenario.duration_s
    mistakes = [loaded.mistake(*each) for each in impossible_faults(loaded.scenario)]
    for i, event in enumerate(loaded.scenario.events):
        if event.at_s >= duration:
            text = f"{event.at_s:g} s is not before the end of the run at {duration:g} s"
            mistakes.append(loaded.mistake(f"events.{i}.at_s", text, because="duration_s"))
        if isinstance(event, FinEventBlock):
            mistakes += [loaded.mistake(*each) for each in _impossible_fins(i, event, vehicle)]
        if not isinstance(event, ThrusterEventBlock):
            continue
        for j, name in enumerate(event.thrusters):
            if name not in thrusters.names:
                text = f"no thruster '{name}'; the model has {among(name, thrusters.names)}"
                if vehicle.fins is not None and name in vehicle.fins.names:
                    text += f"; '{name}' turns a fin, which fails by an event of kind: fins"
                mistakes.append(loaded.mistake(f"events.{i}.thrusters.{j}", text))
            elif event.force_N is not None:
                low, _, _, high = thrusters.limits[thrusters.names.index(name)]
                if not low <= event.force_N <= high:
                    text = f"{name} cannot be stuck at {event.force_N:g} N; it gives {low:g} to {high:g} N"
                    mistakes.append(loaded.mistake(f"events.{i}.force_N", text))
    if mistakes:
        raise ScenarioError(mistakes)


def _impossible_fins(i: int, event: FinEventBlock, vehicle: Vehicle) -> Iterator[tuple[str, str]]:
    """What of an event, the i-th, cannot happen to the fins of a vehicle: dotted path and words."""
    fins = vehicle.fins
    for j, name in enumerate(event.fins):
        if fins is None or name not in fins.names:
            there = "no fin that a servo turns" if fins is None else among(name, fins.names)
            text = f"no fin '{name}'; the model has {there}"
            if name in vehicle.thrusters.names:
                text += f"; '{name}' is a thruster, which fails by an event of kind: thrusters"
            yield f"events.{i}.fins.{j}", text
            continue
        low, high = np.degrees(fins.travel[fins.names.index(name)]).tolist()
        asked = [] if event.angle_deg is None else [("angle_deg", event.angle_deg)]
        asked += [(f"travel_deg.{end}", angle) for end, angle in enumerate(event.travel_deg or ())]
        for key, angle in asked:
            if not low - SAME_DEG <= angle <= high + SAME_DEG:
                yield f"events.{i}.{key}", f"{name} turns from {low:.4g} to {high:.4g} deg, not to {angle:g} deg"
