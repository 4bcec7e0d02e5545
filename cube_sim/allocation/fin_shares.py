"""Which part of a wrench the fins make, compiled: the rest is left to the thrusters.

What a fin makes depends on the flow. At the velocity and the deflections of the moment the fins are linear,
W(delta) = W(delta_0) + B (delta - delta_0), and the least squares of what is wanted less what fins and thrusters make
share it out. Fins cost no power, so they come first where both could make it. What they make undeflected is the hull's
own (`cube_sim.vehicle.lift`) and counts for nothing here, but for what it is less once they stall, see
`FinParts.stalls`.

A deflection is asked for within the fin's travel, short of its stall, and no farther from where the fin is than its
servo turns it at full rate: asked for more, it would turn no faster.
"""

from __future__ import annotations

from math import atan2, inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.box_least_squares import nearest_in_box
from cube_sim.native.compiled import compiled
from cube_sim.tuples import component, cross_tuples, dot, minus, minus6, plus, plus6, stacked, to_body, triple
from cube_sim.vehicle.laws.body_lift import deflected_wrench
from cube_sim.vehicle.laws.fin import CHORD, NORMAL, PLACE, STALL, attached_wrench, fin_wrench

FIN_PRICE, THRUSTER_PRICE = 1e-8, 1e-5
"""What full deflection and full force cost, as shares of the squared wrench of the strongest of all (choices): next to
nothing, but less for a fin."""
STEP_RAD = 1e-4
"""Of the central difference that says what a deflection makes."""
SHORT_OF_STALL_RAD = 0.06
"""So far short of its stall a fin is asked to stay: its lift grows up to there, by how fast the law has it stall."""
AS_GOOD_AS_MADE = 1e-3
"""What fins miss of the wrench wanted, where no thruster makes such, is nothing up to this share: they are not linear
(a choice)."""
FEEBLE = 0.01
"""A fin that makes less than this share of what the strongest thruster makes is turned less, and at rest not at all (a
choice): the flow of the next moment is another."""
PASSES = 2
"""Times a fin that is not linear is made so: where it is, and where it is to be."""


class FinParts(NamedTuple):
    """Fins and thrusters as the sharing sees them.

    Attributes:
        table: (k,16) of `cube_sim.vehicle.laws.fin`, as believed.
        linear: (n,6) of `cube_sim.vehicle.laws.body_lift.deflected_wrench`, like the next.
        square: (n,6) of it.
        travel: (k,2) least and largest deflection [rad].
        reach: (k,) how far from where it is a fin is asked to turn [rad].
        thrusters: A (6,m) of all thrusters, as believed.
        forces: (m,2) least and largest force of each [N]; both the same of one that does not respond.
        beyond: (6,6) projector onto what no thruster makes, in the scale of `scale`.
        scale: (6,) by which wrenches are compared [1, 1/m].
        stalls: whether what a stall takes from fins that are not deflected is made up for, too. The hull's own numbers
            leave it out, and a hull that its fins steer is told by them which torque it takes. One whose thrusters hold
            it keeps it as damping.
    """

    table: NDArray[np.float64]
    linear: NDArray[np.float64]
    square: NDArray[np.float64]
    travel: NDArray[np.float64]
    reach: NDArray[np.float64]
    thrusters: NDArray[np.float64]
    forces: NDArray[np.float64]
    beyond: NDArray[np.float64]
    scale: NDArray[np.float64]
    stalls: bool


@compiled
def share_with_fins(parts, demand, nu_r, deflections, force_ratio, wanted, made, rest):
    """Deflections for a wrench, and what is left of it for the thrusters.

    Args:
        parts: `FinParts`.
        demand: (6,) wrench wanted [N, N m], body axes.
        nu_r: velocity of the hull through the water, a 6-tuple [m/s, rad/s], body axes.
        deflections: (k,) of the moment [rad].
        force_ratio: share of their force that the supply leaves the thrusters.
        wanted: (k,) out: deflections to ask for [rad].
        made: (6,) out: what they make [N, N m].
        rest: (6,) out: what is left.

    Returns:
        How much of the wrench is missed [N], torques by `scale`.
    """
    p, k, m = parts, len(parts.table), parts.thrusters.shape[1]
    C, target, x = np.zeros((6, k + m)), np.zeros(6), np.zeros(k + m)
    low, high, price = np.zeros(k + m), np.zeros(k + m), np.zeros(k + m)
    strongest = 0.0
    for j in range(m):
        square = 0.0
        size = max(max(abs(p.forces[j, 0]), abs(p.forces[j, 1])), 1e-12)
        for a in range(6):
            C[a, k + j] = p.scale[a] * p.thrusters[a, j] * size
            square += C[a, k + j] * C[a, k + j]
        strongest = max(strongest, square)
        low[k + j], high[k + j] = force_ratio * p.forces[j, 0] / size, force_ratio * p.forces[j, 1] / size
    curved = len(p.square) > 0
    for i in range(k):
        wanted[i] = min(max(deflections[i], p.travel[i, 0]), p.travel[i, 1])
        curved = curved or p.table[i, STALL] < inf
    for a in range(6):
        made[a] = 0.0
    for _ in range(PASSES if curved else 1):
        for a in range(6):
            target[a] = p.scale[a] * demand[a]
        largest = 0.0
        for i in range(k):
            fin, size = p.table[i], max(abs(p.travel[i, 0]), abs(p.travel[i, 1]))
            undeflected, there = undeflected_fin(p, i, nu_r), turned_fin(p, i, wanted[i], nu_r)
            ahead, back = turned_fin(p, i, wanted[i] + STEP_RAD, nu_r), turned_fin(p, i, wanted[i] - STEP_RAD, nu_r)
            slope, base = minus6(ahead, back), minus6(there, undeflected)
            square = 0.0
            for a in range(6):
                turned = p.scale[a] * component(slope, a) / (2.0 * STEP_RAD)
                square += (turned * size) ** 2
                C[a, i] = turned * size
                target[a] += turned * wanted[i] - p.scale[a] * component(base, a)
            least, most = fin_reach(fin, p.travel[i], p.reach[i], deflections[i], nu_r)
            counts = square / max(FEEBLE**2 * strongest, 1e-300)
            if counts < 1.0:
                limit, turns_to = counts * size, (deflections[i] - p.reach[i], deflections[i] + p.reach[i])
                least = min(max(min(max(least, -limit), limit), turns_to[0]), turns_to[1])
                most = min(max(min(max(most, -limit), limit), turns_to[0]), turns_to[1])
            low[i], high[i], x[i] = least / size, most / size, wanted[i] / size
        for i in range(k + m):
            square = 0.0
            for a in range(6):
                square += C[a, i] * C[a, i]
            largest = max(largest, square)
        for i in range(k + m):
            price[i] = max((FIN_PRICE if i < k else THRUSTER_PRICE) * largest, 1e-300)
        nearest_in_box(C, target, price, low, high, x)
        for i in range(k):
            wanted[i] = x[i] * max(abs(p.travel[i, 0]), abs(p.travel[i, 1]))
    for i in range(k):
        more = minus6(turned_fin(p, i, wanted[i], nu_r), undeflected_fin(p, i, nu_r))
        for a in range(6):
            made[a] += component(more, a)
    return leave_the_rest(p, demand, made, rest)


