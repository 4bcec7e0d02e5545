"""From a demanded wrench to forces that make it, or what can be made of it, dead zones aside.

An origin is one force vector of the wrench that is to be made. All others are the origin plus the null space of A.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.closest_wrench import closest_wrenches
from cube_sim.allocation.exact.largest_share import largest_share
from cube_sim.allocation.exact.presolve import fix_thrusters, reduce_goal
from cube_sim.allocation.exact.problem import ClosestWrenchData
from cube_sim.allocation.exact.solutions import ForceSolutions, WrenchMetric
from cube_sim.allocation.exact.step import StepLimits, intervals_of
from cube_sim.native.compiled import compiled, inlined

FAR = 1e3
"""Parts of a demand longer than this many times the largest wrench are shortened where only their direction counts."""

FARTHEST = 1e7
"""Components of a demand up to this many times the largest wrench count as they are.

Beyond, those longer than `FAR` times the largest wrench are shortened in one ratio, though not below that, and the
others count as they are. What a direction rounded to double precision makes across itself is then not taken for
authority there. The closest wrench stays the same where no thruster makes both a long and a short component, and
elsewhere nearly always; the answer then counts as not proven."""


@compiled
def attainable_origin(
    solutions: ForceSolutions,
    largest_wrench: float,
    tolerance: float,
    demand: NDArray[np.float64],
    origin: NDArray[np.float64],
) -> bool:
    """Write the least forces that make the demand, limits aside.

    Args:
        solutions: of the vehicle.
        largest_wrench: see `AllocationProblem`.
        tolerance: force that counts as rounding [N].
        demand: (n,) finite.
        origin: (m,) out [N].

    Returns:
        False when forces of no size make the demand, or it is more than the vehicle can make.
    """
    n, m = demand.shape[0], origin.shape[0]
    for a in range(n):
        if abs(demand[a]) > 2.0 * largest_wrench:
            return False
    for b in range(n):
        outside = 0.0
        for a in range(n):
            outside += solutions.outside_range[b, a] * demand[a]
        if abs(outside) > tolerance:
            return False
    for i in range(m):
        force = 0.0
        for a in range(n):
            force += solutions.particular[i, a] * demand[a]
        origin[i] = force
    return True


@inlined
def share_origin(
    closest: ClosestWrenchData,
    largest_wrench: float,
    limits: StepLimits,
    primary: NDArray[np.float64],
    secondary: NDArray[np.float64],
    origin: NDArray[np.float64],
    part: NDArray[np.float64],
) -> tuple[float, int, bool]:
    """Forces for the primary wrench and the largest attainable share of the secondary one.

    What forces of no size can make is left out of both first. Where no share is attainable, not even 0, the forces
    are those of the primary wrench alone.

    Args:
        closest: of the vehicle, with facets.
        largest_wrench: see `AllocationProblem`.
        limits: sides of this call.
        primary: (n,) finite.
        secondary: (n,) finite; one far beyond the largest wrench counts as a shorter one of the same direction.
        origin: (m,) out: forces making it, limits aside [N].
        part: (n,) out: ``primary + share * secondary``.

    Returns:
        The share, negative for none; nodes looked at; whether the answer is proven.
    """
    n, m = primary.shape[0], origin.shape[0]
    metric, facets = closest.metric, closest.facets
    r, h = facets.shape[1], facets.shape[0]
    short, short_primary = shortening(largest_wrench, secondary), shortening(largest_wrench, primary)
    first = metric_coordinates(metric, primary, short_primary)
    second = metric_coordinates(metric, secondary, short)
    base, across, gain = np.zeros(h), np.zeros(h), np.zeros((h, m))
    size = 0.0
    for f in range(h):
        for b in range(r):
            base[f] += facets[f, b] * first[b]
            across[f] += facets[f, b] * second[b]
            for i in range(m):
                gain[f, i] += facets[f, b] * metric.G[b, i]
        for i in range(m):
            size = max(size, abs(gain[f, i]))
    rounding = 1e-3 * size * limits.tolerance  # well below what the search for the forces counts as rounding
    found, proven, nodes = -1.0, True, 0
    if short_primary == 1.0:
        found, proven, nodes = largest_share(base, across, gain, intervals_of(limits, 0), rounding)
    share = max(found, 0.0)
    for i in range(m):
        origin[i] = 0.0
        for b in range(r):
            origin[i] += metric.G_pinv[i, b] * (first[b] + second[b] * share)
    for a in range(n):
        part[a] = primary[a] + secondary[a] * short * share
    return found, nodes, proven


@inlined
def nearest_origins(
    A: NDArray[np.float64],
    metric: WrenchMetric,
    solutions: ForceSolutions,
    largest_wrench: float,
    limits: StepLimits,
    hidden: float,
    demand: NDArray[np.float64],
) -> tuple[NDArray[np.float64], int, int, bool]:
    """Forces making the wrenches closest to a demand.

    Args:
        A: (n, m).
        metric: of the vehicle.
        solutions: of the vehicle.
        largest_wrench: see `AllocationProblem`.
        limits: sides of this call.
        hidden: see `AllocationProblem`.
        demand: (n,) finite.

    Returns:
        (c, m) forces, one row per distinct wrench, first the equally closest, then those as close but for A's rounding.
        When every projection stalled: the one row of the pseudo-inverse, to be moved to allowed sides. Then how many
        are the closest, nodes looked at, and whether the answer is proven.
    """
    n, m = A.shape
    wanted, bounds, descent, fixed = np.empty(n), np.empty((m, 2)), np.empty(m), np.empty(m, np.bool_)
    straight = shorten_components(largest_wrench, demand, wanted)
    intervals, goal = intervals_of(limits, 0), metric_coordinates(metric, wanted, 1.0)
    if fix_thrusters(A, metric, intervals, wanted, bounds, descent, fixed) > 0:
        reduce_goal(metric.G, bounds, descent, fixed, goal)
    candidates, count, proven, nodes = closest_wrenches(goal, metric, intervals, bounds, limits.tolerance, hidden)
    if candidates.shape[0] == 0:
        candidates, count, proven = np.zeros((1, m)), 1, False
        for i in range(m):
            for a in range(n):
                candidates[0, i] += solutions.particular[i, a] * wanted[a]
    return candidates, count, nodes, proven and straight


@compiled
def shorten_components(largest_wrench: float, demand: NDArray[np.float64], wanted: NDArray[np.float64]) -> bool:
    """Write a demand (n,) whose components may have any size into ``wanted`` (n,), as `FARTHEST` says.

    Returns:
        Whether it still has the direction it had.
    """
    size, straight = 0.0, True
    for a in range(demand.shape[0]):
        size = max(size, abs(demand[a]))
    most, kept = FARTHEST * max(largest_wrench, 1e-12), FAR * max(largest_wrench, 1e-12)
    scale = most / size if size > most else 1.0
    for a in range(demand.shape[0]):
        length = max(abs(demand[a]) * scale, min(abs(demand[a]), kept))
        straight = straight and length == abs(demand[a]) * scale
        wanted[a] = math.copysign(length, demand[a])
    return straight


@compiled
def shortening(largest_wrench: float, demand: NDArray[np.float64]) -> float:
    """Factor that shortens a demand (n,) far beyond the largest wrench, so that no product overflows; else 1."""
    size = 0.0
    for a in range(demand.shape[0]):
        size = max(size, abs(demand[a]))
    limit = FAR * max(largest_wrench, 1e-12)
    return limit / size if size > limit else 1.0


@compiled
def metric_coordinates(metric: WrenchMetric, demand: NDArray[np.float64], scale: float) -> NDArray[np.float64]:
    """Coordinates s (r,) of `WrenchMetric` of a scaled demand (n,): what forces of no size make is left out."""
    goal = np.zeros(metric.basis.shape[1])
    for b in range(goal.shape[0]):
        for a in range(demand.shape[0]):
            goal[b] += metric.basis[a, b] * metric.weights[a] * (demand[a] * scale)
    return goal
