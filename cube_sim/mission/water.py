"""The water of a scenario whose current changes with depth, or within a time, as tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.scenario import Scenario
from cube_sim.scenario.current_block import CurrentProfileBlock
from cube_sim.scenario.event_blocks import CurrentEventBlock
from cube_sim.spatial import Matrix, Vector

Velocities = NDArray[np.float64]


class WaterSchedule(NamedTuple):
    """The current of a whole run on one grid of times and heights, linear between its points.

    A current that changes at once does so between two ticks, without an acceleration: from there on it has a table of
    its own.

    Attributes:
        times: (n_t,) increasing [s].
        heights: (n_z,) increasing [m].
        tables: (n_t,n_z,3) [m/s] each, world axes: the one at the start, and one more for each change at once.
    """

    times: Vector
    heights: Vector
    tables: tuple[Velocities, ...]

    @property
    def rows(self) -> Matrix:
        """(n_t n_z,5) time [s], height [m] and velocity [m/s] of the first table, as the numeric `water:current`."""
        t, z = (grid.ravel() for grid in np.meshgrid(self.times, self.heights, indexing="ij"))
        return np.column_stack([t, z, self.tables[0].reshape(-1, 3)])


def current_events(scenario: Scenario) -> list[CurrentEventBlock]:
    """Those that change the current, in the order of time."""
    return sorted((e for e in scenario.events if isinstance(e, CurrentEventBlock)), key=lambda event: event.at_s)


def water_schedule(scenario: Scenario) -> WaterSchedule | None:
    """The current of a scenario as tables; None where it is one velocity at a time, as `model.opt.wind` has it."""
    events = current_events(scenario)
    profiles = [scenario.current_profile, *(event.profile for event in events)]
    if not any(event.over_s for event in events) and all(profile is None for profile in profiles):
        return None
    depths = {depth for profile in profiles if profile is not None for depth in profile.depths_m}
    heights = np.array(sorted(-depth + 0.0 for depth in depths) or [0.0])
    points = [(0.0, _at_heights(scenario.current_m_s, scenario.current_profile, heights))]
    stretches = [points]
    for event in events:
        target = _at_heights(event.current_m_s, event.profile, heights)
        if event.over_s:
            # What was still to come of an earlier change does not come any more.
            before = _between(points, event.at_s)
            points[:] = [point for point in points if point[0] < event.at_s]
            points += [(event.at_s, before), (event.at_s + event.over_s, target)]
        else:
            points = [(event.at_s, target)]
            stretches.append(points)
    times = np.unique([t for stretch in stretches for t, _ in stretch])
    tables = tuple(np.array([_between(stretch, float(t)) for t in times]) for stretch in stretches)
    return WaterSchedule(times, heights, tables)


def _at_heights(uniform: Sequence[float] | None, profile: CurrentProfileBlock | None, heights: Vector) -> Matrix:
    """(n_z,3) velocities [m/s] at heights (n_z,) [m]."""
    if profile is None:
        return np.tile(np.asarray(uniform, dtype=float), (len(heights), 1))
    depths, velocities = np.array(profile.depths_m), np.array(profile.velocities_m_s)
    return np.column_stack([np.interp(-heights, depths, velocities[:, i]) for i in range(3)])


def _between(points: Sequence[tuple[float, Matrix]], t: float) -> Matrix:
    """Of points (time [s], (n_z,3) velocities) in the order of time, what lies between them at t."""
    times = np.array([time for time, _ in points])
    k = int(np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(points) - 1))
    if t <= times[k] or k + 1 == len(points):
        return points[k][1]
    share = (t - times[k]) / (times[k + 1] - times[k])
    return points[k][1] + share * (points[k + 1][1] - points[k][1])


def initial_currents(scenario: Scenario) -> Matrix:
    """(n,3) velocities of the water at the start [m/s], one for each depth that is given."""
    profile = scenario.current_profile
    return np.array([scenario.current_m_s] if profile is None else profile.velocities_m_s)


def told_currents(scenario: Scenario) -> Matrix:
    """(n,3) velocities of the water that a scenario tells of, at any time and depth [m/s]."""
    profiles = ((event.current_m_s, event.profile) for event in current_events(scenario))
    later = [np.array([one] if profile is None else profile.velocities_m_s) for one, profile in profiles]
    return np.concatenate([initial_currents(scenario), *later])


def fastest_current(scenario: Scenario) -> float:
    """The largest speed of the water that a scenario tells of, at any time and depth [m/s]."""
    return float(np.max(np.linalg.norm(told_currents(scenario), axis=1)))
