"""Whether a vehicle can follow a path with the thrusters it has, and why.

Rank alone does not tell: {Fx, Mz} is a unicycle and follows planar paths with rank 2, three torques have rank 3 and
stay where they are. Asked instead, for level and inclined courses: is there an attitude in which the steady wrench
(drag, Munk and restoring moments) is within reach and limits, is every motion about that course steered by the
thrusters or damped by the water, and how large an error across the course can be made good in a given time?
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from cube_sim.actuation.allowed import AllowedForces
from cube_sim.actuation.courses import Course, courses
from cube_sim.actuation.hull import Hull
from cube_sim.actuation.linear_motion import linearise
from cube_sim.actuation.subspaces import Subspaces
from cube_sim.actuation.wrench_axes import SPATIAL
from cube_sim.errors import ActuationError

_SWING = 0.1
"""Amplitude of the motions about a course, in courses' speeds and speeds per length, at which drag damps (a choice)."""

_SHARES = (0.5, 1.0)
"""Shares of the horizon in which a side step is tried."""


class Outcome(Enum):
    """What is left of a vehicle."""

    HOLONOMIC = "holonomic"
    """Every wrench component is its own: any course in any attitude."""
    STEERED = "steered"
    """Under-actuated, but every course asked for can be kept and steered."""
    ADRIFT = "adrift"
    """Courses can be kept, but some motion is neither steered nor damped."""
    WEAK = "weak"
    """Courses can be kept and steered, but too slowly to follow a path."""
    STUCK = "stuck"
    """Some course cannot be kept at all."""


@dataclass(frozen=True)
class Mission:
    """What the verdict asks for; every figure is a choice.

    Attributes:
        speed_m_s: speed over the course.
        inclinations_rad: angles of the courses above the horizontal (3-D only; in the plane only 0).
        horizon_s: within this time ...
        side_step_m: ... this displacement must be made good in every direction across the course ...
        most_turn_rad: ... without turning further than this on the way.
    """

    speed_m_s: float = 0.3
    inclinations_rad: tuple[float, ...] = (float(np.radians(-15.0)), 0.0, float(np.radians(15.0)))
    horizon_s: float = 20.0
    side_step_m: float = 0.5
    most_turn_rad: float = float(np.radians(30.0))


@dataclass(frozen=True)
class SteeredCourse:
    """The best way found to keep one course.

    Attributes:
        course: velocity, attitude, forces.
        within_limits: whether the forces are within the thrusters' maxima.
        loose: motions neither steered nor damped.
        side_step_m: displacement made good within the mission's horizon, in the worst direction across the course;
            infinite when no limits are known.
    """

    course: Course
    within_limits: bool
    loose: tuple[str, ...]
    side_step_m: float


@dataclass(frozen=True)
class Verdict:
    """Path following, yes or no.

    Attributes:
        outcome: what kind of vehicle is left.
        reason: one sentence.
        courses: the best course for every inclination asked for at which there is one.
    """

    outcome: Outcome
    reason: str
    courses: tuple[SteeredCourse, ...]

    @property
    def follows(self) -> bool:
        """Whether it can be expected to follow a path."""
        return self.outcome in (Outcome.HOLONOMIC, Outcome.STEERED)


def judge(
    actuation: Subspaces, hull: Hull | None = None, allowed: AllowedForces | None = None, mission: Mission | None = None
) -> Verdict:
    """Judge path following.

    Args:
        actuation: of the thrusters that are left.
        hull: the moving body; without one, `Hull.neutral`, which nothing restores.
        allowed: forces of the thrusters; without them limits are not looked at.
        mission: what is asked; default `Mission()`.

    Raises:
        ActuationError: the mission asks for nothing sensible.
    """
    asked = Mission() if mission is None else mission
    _check(asked)
    body = Hull.neutral(actuation.length_m) if hull is None else hull
    inclinations = (0.0,) if len(actuation.matrix) == 3 else asked.inclinations_rad
    best: list[SteeredCourse] = []
    for inclination in inclinations:
        found = [
            _steer(course, body, actuation, allowed, asked)
            for course in courses(body, actuation, asked.speed_m_s, inclination)
        ]
        if not found:
            return Verdict(Outcome.STUCK, f"{_left(actuation)}; {_no_course(inclination, asked)}", tuple(best))
        best.append(max(found, key=_merit))
        if not best[-1].within_limits:
            text = f"{_course(inclination)} at {asked.speed_m_s:g} m/s needs more force than the thrusters have"
            return Verdict(Outcome.STUCK, f"{_left(actuation)}; {text}", tuple(best))
    return _verdict(actuation, tuple(best), asked)


