"""Whether a vehicle can follow a path with the thrusters it has, and why.

Rank alone does not tell: {Fx, Mz} is a unicycle and follows planar paths with rank 2, three torques have rank 3 and
stay where they are. Three questions are asked instead, for level and inclined courses:

1. Is there a trim condition: an attitude in which the steady wrench (drag, Munk and restoring moments) is within the
   range of A and the limits?
2. Is every mode of small motions about it controllable, or damped by the water?
3. How large an error across the course can be made good in a given time?

A vehicle that has all components is asked a fourth: any course in any attitude.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from cube_sim.actuation.attainable.attainable_set import attainable_set
from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.actuation.path_following.any_attitude import shortfall
from cube_sim.actuation.path_following.controllable_trim import FURTHEST, ControllableTrim, controllable_trim
from cube_sim.actuation.path_following.reasons import components_left, course, percent
from cube_sim.actuation.path_following.requirements import PathRequirements
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.allowed_forces import AllowedForces


class Outcome(Enum):
    """What is left of a vehicle."""

    HOLONOMIC = "holonomic"
    """Every wrench component is its own, and strong enough for any course in any attitude."""
    STEERED = "steered"
    """Not so, but every course asked for has a trim condition within the limits that is controllable."""
    ADRIFT = "adrift"
    """Every course has a trim condition, but some mode is neither damped nor controllable to both sides."""
    WEAK = "weak"
    """Every course can be kept and steered, but too slowly to follow a path."""
    STUCK = "stuck"
    """Some course has no trim condition within the limits: it cannot be kept in any attitude."""


@dataclass(frozen=True)
class Verdict:
    """Path following, yes or no.

    Attributes:
        outcome: what kind of vehicle is left.
        reason: one sentence.
        trims: the best trim condition for every inclination asked for at which there is one.
    """

    outcome: Outcome
    reason: str
    trims: tuple[ControllableTrim, ...]

    @property
    def follows(self) -> bool:
        """Whether it can be expected to follow a path."""
        return self.outcome in (Outcome.HOLONOMIC, Outcome.STEERED)


def judge(
    actuation: Subspaces,
    hull: Dynamics | None = None,
    allowed: AllowedForces | None = None,
    requirements: PathRequirements | None = None,
) -> Verdict:
    """Judge path following.

    Args:
        actuation: of the thrusters that are left.
        hull: the moving body; without one, `Dynamics.neutral`, which nothing restores.
        allowed: forces of the thrusters; without them limits are not looked at.
        requirements: what is asked; default `PathRequirements()`.

    Raises:
        ActuationError: the requirements make no sense.
    """
    required = PathRequirements() if requirements is None else requirements
    required.check()
    body = Dynamics.neutral(actuation.length_m) if hull is None else hull
    able = actuation if allowed is None else _able(actuation, allowed)
    attainable = None if allowed is None else attainable_set(able, allowed)
    inclinations = (0.0,) if len(actuation.matrix) == 3 else required.inclinations_rad
    left = components_left(able)
    trims: list[ControllableTrim] = []
    for inclination in inclinations:
        trim = controllable_trim(body, able, allowed, attainable, required, inclination)
        at_speed = f"{course(inclination)} at {required.speed_m_s:g} m/s"
        if trim is None:
            return Verdict(Outcome.STUCK, f"{left}; {at_speed} can be kept in no attitude tried", tuple(trims))
        trims.append(trim)
        if not trim.within_limits:
            held = f"{percent(trim.share)} of it {_best_where(able)}"
            who = "thrusters and fins" if required.nose_ahead else "the thrusters"
            text = f"{at_speed} needs more force than {who} have: they hold {held}"
            return Verdict(Outcome.STUCK, f"{left}; {text}", tuple(trims))
    missing = None
    if attainable is not None and able.rank == len(able.matrix):
        missing = shortfall(body, attainable, required.speed_m_s)
    return _all_kept(able, tuple(trims), required, missing)


def _able(actuation: Subspaces, allowed: AllowedForces) -> Subspaces:
    """The same without what thrusters do whose limits leave them no force."""
    moving = allowed.maximum > allowed.minimum
    return actuation if np.all(moving) else actuation.with_only(moving.astype(float))


def _all_kept(
    actuation: Subspaces, trims: tuple[ControllableTrim, ...], required: PathRequirements, missing: str | None
) -> Verdict:
    """The verdict where every course is kept within the limits.

    Args:
        actuation: of the thrusters that are left.
        trims: the best trim condition of each course.
        required: what is asked.
        missing: what keeps the vehicle from any course in any attitude; None when nothing does.
    """
    left = components_left(actuation)
    uncontrolled = sorted({name for trim in trims for name in trim.uncontrolled_modes})
    if uncontrolled:
        text = f"neither damped nor steered to both sides: {', '.join(uncontrolled)}"
        return Verdict(Outcome.ADRIFT, f"{left}; {text}", trims)
    step = min(trim.side_step_m for trim in trims)
    steering = _steering(step, required)
    if step < required.side_step_m:
        return Verdict(Outcome.WEAK, f"{left}; {steering}, {required.side_step_m:g} m are asked for", trims)
    planar = len(actuation.matrix) == 3
    freedom = "any course in the plane at any heading" if planar else "any course in any attitude"
    if actuation.rank == len(actuation.matrix) and missing is None:
        return Verdict(Outcome.HOLONOMIC, f"{left}: {freedom}; {steering}", trims)
    kept = "every course asked for is kept"
    if not planar:
        tilt = max(np.degrees(trim.condition.tilt_rad) for trim in trims)
        kept = f"{kept}, tilted by up to {tilt:.0f} deg where it need not turn"
    if missing is not None:
        kept = f"{kept}, but not {freedom}: {missing}"
    return Verdict(Outcome.STEERED, f"{left}; {kept}; {steering}", trims)


def _steering(step_m: float, required: PathRequirements) -> str:
    """How far errors across the course can be steered out."""
    if not np.isfinite(step_m):
        return "errors across the course can be steered out"
    more = " or more" if step_m >= FURTHEST * required.side_step_m else ""
    turning = f"turning by {np.degrees(required.most_turn_rad):.0f} deg at most"
    return f"in {required.horizon_s:g} s, {turning}, it can make good {step_m:.2g} m{more} across the course"


def _best_where(actuation: Subspaces) -> str:
    """In which attitude the share of a course is the largest."""
    return "in the best attitude" if len(actuation.matrix) == 6 else "at the best heading"
