"""Up to which speed through the water a vehicle keeps margins, from its model: for the analysis and the run alike.

Two things limit it, on a level course nose ahead. A hull with more added mass aside than ahead is turned further across
its course by the Munk moment, which grows with the square of the speed. About an axis that is left to the water, only
the righting moment is against it: with the place held, a tilt theta obeys P theta'' + Q theta' + S theta = 0, the zeros
from the wrench to the place, and no law can make more of S than the water does. About the axes that thrusters hold, the
hull alone leaves its course as exp(p t). Behind a delay T the loop k / (s / p - 1) has a phase margin of
atan x - x p T at most, x = sqrt(1 / (p T) - 1), whatever its gain: 40 degrees where p T = 0.2, the limit of any such
loop. Those of `cube_sim.control.loop_times`, with the disturbance estimate in them, come to 6 dB and 40 degrees before.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from math import inf
from typing import NamedTuple

import numpy as np

from cube_sim.control.authority import OUT_OF_PLANE, Authority, Capability
from cube_sim.spatial import skew
from cube_sim.vehicle.dynamics import Dynamics

LEAST_HELD, LEAST_HELD_POINTING = 0.45, 0.65
"""Share of what the water holds at rest that must be left; where forces are pointed, so that the velocity loop is
slower, more of it. With less the tilt swings as slowly as the place is held: over the catalogue 6 dB is left down to
here (measured)."""
MOST_DELAYED = 0.125
"""p T at which the loops still have 6 dB and 40 degrees (measured, on the catalogue)."""
GROWING_RAD_S = 1e-3
"""Out of the plane, where nothing is held by a vehicle for the plane, a motion that grows slower than this does not."""
FASTEST_M_S = 5.0
"""Speeds are looked at up to this one, as paths may have them."""
STEPS = 50
"""In which they are; limits are then found between two by halving."""
HALVINGS = 20
UP = np.array([0.0, 0.0, 1.0])


class CriticalSpeed(NamedTuple):
    """Where the margins end.

    Attributes:
        speed_m_s: through the water; infinite where they last up to `FASTEST_M_S`.
        reason: what ends them, in words; empty where nothing does.
    """

    speed_m_s: float
    reason: str


def critical_speed(left: Capability, hull: Dynamics, delay_s: float, up_to_m_s: float = FASTEST_M_S) -> CriticalSpeed:
    """The slowest speed through the water at which a vehicle lacks what margins need.

    Args:
        left: what the thrusters can still do.
        hull: the body.
        delay_s: mean delay T from state to force: lag of the thrusters and 1.5 control periods [s].
        up_to_m_s: where the margins last up to this speed, nothing faster is looked at: infinite then [m/s].
    """
    slow = 0.0
    for fast in np.linspace(0.0, FASTEST_M_S, STEPS + 1)[1:].tolist():
        if slow >= up_to_m_s:
            break
        if not _lacks(left, hull, delay_s, fast):
            slow = fast
            continue
        for _ in range(HALVINGS):
            middle = 0.5 * (slow + fast)
            slow, fast = (slow, middle) if _lacks(left, hull, delay_s, middle) else (middle, fast)
        return CriticalSpeed(fast, _lacks(left, hull, delay_s, fast))
    return CriticalSpeed(inf, "")


def surely_uncritical_speed(left: Capability, hull: Dynamics, delay_s: float, known_to: float) -> float:
    """Up to which speed a vehicle has the margins though added mass, drag and thrust are only known to a share [m/s].

    Added mass and drag move the critical speed: it is the least one of all hulls that the one believed may be, at the
    corners. A gain that is wrong, as that of the thrusters, and water that moves otherwise than believed take as much
    of what is left of the margins there: they have the same share of the speed.

    Args:
        left: what the thrusters can still do.
        hull: the body, as it is believed to be.
        delay_s: see `critical_speed`.
        known_to: by which share they may be wrong.
    """
    factors = (1.0 - known_to, 1.0, 1.0 + known_to)
    corners = [
        replace(
            hull,
            added_mass=mass * hull.added_mass,
            linear_damping=drag * hull.linear_damping,
            quadratic_damping=drag * hull.quadratic_damping,
        )
        for mass, drag in product(factors, factors)
    ]
    return (1.0 - known_to) * min(critical_speed(left, corner, delay_s).speed_m_s for corner in corners)


def too_fast(
    left: Capability, hull: Dynamics, delay_s: float, speed_m_s: float, limit: CriticalSpeed | None = None
) -> str | None:
    """Words for a speed through the water [m/s] that is beyond the critical one; None for one that is not.

    See `critical_speed` for the other arguments, and for `limit` where it is known already.
    """
    limit = limit or critical_speed(left, hull, delay_s, speed_m_s)
    if left.authority is Authority.SAFE or speed_m_s <= limit.speed_m_s:
        return None
    return (
        f"{speed_m_s:.3g} m/s through the water is beyond this vehicle's critical speed of {limit.speed_m_s:.2g} m/s,"
        f" level and nose ahead: there {limit.reason}"
    )


def held_share(left: Capability, hull: Dynamics, speed_m_s: float) -> float:
    """Share of its stiffness at rest that the water keeps about the axes left to it; 1 where there are none.

    Where there are several, the least over their motions together.
    """
    torques = np.linalg.norm(left.yielding[3:], axis=0) > 0.0
    if left.level or not np.any(torques):
        return 1.0
    given_way = np.linalg.solve(left.lost.T @ left.yielding, left.lost.T)[torques]
    axes = left.yielding[3:, torques]
    velocity = np.array([speed_m_s, 0.0, 0.0])
    # A tilted hull meets the flow from another side.
    munk = hull.steady_wrench_slope(np.pad(velocity, (0, 3)))[:, :3] @ skew(velocity)
    at_rest = given_way @ -hull.restoring_slope(UP) @ axes
    moving = at_rest + given_way @ munk @ axes
    return float(np.min(np.linalg.eigvals(np.linalg.solve(at_rest, moving)).real))


def own_growth(hull: Dynamics, speed_m_s: float, moving: tuple[int, ...]) -> float:
    """How fast the hull alone leaves a straight course in which its forces are held [1/s]; 0 where it does not.

    Args:
        hull: the body.
        speed_m_s: ahead through the water.
        moving: components of its velocity that may change.
    """
    rows, turning = list(moving), [axis - 3 for axis in moving if axis >= 3]
    k, r = len(rows), len(turning)
    inertia = hull.total_mass[np.ix_(rows, rows)]
    A = np.zeros((r + k, r + k))
    A[:r, r + k - r :] = np.eye(r)
    A[r:, :r] = np.linalg.solve(inertia, hull.restoring_slope(UP)[np.ix_(rows, turning)])
    slope = hull.steady_wrench_slope(np.array([speed_m_s, 0.0, 0.0, 0.0, 0.0, 0.0]))
    A[r:, r:] = -np.linalg.solve(inertia, slope[np.ix_(rows, rows)])
    return float(max(0.0, np.max(np.linalg.eigvals(A).real)))


def _lacks(left: Capability, hull: Dynamics, delay_s: float, speed_m_s: float) -> str:
    """What margins need and there is not, in words; empty where nothing is missing."""
    share = LEAST_HELD_POINTING if left.authority in (Authority.PLANE, Authority.LINE) else LEAST_HELD
    if held_share(left, hull, speed_m_s) < share:
        return f"the flow leaves {100.0 * share:.0f} % of what rights it about an axis that no thruster holds"
    out = tuple(np.flatnonzero(OUT_OF_PLANE).tolist())
    if left.level and own_growth(hull, speed_m_s, out) > GROWING_RAD_S:
        return "it leaves its plane by itself"
    moving = tuple(np.flatnonzero(~OUT_OF_PLANE).tolist()) if left.level else tuple(range(6))
    if own_growth(hull, speed_m_s, moving) * delay_s > MOST_DELAYED:
        return f"the hull alone leaves its course as fast as loops {delay_s:.2g} s late can keep it"
    return ""