def _check(asked: Mission) -> None:
    figures = [asked.speed_m_s, asked.horizon_s, asked.side_step_m, asked.most_turn_rad]
    if not (np.all(np.isfinite(figures)) and min(figures) > 0.0):
        raise ActuationError(f"a mission needs a positive speed, time, side step and turn; it is {asked}")
    if not asked.inclinations_rad or not np.all(np.abs(asked.inclinations_rad) <= np.pi / 2.0):
        raise ActuationError(f"a mission needs courses, inclined by at most 90 degrees; it is {asked}")


def _steer(
    course: Course, hull: Hull, actuation: Subspaces, allowed: AllowedForces | None, asked: Mission
) -> SteeredCourse:
    reachable = actuation.projector @ actuation.matrix
    swing = _SWING * asked.speed_m_s * SPATIAL.scale(actuation.length_m)
    motion = linearise(hull, reachable, course.velocity, course.up, swing)
    within, step = True, float("inf")
    if allowed is not None:
        margins = np.minimum(allowed.maximum - course.forces, course.forces - allowed.minimum)
        within = bool(np.all(margins >= 0.0))
        # Given longer, the manoeuvre of least effort turns more and pushes less; a shorter one may reach further.
        times = [share * asked.horizon_s for share in _SHARES]
        step = max(motion.side_step(np.maximum(margins, 0.0), time, asked.most_turn_rad) for time in times)
    loose = motion.loose(actuation.length_m / asked.speed_m_s, actuation.length_m)
    return SteeredCourse(course, within, loose, step)


def _merit(steered: SteeredCourse) -> tuple[bool, bool, float, float]:
    return steered.within_limits, not steered.loose, steered.side_step_m, -steered.course.tilt_rad


def _verdict(actuation: Subspaces, best: tuple[SteeredCourse, ...], asked: Mission) -> Verdict:
    left = _left(actuation)
    loose = sorted({name for steered in best for name in steered.loose})
    if loose:
        return Verdict(Outcome.ADRIFT, f"{left}; nothing steers or damps: {', '.join(loose)}", best)
    weakest = min(best, key=lambda steered: steered.side_step_m)
    tilt = max(np.degrees(steered.course.tilt_rad) for steered in best)
    steering = "errors across the course can be steered out"
    if np.isfinite(weakest.side_step_m):
        steering = f"in {asked.horizon_s:g} s it can make good {weakest.side_step_m:.2g} m across the course"
    if weakest.side_step_m < asked.side_step_m:
        return Verdict(Outcome.WEAK, f"{left}; {steering}, {asked.side_step_m:g} m are asked for", best)
    if actuation.rank == len(actuation.matrix):
        return Verdict(Outcome.HOLONOMIC, f"{left}: any course in any attitude; {steering}", best)
    return Verdict(
        Outcome.STEERED, f"{left}; every course asked for is kept, tilted by up to {tilt:.0f} deg; {steering}", best
    )


def _left(actuation: Subspaces) -> str:
    n = len(actuation.matrix)
    if actuation.rank == n:
        return f"all {n} components are produced"
    forces, torques = actuation.pure_forces.shape[1], actuation.pure_torques.shape[1]
    return f"{actuation.rank} of {n} components are left: {forces} pure force, {torques} pure torque"


def _course(inclination_rad: float) -> str:
    degrees = np.degrees(inclination_rad)
    if abs(degrees) < 0.5:
        return "a level course"
    return f"a course {'climbing' if degrees > 0.0 else 'sinking'} at {abs(degrees):.0f} deg"


def _no_course(inclination_rad: float, asked: Mission) -> str:
    return f"{_course(inclination_rad)} at {asked.speed_m_s:g} m/s can be kept in no attitude near level"
