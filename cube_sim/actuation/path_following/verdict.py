"""Whether a vehicle can follow a path with the thrusters it has, and why.

Rank alone does not tell: {Fx, Mz} is a unicycle and follows planar paths with rank 2, three torques have rank 3 and
stay where they are. Asked instead, for level and inclined courses: is there an attitude in which the steady wrench
(drag, Munk and restoring moments) is within reach and limits, is every motion about that course steered by the
thrusters or damped by the water, and how large an error across the course can be made good in a given time? A vehicle
that has all components is asked for any course in any attitude besides.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from cube_sim.actuation.attainable.attainable_set import attainable
from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.actuation.path_following.any_attitude import shortfall
from cube_sim.actuation.path_following.controllable_trim import FURTHEST, SteeredCourse, steered_course
from cube_sim.actuation.path_following.percent import percent
from cube_sim.actuation.path_following.requirements import Mission
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.allowed_forces import AllowedForces


class Outcome(Enum):
    """What is left of a vehicle."""

    HOLONOMIC = "holonomic"
    """Every wrench component is its own, and strong enough for any course in any attitude."""
    STEERED = "steered"
    """Not so, but every course asked for can be kept and steered."""
    ADRIFT = "adrift"
    """Courses can be kept, but some motion is neither damped nor steered to both sides."""
    WEAK = "weak"
    """Courses can be kept and steered, but too slowly to follow a path."""
    STUCK = "stuck"
    """Some course cannot be kept in any attitude."""


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
    actuation: Subspaces,
    hull: Dynamics | None = None,
    allowed: AllowedForces | None = None,
    mission: Mission | None = None,
) -> Verdict:
    """Judge path following.

    Args:
        actuation: of the thrusters that are left.
        hull: the moving body; without one, `Dynamics.neutral`, which nothing restores.
        allowed: forces of the thrusters; without them limits are not looked at.
        mission: what is asked; default `Mission()`.

    Raises:
        ActuationError: the mission asks for nothing sensible.
    """
    asked = Mission() if mission is None else mission
    asked.check()
    body = Dynamics.neutral(actuation.length_m) if hull is None else hull
    able = actuation if allowed is None else _able(actuation, allowed)
    reach = None if allowed is None else attainable(able, allowed)
    inclinations = (0.0,) if len(actuation.matrix) == 3 else asked.inclinations_rad
    best: list[SteeredCourse] = []
    for inclination in inclinations:
        found = steered_course(body, able, allowed, reach, asked, inclination)
        if found is None:
            return Verdict(Outcome.STUCK, f"{_left(able)}; {_no_course(inclination, asked)}", tuple(best))
        best.append(found)
        if not found.within_limits:
            text = f"{_course(inclination)} at {asked.speed_m_s:g} m/s needs more force than the thrusters have"
            text = f"{text}: they hold {percent(found.share)} of it {_where(able)}"
            return Verdict(Outcome.STUCK, f"{_left(able)}; {text}", tuple(best))
    missing = None
    if reach is not None and able.rank == len(able.matrix):
        missing = shortfall(body, reach, asked.speed_m_s)
    return _verdict(able, tuple(best), asked, missing)


def _able(actuation: Subspaces, allowed: AllowedForces) -> Subspaces:
    """The same without what thrusters do whose limits leave them no force."""
    moving = allowed.maximum > allowed.minimum
    return actuation if np.all(moving) else actuation.with_only(moving.astype(float))


def _verdict(actuation: Subspaces, best: tuple[SteeredCourse, ...], asked: Mission, missing: str | None) -> Verdict:
    left = _left(actuation)
    loose = sorted({name for steered in best for name in steered.loose})
    if loose:
        return Verdict(Outcome.ADRIFT, f"{left}; neither damped nor steered to both sides: {', '.join(loose)}", best)
    step = min(steered.side_step_m for steered in best)
    tilt = max(np.degrees(steered.course.tilt_rad) for steered in best)
    steering = "errors across the course can be steered out"
    if np.isfinite(step):
        more = " or more" if step >= FURTHEST * asked.side_step_m else ""
        turning = f"turning by {np.degrees(asked.most_turn_rad):.0f} deg at most"
        steering = f"in {asked.horizon_s:g} s, {turning}, it can make good {step:.2g} m{more} across the course"
    if step < asked.side_step_m:
        return Verdict(Outcome.WEAK, f"{left}; {steering}, {asked.side_step_m:g} m are asked for", best)
    planar = len(actuation.matrix) == 3
    freedom = "any course in the plane at any heading" if planar else "any course in any attitude"
    if actuation.rank == len(actuation.matrix) and missing is None:
        return Verdict(Outcome.HOLONOMIC, f"{left}: {freedom}; {steering}", best)
    kept = "every course asked for is kept"
    if not planar:
        kept = f"{kept}, tilted by up to {tilt:.0f} deg"
    if missing is not None:
        kept = f"{kept}, but not {freedom}: {missing}"
    return Verdict(Outcome.STEERED, f"{left}; {kept}; {steering}", best)


def _left(actuation: Subspaces) -> str:
    n = len(actuation.matrix)
    if actuation.rank == n:
        return f"all {n} components are produced"
    forces, torques = actuation.pure_forces.shape[1], actuation.pure_torques.shape[1]
    return f"{actuation.rank} of {n} components are left: {forces} pure force, {torques} pure torque"


def _where(actuation: Subspaces) -> str:
    """In which attitude the share of a course is the largest."""
    return "in the best attitude" if len(actuation.matrix) == 6 else "at the best heading"


def _course(inclination_rad: float) -> str:
    degrees = np.degrees(inclination_rad)
    if abs(degrees) < 0.5:
        return "a level course"
    return f"a course {'climbing' if degrees > 0.0 else 'sinking'} at {abs(degrees):.0f} deg"


def _no_course(inclination_rad: float, asked: Mission) -> str:
    return f"{_course(inclination_rad)} at {asked.speed_m_s:g} m/s can be kept in no attitude tried"