@compiled
def turned_fin(parts, i, deflection, nu_r):
    """The wrench of fin i, a 6-tuple [N, N m], at a deflection [rad] and a velocity (6-tuple); parts a `FinParts`."""
    lift = fin_wrench(parts.table[i], deflection, nu_r)
    if len(parts.linear) + len(parts.square) == 0:
        return lift
    return plus6(lift, deflected_wrench(parts.linear, parts.square, float(i), deflection, nu_r))


@compiled
def undeflected_fin(parts, i, nu_r):
    """What the hull itself has of fin i, a 6-tuple [N, N m]; arguments as for `turned_fin`."""
    return attached_wrench(parts.table[i], nu_r) if parts.stalls else turned_fin(parts, i, 0.0, nu_r)


@compiled
def leave_the_rest(parts, demand, made, rest):
    """What is wanted less what fins make, as far as thrusters make such; how much is missed where none does [N].

    It is not left to the allocation: by its thrusters' own arms, a hundredth of the fins' perhaps, a torque that is
    missed would count more than any force.
    """
    wanted, missed, left = 0.0, 0.0, np.zeros(6)
    for a in range(6):
        rest[a] = demand[a] - made[a]
        wanted += (parts.scale[a] * demand[a]) ** 2
    for a in range(6):
        for b in range(6):
            left[a] += parts.beyond[a, b] * parts.scale[b] * rest[b]
        missed += left[a] * left[a]
    for a in range(6):
        rest[a] -= left[a] / parts.scale[a]
    return 0.0 if sqrt(missed) <= AS_GOOD_AS_MADE * sqrt(wanted) else sqrt(missed)


@compiled
def fin_reach(fin, travel, reach, deflection, nu_r):
    """Least and largest deflection to ask for [rad]; arguments as in `FinParts`, of one fin, and `share_with_fins`."""
    low, high = travel[0], travel[1]
    if fin[STALL] < inf:
        flow = plus(nu_r[:3], cross_tuples(nu_r[3:], (fin[PLACE], fin[PLACE + 1], fin[PLACE + 2])))
        along = dot((fin[CHORD], fin[CHORD + 1], fin[CHORD + 2]), flow)
        across = dot((fin[NORMAL], fin[NORMAL + 1], fin[NORMAL + 2]), flow)
        if along > 0.0:
            meets = atan2(across, along)
            low = min(max(low, meets - (fin[STALL] - SHORT_OF_STALL_RAD)), travel[1])
            high = max(min(high, meets + (fin[STALL] - SHORT_OF_STALL_RAD)), travel[0])
    return min(max(low, deflection - reach), high), max(min(high, deflection + reach), low)


@compiled
def with_missed(residual, status, missed):
    """Residual [N] and status of an allocation of the rest, with what fins have missed of the whole [N]."""
    if missed == 0.0:
        return residual, status
    return sqrt(residual * residual + missed * missed), 1 if status == 0 else status


@compiled
def steer_fins(parts, demand, R, velocity, rates, current, deflections, force_ratio, wanted, made, rest):
    """`share_with_fins` at what is known of the motion.

    Args:
        parts: `FinParts`.
        demand: (6,) wrench wanted [N, N m], body axes.
        R: R_WB (3,3).
        velocity: over ground (3,) [m/s], body axes.
        rates: (3,) [rad/s], body axes.
        current: (3,) [m/s], world axes.
        deflections: as in `share_with_fins`, like all that follow.
        force_ratio: see there.
        wanted: see there.
        made: see there.
        rest: see there.

    Returns:
        See there.
    """
    nu_r = stacked(minus(triple(velocity), to_body(R, triple(current))), triple(rates))
    return share_with_fins(parts, demand, nu_r, deflections, force_ratio, wanted, made, rest)
