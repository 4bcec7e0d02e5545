"""The best attitude found for a course: held within the limits, no motion loose, the longest side step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from cube_sim.actuation.attainable.attainable_set import Attainable, holding_forces
from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.actuation.path_following.best_attitude import best_attitudes
from cube_sim.actuation.path_following.linear_motion import linearise
from cube_sim.actuation.path_following.requirements import Mission
from cube_sim.actuation.path_following.side_step import Bounds, side_step
from cube_sim.actuation.path_following.trim import Course, courses
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.axes import SPATIAL

_SWING = 0.1
"""Amplitude of the motions about a course, in courses' speeds and speeds per length, at which drag damps (a choice)."""

FURTHEST = 2.0
"""Side steps are looked for up to this many times the one asked for; further, small motions say little (a choice)."""

_QUICKEST = 4.0
"""The velocity may change by this many times the mean speed of the side step asked for, or by that of the course."""

_HELD = 1.0 - 1e-9


@dataclass(frozen=True)
class SteeredCourse:
    """The best way found to keep one course.

    Attributes:
        course: velocity, attitude, forces; the latter of least norm, or of least share of the limits where that
            exceeds them.
        share: how many times the wrench that keeps it fits into the thrusters' maxima; infinite without limits.
        loose: motions neither steered to both sides nor damped.
        side_step_m: displacement made good within the mission's horizon, in the worst direction across the course,
            looked for up to twice the one asked for; infinite when no limits are known.
    """

    course: Course
    share: float
    loose: tuple[str, ...]
    side_step_m: float

    @property
    def within_limits(self) -> bool:
        """Whether the thrusters can keep the course."""
        return self.share >= _HELD


def steered_course(
    hull: Dynamics,
    actuation: Subspaces,
    allowed: AllowedForces | None,
    reach: Attainable | None,
    asked: Mission,
    inclination_rad: float,
) -> SteeredCourse | None:
    """The best way to keep one course; without any within the limits the one nearest to it.

    Args:
        hull: the body.
        actuation: of the thrusters that are left.
        allowed: their forces; without them limits are not looked at.
        reach: what they attain.
        asked: speed, side step and its bounds.
        inclination_rad: of the course.

    Returns:
        None when no attitude is found in which the wrench is in range(A). The share of a course that exceeds the
        limits is the largest of all attitudes.
    """
    found: list[SteeredCourse] = []
    for attempt in _attempts(hull, actuation, reach, asked, inclination_rad):
        for course in attempt:
            share = float("inf") if reach is None else float(reach.share(course.wrench[None, :])[0])
            found.append(SteeredCourse(course, share, (), 0.0))
        if any(candidate.within_limits for candidate in found):
            break
    held = [candidate for candidate in found if candidate.within_limits]
    if not held:
        return max(found, key=lambda candidate: candidate.share, default=None)
    held.sort(key=lambda candidate: (round(np.degrees(candidate.course.tilt_rad)), -candidate.share))
    best: SteeredCourse | None = None
    for candidate in held:
        steered = _steered(candidate, hull, actuation, allowed, asked, best)
        if best is None or _merit(steered) > _merit(best):
            best = steered
        if not best.loose and best.side_step_m >= FURTHEST * asked.side_step_m:
            break
    return best


def _attempts(
    hull: Dynamics, actuation: Subspaces, reach: Attainable | None, asked: Mission, inclination_rad: float
) -> Iterator[tuple[Course, ...]]:
    """Attitudes to try: near level, deck along the course, one thruster not needed; last the best of all."""
    yield courses(hull, actuation, asked.speed_m_s, inclination_rad)
    if inclination_rad != 0.0:
        yield courses(hull, actuation, asked.speed_m_s, inclination_rad, inclined=True)
    for used in 1.0 - np.eye(actuation.matrix.shape[1]):
        yield courses(hull, actuation.with_only(used), asked.speed_m_s, inclination_rad)
    if reach is not None:
        yield best_attitudes(hull, actuation, reach, asked.speed_m_s, inclination_rad)


def _steered(
    candidate: SteeredCourse,
    hull: Dynamics,
    actuation: Subspaces,
    allowed: AllowedForces | None,
    asked: Mission,
    best: SteeredCourse | None,
) -> SteeredCourse:
    """What is loose about a course that is held, and its side step as far as it may beat the best one so far."""
    course, swing = candidate.course, _SWING * asked.speed_m_s * SPATIAL.scale(actuation.length_m)
    units = actuation.length_m / asked.speed_m_s, actuation.length_m
    # A direction that does not count towards the rank is lost; as far as it goes it still pushes in the side step.
    reachable = actuation.projector @ actuation.matrix
    loose = linearise(hull, reachable, course.velocity, course.up, swing).loose(*units)
    if allowed is None:
        return replace(candidate, loose=loose, side_step_m=float("inf"))
    course = _within_limits(course, actuation, allowed)
    motion = linearise(hull, actuation.matrix, course.velocity, course.up, swing)
    low, high = np.minimum(allowed.minimum - course.forces, 0.0), np.maximum(allowed.maximum - course.forces, 0.0)
    loose = loose or motion.one_way(low, high, *units)
    bounds = Bounds(
        horizon_s=asked.horizon_s,
        most_turn_rad=asked.most_turn_rad,
        fastest_m_s=max(asked.speed_m_s, _QUICKEST * asked.side_step_m / asked.horizon_s),
        furthest_m=FURTHEST * asked.side_step_m,
    )
    above = best.side_step_m if best is not None and bool(best.loose) <= bool(loose) else 0.0
    step = side_step(motion, low, high, bounds, above_m=above)
    return replace(candidate, course=course, loose=loose, side_step_m=step)


def _within_limits(course: Course, actuation: Subspaces, allowed: AllowedForces) -> Course:
    """The course, kept by forces within the limits: A^+ F_B alone does not use the kernel."""
    if np.all((course.forces >= allowed.minimum) & (course.forces <= allowed.maximum)):
        return course
    return replace(course, forces=holding_forces(actuation.matrix, allowed, course.wrench))


def _merit(steered: SteeredCourse) -> tuple[bool, float, float]:
    return not steered.loose, steered.side_step_m, -steered.course.tilt_rad
