"""What becomes of a hull on a level line that has to point its thrust, and of which its trims leave a doubt.

Where no trim next to the course is held by the water, steered well and come to from rest, small motions about it decide
little: the hull may find another, or swing for ever. So it is flown, by the law that a run would take, as it stands.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cube_sim.commands.stuck_flight import DEEP_M, straight_ahead
from cube_sim.control.authority import Capability
from cube_sim.control.course_trim import CourseTrims
from cube_sim.control.loop_times import USUAL_PERIOD_S, LoopTimes, mean_delay
from cube_sim.errors import ModelError, ScenarioError
from cube_sim.spatial import Matrix
from cube_sim.vehicle.vehicle import Vehicle

BESIDE_M, WITHIN_M = 0.5, 0.05
"""How far beside its line it begins, and within how much of it it is to end, RMS."""
JUDGED_S, LEAST_S, LENGTH_M, MOST_TIMES = 30.0, 100.0, 20.0, 10
"""It is judged for so long, once it has been under way for a time and a length, and again so often (choices)."""
COMES_NEARER = 0.8
"""It is judged again where it is within this share of how far off it was the time before (a choice)."""
LEAST_ADVANCE = 0.5
"""Share of the speed by which it is to advance at least."""
SLOWER = (0.5, 0.25)
"""Shares of the speed that are tried where it does not follow at all of it."""


def is_doubtful(left: Capability, vehicle: Vehicle, speed_m_s: float) -> bool:
    """Whether the trims of a level course do not say that a hull follows it.

    Args:
        left: what the thrusters can still do; it points their thrust.
        vehicle: the hull.
        speed_m_s: of the course.
    """
    pointing = LoopTimes.behind(mean_delay(vehicle.lag_s, USUAL_PERIOD_S), pointing=True).pointing
    trims = CourseTrims.of(left, vehicle.dynamics, speed_m_s, 0.0, pointing)
    return trims is not None and not trims.is_sure(np.eye(3))


def leaves_course(model: Path, lost: Sequence[str], speed_m_s: float) -> str | None:
    """Words for a level line at that speed [m/s] on which the vehicle does not stay; None where it does.

    None, too, of a model that no scenario can fly as it stands.

    Args:
        model: an MJCF file with one hull.
        lost: names of its dead thrusters.
        speed_m_s: of the line, through still water.
    """
    try:
        off_m = flown_off_m(model, lost, speed_m_s)
    except (ModelError, ScenarioError):
        return None
    if off_m <= WITHIN_M:
        return None
    beside = f"it stays {off_m:.2g} m beside it" if np.isfinite(off_m) else "it does not keep to it"
    said = f"flown on a level line at {speed_m_s:.2g} m/s, {beside}"
    for share in SLOWER:
        if flown_off_m(model, lost, share * speed_m_s) <= WITHIN_M:
            return f"{said}; at {share * speed_m_s:.2g} m/s it follows"
    return said


def flown_off_m(model: Path, lost: Sequence[str], speed_m_s: float) -> float:
    """How far beside a level line it ends, RMS [m]; infinite where it gives it up or does not advance along it.

    One that comes nearer is waited for: a slow loop comes to its line as slowly.
    """
    from cube_sim.flight import Flight

    from_s, before_m = LEAST_S + LENGTH_M / speed_m_s, np.inf
    flight = Flight(_line(model, lost, speed_m_s, from_s + MOST_TIMES * JUDGED_S))
    flight.fly(round(from_s / USUAL_PERIOD_S))
    for _ in range(MOST_TIMES):
        if flight.over:
            return float("inf")
        flight.fly(round(JUDGED_S / USUAL_PERIOD_S))
        off_m = _late_off_m(flight.signals, from_s, speed_m_s)
        if off_m <= WITHIN_M or not off_m <= COMES_NEARER * before_m:
            return off_m
        from_s, before_m = from_s + JUDGED_S, off_m
    return before_m


def _late_off_m(signals: Mapping[str, Matrix], from_s: float, speed_m_s: float) -> float:
    """How far beside its line a hull is from a time on, RMS [m]; infinite where it does not advance along it."""
    error, along = signals["path_error.cross_track"], signals["target.arc_length"]
    error, along = error[error[:, 0] >= from_s], along[along[:, 0] >= from_s]
    if len(along) < 2 or along[-1, 1] - along[0, 1] < LEAST_ADVANCE * speed_m_s * JUDGED_S:
        return float("inf")
    return float(np.sqrt(np.mean(error[:, 1] ** 2)))


def _line(model: Path, lost: Sequence[str], speed_m_s: float, duration_s: float) -> dict[str, Any]:
    """The scenario."""
    events = [{"kind": "thrusters", "at_s": 0.0, "thrusters": list(lost), "state": "dead"}] if lost else []
    return straight_ahead(model.resolve(), speed_m_s, None) | {
        "duration_s": float(round(duration_s)),
        "path": {"type": "line", "start_m": [0, 0, DEEP_M], "end_m": [2.0 * speed_m_s * duration_s, 0, DEEP_M]},
        "initial": {"position_m": [0, BESIDE_M, DEEP_M], "attitude_deg": [0, 0, 0]},
        "control": {"faults": "told"},
        "events": events,
        "stop": [{"kind": "given_up"}],
    }
