"""The best trim condition of a course: held within the limits, no mode uncontrolled, the longest side step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from cube_sim.actuation.attainable.attainable_set import AttainableSet, holding_forces
from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.actuation.path_following.best_trim import best_trims
from cube_sim.actuation.path_following.linear_motion import linearise
from cube_sim.actuation.path_following.requirements import ASLANT_RAD, PathRequirements
from cube_sim.actuation.path_following.side_step import SideStepBounds, side_step
from cube_sim.actuation.path_following.trim import TrimCondition, trim_conditions
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.axes import SPATIAL

_SWING = 0.1
"""Amplitude of the motions about a course at which drag damps, in its speed and its speed per length (a choice)."""

FURTHEST = 2.0
"""Side steps are looked for up to this many times the required one; further, small motions say little (a choice)."""

_QUICKEST = 4.0
"""The velocity may change by this many times the mean speed of the required side step, or by that of the course."""

_HELD = 1.0 - 1e-9

_SAME = 1e-4
"""Attitudes that differ by less [rad] are one."""


@dataclass(frozen=True)
class ControllableTrim:
    """The best way found to keep one course.

    Attributes:
        condition: velocity, attitude and forces. The forces are those of least norm; where these exceed the limits,
            those that use the least share of them.
        share: how many times the wrench that keeps it fits into the thrusters' maxima; infinite without limits.
        uncontrolled_modes: motions neither controllable to both sides nor damped.
        side_step_m: displacement made good within the required horizon, in the worst direction across the course. It
            is looked for up to twice the required one; infinite when no limits are known.
    """

    condition: TrimCondition
    share: float
    uncontrolled_modes: tuple[str, ...]
    side_step_m: float

    @property
    def within_limits(self) -> bool:
        """Whether the thrusters can keep the course."""
        return self.share >= _HELD


def controllable_trim(
    hull: Dynamics,
    actuation: Subspaces,
    allowed: AllowedForces | None,
    attainable: AttainableSet | None,
    required: PathRequirements,
    inclination_rad: float,
) -> ControllableTrim | None:
    """The best way to keep one course; the nearest to it where none is within the limits.

    Args:
        hull: the body.
        actuation: of the thrusters that are left.
        allowed: their forces; without them limits are not looked at.
        attainable: the wrenches they attain.
        required: speed, side step and its bounds.
        inclination_rad: angle of the course above the horizontal.

    Returns:
        None when there is no trim: in no attitude tried is the wrench in range(A). Where the course exceeds the
        limits, its share is the largest of all attitudes.
    """
    found: list[ControllableTrim] = []
    best: ControllableTrim | None = None
    for attempt in _attempts(hull, actuation, attainable, required, inclination_rad):
        able = [c for c in attempt if not required.nose_ahead or _is_nose_ahead(c)]
        more = [c for c in able if not any(_is_same(c, other.condition) for other in found)]
        shares = [float("inf") if attainable is None else float(attainable.share(c.wrench[None, :])[0]) for c in more]
        new = [ControllableTrim(c, share, (), 0.0) for c, share in zip(more, shares, strict=True)]
        found += new
        held = [candidate for candidate in new if candidate.within_limits]
        held.sort(key=lambda candidate: (round(np.degrees(candidate.condition.tilt_rad)), -candidate.share))
        for candidate in held:
            assessed = _assessed(candidate, hull, actuation, allowed, required, best)
            if best is None or _merit(assessed) > _merit(best):
                best = assessed
            if _is_steered(best, FURTHEST * required.side_step_m):
                break
        if best is not None and _is_steered(best, required.side_step_m):
            break
    return max(found, key=lambda candidate: candidate.share, default=None) if best is None else best


def _is_steered(trim: ControllableTrim, far_m: float) -> bool:
    """Whether all modes are controlled and errors of so much are made good."""
    return not trim.uncontrolled_modes and trim.side_step_m >= far_m


def _is_same(one: TrimCondition, other: TrimCondition) -> bool:
    """Whether two attempts have led to one attitude."""
    off = np.concatenate([(one.velocity - other.velocity) / np.linalg.norm(other.velocity), one.up - other.up])
    return bool(np.max(np.abs(off)) < _SAME)


def _is_nose_ahead(condition: TrimCondition) -> bool:
    """Whether the flow comes from ahead."""
    return bool(condition.velocity[0] >= np.cos(ASLANT_RAD) * np.linalg.norm(condition.velocity))


def _attempts(
    hull: Dynamics,
    actuation: Subspaces,
    attainable: AttainableSet | None,
    required: PathRequirements,
    inclination_rad: float,
) -> Iterator[tuple[TrimCondition, ...]]:
    """Attitudes to try: near level, deck along the course, one thruster not needed; last the best of all.

    The next are tried where none so far is held and steered well enough. Where the Munk moment outgrows the righting
    one, level is still a trim, but a poor one, and the hull flies nose up or nose down.
    """
    yield trim_conditions(hull, actuation, required.speed_m_s, inclination_rad)
    if inclination_rad != 0.0:
        yield trim_conditions(hull, actuation, required.speed_m_s, inclination_rad, inclined=True)
    for used in 1.0 - np.eye(actuation.matrix.shape[1]):
        yield trim_conditions(hull, actuation.with_only(used), required.speed_m_s, inclination_rad)
    if attainable is not None:
        yield best_trims(hull, actuation, attainable, required.speed_m_s, inclination_rad)


def _assessed(
    candidate: ControllableTrim,
    hull: Dynamics,
    actuation: Subspaces,
    allowed: AllowedForces | None,
    required: PathRequirements,
    best: ControllableTrim | None,
) -> ControllableTrim:
    """The uncontrolled modes of a course that is held, and its side step as far as it may beat the best one so far."""
    condition, swing = candidate.condition, _SWING * required.speed_m_s * SPATIAL.scale(actuation.length_m)
    units = actuation.length_m / required.speed_m_s, actuation.length_m
    # A direction that does not count towards the rank is lost; as far as it goes it still pushes in the side step.
    reachable = actuation.projector @ actuation.matrix
    uncontrolled = linearise(hull, reachable, condition.velocity, condition.up, swing).uncontrolled_modes(*units)
    if allowed is None:
        return replace(candidate, uncontrolled_modes=uncontrolled, side_step_m=float("inf"))
    condition = _within_limits(condition, actuation, allowed)
    motion = linearise(hull, actuation.matrix, condition.velocity, condition.up, swing)
    low, high = np.minimum(allowed.minimum - condition.forces, 0.0), np.maximum(allowed.maximum - condition.forces, 0.0)
    uncontrolled = uncontrolled or motion.one_sided_modes(low, high, *units)
    bounds = SideStepBounds(
        horizon_s=required.horizon_s,
        most_turn_rad=required.most_turn_rad,
        fastest_m_s=max(required.speed_m_s, _QUICKEST * required.side_step_m / required.horizon_s),
        furthest_m=FURTHEST * required.side_step_m,
    )
    above = 0.0
    if best is not None and bool(best.uncontrolled_modes) <= bool(uncontrolled):
        above = best.side_step_m
    step = side_step(motion, low, high, bounds, above_m=above)
    return replace(candidate, condition=condition, uncontrolled_modes=uncontrolled, side_step_m=step)


def _within_limits(condition: TrimCondition, actuation: Subspaces, allowed: AllowedForces) -> TrimCondition:
    """The same, kept by forces within the limits: A^+ F_B alone does not use the kernel."""
    if np.all((condition.forces >= allowed.minimum) & (condition.forces <= allowed.maximum)):
        return condition
    return replace(condition, forces=holding_forces(actuation.matrix, allowed, condition.wrench))


def _merit(assessed: ControllableTrim) -> tuple[bool, float, float]:
    """What makes one better than another: control of all modes, then a longer side step, then less tilt."""
    return not assessed.uncontrolled_modes, assessed.side_step_m, -assessed.condition.tilt_rad
