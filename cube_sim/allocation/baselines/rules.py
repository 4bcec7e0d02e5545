"""What the baselines answer, number by number: for the interpreter, and compiled for the loop of a flight (`flown`)."""

from __future__ import annotations

from math import sqrt

from cube_sim.allocation.allocation import Status
from cube_sim.wrench.matrix import LARGEST_ERROR_N

LARGEST_DEMAND = 1e100
"""Components of a demand beyond this are all the same [N], [N m]: the squares of the forces stay finite."""
EXACT, MISSED, FORBIDDEN_FORCE = int(Status.EXACT), int(Status.MISSED), int(Status.FORBIDDEN_FORCE)


def least_squares(inverse, demand, asked):
    """``A^+ F`` into asked (m,) [N].

    Args:
        inverse: A^+ (m, n).
        demand: F (n,) [N, N m].
        asked: out.
    """
    for i in range(len(asked)):
        asked[i] = 0.0
        for a in range(len(demand)):
            asked[i] += inverse[i, a] * min(max(demand[a], -LARGEST_DEMAND), LARGEST_DEMAND)


def clip(limits, allow_off, asked, force):
    """Cut forces off at saturation; inside the dead zone thrusters rest, or move to the nearer edge.

    Args:
        limits: (m, 4) [N].
        allow_off: whether thrusters may rest.
        asked: (m,) [N].
        force: (m,) out [N].
    """
    for i in range(len(asked)):
        low, edge_low, edge_high, high = limits[i, 0], limits[i, 1], limits[i, 2], limits[i, 3]
        f = min(max(asked[i], low), high)
        if edge_low < f < edge_high:
            nearer = edge_low if f - edge_low < edge_high - f else edge_high
            f = 0.0 if allow_off else nearer
        force[i] = f


def contract(limits, allow_off, rounding, asked, force):
    """Cut the dead zone out of each thruster's axis; arguments as in `clip`, rounding [N] counts as no force asked."""
    for i in range(len(asked)):
        low, edge_low, edge_high, high = limits[i, 0], limits[i, 1], limits[i, 2], limits[i, 3]
        f = asked[i] + (edge_low if asked[i] < 0.0 else edge_high)
        if allow_off and abs(asked[i]) <= rounding:
            f = 0.0
        force[i] = min(max(f, low), high)


def compensate(limits, regime, direction, asked, force):
    """Lift every thruster over its dead zone by the least share of a regime, mirrored where only that has room.

    Args:
        limits: (m, 4) [N].
        regime: (m,) [N].
        direction: (1,) 1 or -1, which way round the regime runs; changed where it is mirrored.
        asked: (m,) [N].
        force: (m,) out [N].
    """
    way, lift, room = direction[0], 0.0, False
    for turn in range(2):
        if room:
            continue
        sign, least, most, moved = (direction[0] if turn == 0 else -direction[0]), 0.0, 0.0, False
        for i in range(len(asked)):
            r = sign * regime[i]
            if r != 0.0:
                near, far = (limits[i, 2], limits[i, 3]) if r > 0.0 else (limits[i, 1], limits[i, 0])
                least = max(least, (near - asked[i]) / r)
                most = min(most, (far - asked[i]) / r) if moved else (far - asked[i]) / r
                moved = True
        room = least <= most
        if room or turn == 0:
            way, lift = sign, least
    direction[0] = way
    for i in range(len(asked)):
        low, edge_low, edge_high, high = limits[i, 0], limits[i, 1], limits[i, 2], limits[i, 3]
        r = way * regime[i]
        f = asked[i] + lift * r
        f = min(max(f, edge_high if r > 0.0 else low), edge_low if r < 0.0 else high)
        force[i] = 0.0 if edge_low < f < edge_high else f


def assess(A, limits, allow_off, forces, length_m, tolerance, demand, force, wrench, error, sides):
    """Say what forces are worth against a demand.

    Args:
        A: (n, m).
        limits: (m, 4) [N].
        allow_off: whether thrusters may rest.
        forces: number of leading components of a wrench that are forces.
        length_m: what torques are divided by [m].
        tolerance: force that counts as none, and residual that counts as made [N].
        demand: (n,) [N, N m].
        force: (m,) [N].
        wrench: (n,) out, of the forces.
        error: (n,) out, demanded minus made.
        sides: (m,) out.

    Returns:
        Residual [N], cost [N^2] and status.
    """
    cost, allowed, largest = 0.0, True, 0.0
    for i in range(len(force)):
        f, low, edge_low = force[i], limits[i, 0], limits[i, 1]
        edge_high, high = limits[i, 2], limits[i, 3]
        rests = allow_off and abs(f) <= tolerance
        moves = low - tolerance <= f <= edge_low + tolerance or edge_high - tolerance <= f <= high + tolerance
        allowed = allowed and (moves or rests)
        sides[i] = 0 if rests or f == 0.0 else (1 if f > 0.0 else -1)
        cost += f * f
    for a in range(len(demand)):
        made = 0.0
        for i in range(len(force)):
            made += A[a, i] * force[i]
        wrench[a], error[a] = made, demand[a] - made
        size = abs(error[a]) if a < forces else abs(error[a]) / length_m
        largest = max(largest, min(size, LARGEST_ERROR_N))
    square = 0.0
    if largest > 0.0:
        for a in range(len(demand)):
            size = abs(error[a]) if a < forces else abs(error[a]) / length_m
            share = min(size, LARGEST_ERROR_N) / largest
            square += share * share  # a power is rounded otherwise by Python than by compiled code
    residual = largest * sqrt(square)
    if not allowed:
        return residual, cost, FORBIDDEN_FORCE
    return residual, cost, EXACT if residual <= tolerance else MISSED
