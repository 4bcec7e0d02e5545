"""From a demanded wrench to forces that make it, or what can be made of it, their dead zones aside."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.closest_wrench import nearest
from cube_sim.allocation.exact.largest_share import largest_share
from cube_sim.allocation.exact.presolve import commit, felt
from cube_sim.allocation.exact.problem import Beyond
from cube_sim.allocation.exact.solutions import WrenchDistance, WrenchFibre
from cube_sim.allocation.exact.step import Tick, sides_of
from cube_sim.native.compiled import compiled, inlined

FAR = 1e3
"""Parts of a demand longer than this many times the reach are shortened where only their direction counts."""

FARTHEST = 1e7
"""Components of a demand up to this many times the reach count as they are. Beyond, those longer than `FAR` times the
reach are shortened in one ratio, though not below that, and the others count as they are: what a direction rounded to
double precision makes across itself is then not taken for authority there. The closest wrench stays the same where no
motor makes both a long and a short component, and elsewhere nearly always; the answer then counts as not proven."""


@compiled
def attainable_origin(
    fibre: WrenchFibre, reach: float, tolerance: float, demand: NDArray[np.float64], origin: NDArray[np.float64]
) -> bool:
    """Write the least forces making the demand, limits aside; False when no forces of any size can, or it is far.

    Args:
        fibre: of the vehicle.
        reach: see `Tables`.
        tolerance: force that counts as rounding [N].
        demand: (n,) finite.
        origin: (m,) out [N].
    """
    n, m = demand.shape[0], origin.shape[0]
    for a in range(n):
        if abs(demand[a]) > 2.0 * reach:
            return False
    for b in range(n):
        outside = 0.0
        for a in range(n):
            outside += fibre.unreachable[b, a] * demand[a]
        if abs(outside) > tolerance:
            return False
    for i in range(m):
        force = 0.0
        for a in range(n):
            force += fibre.particular[i, a] * demand[a]
        origin[i] = force
    return True


@inlined
def share_origin(
    far: Beyond,
    reach: float,
    tick: Tick,
    primary: NDArray[np.float64],
    secondary: NDArray[np.float64],
    origin: NDArray[np.float64],
    part: NDArray[np.float64],
) -> tuple[float, int, bool]:
    """Forces for the primary wrench and the largest attainable share of the secondary one.

    What no forces of any size can make is left out of both first. Where no share is attainable, not even 0, the
    forces are those of the primary wrench alone.

    Args:
        far: of the vehicle, with facets.
        reach: see `Tables`.
        tick: sides of this call.
        primary: (n,) finite.
        secondary: (n,) finite; one far beyond reach counts as a shorter one of the same direction.
        origin: (m,) out: forces making it, limits aside [N].
        part: (n,) out: ``primary + share * secondary``.

    Returns:
        The share, negative for none; nodes looked at; whether the answer is proven.
    """
    n, m = primary.shape[0], origin.shape[0]
    distance, facets = far.distance, far.facets
    r, h = facets.shape[1], facets.shape[0]
    short, short_primary = shortened(reach, secondary), shortened(reach, primary)
    first, goal = reachable(distance, primary, short_primary), reachable(distance, secondary, short)
    base, across, gain = np.zeros(h), np.zeros(h), np.zeros((h, m))
    size = 0.0
    for f in range(h):
        for b in range(r):
            base[f] += facets[f, b] * first[b]
            across[f] += facets[f, b] * goal[b]
            for i in range(m):
                gain[f, i] += facets[f, b] * distance.gain[b, i]
        for i in range(m):
            size = max(size, abs(gain[f, i]))
    rounding = 1e-3 * size * tick.tolerance  # well below what the search for the forces counts as rounding
    found, proven, nodes = -1.0, True, 0
    if short_primary == 1.0:
        found, proven, nodes = largest_share(base, across, gain, sides_of(tick, 0), rounding)
    share = max(found, 0.0)
    for i in range(m):
        origin[i] = 0.0
        for b in range(r):
            origin[i] += distance.spread[i, b] * (first[b] + goal[b] * share)
    for a in range(n):
        part[a] = primary[a] + secondary[a] * short * share
    return found, nodes, proven


@inlined
def nearest_origins(
    A: NDArray[np.float64],
    distance: WrenchDistance,
    fibre: WrenchFibre,
    reach: float,
    tick: Tick,
    demand: NDArray[np.float64],
) -> tuple[NDArray[np.float64], int, bool]:
    """Forces making the wrenches closest to a demand.

    Args:
        A: (n, m).
        distance: of the vehicle.
        fibre: of the vehicle.
        reach: see `Tables`.
        tick: sides of this call.
        demand: (n,) finite.

    Returns:
        (c, m) forces, one row per distinct equally close wrench; when every projection stalled, the one row of the
        pseudo-inverse, to be moved to allowed sides. Then nodes looked at, and whether the answer is proven.
    """
    n, m = A.shape
    wanted, span, pull, committed = np.empty(n), np.empty((m, 2)), np.empty(m), np.empty(m, np.bool_)
    straight = bring_near(reach, demand, wanted)
    sides, goal = sides_of(tick, 0), reachable(distance, wanted, 1.0)
    if commit(A, distance, sides, wanted, span, pull, committed) > 0:
        felt(distance.gain, span, pull, committed, goal)
    candidates, proven, nodes = nearest(goal, distance, sides, span, tick.tolerance)
    if candidates.shape[0] == 0:
        candidates, proven = np.zeros((1, m)), False
        for i in range(m):
            for a in range(n):
                candidates[0, i] += fibre.particular[i, a] * wanted[a]
    return candidates, nodes, proven and straight


@compiled
def bring_near(reach: float, demand: NDArray[np.float64], wanted: NDArray[np.float64]) -> bool:
    """Write a demand (n,) whose components may have any size into ``wanted`` (n,), as `FARTHEST` says.

    Returns:
        Whether it still has the direction it had.
    """
    size, straight = 0.0, True
    for a in range(demand.shape[0]):
        size = max(size, abs(demand[a]))
    most, kept = FARTHEST * max(reach, 1e-12), FAR * max(reach, 1e-12)
    scale = most / size if size > most else 1.0
    for a in range(demand.shape[0]):
        length = max(abs(demand[a]) * scale, min(abs(demand[a]), kept))
        straight = straight and length == abs(demand[a]) * scale
        wanted[a] = math.copysign(length, demand[a])
    return straight


@compiled
def shortened(reach: float, demand: NDArray[np.float64]) -> float:
    """Factor that makes a demand (n,) far beyond reach shorter, so that no product overflows; else 1."""
    size = 0.0
    for a in range(demand.shape[0]):
        size = max(size, abs(demand[a]))
    limit = FAR * max(reach, 1e-12)
    return limit / size if size > limit else 1.0


@compiled
def reachable(distance: WrenchDistance, demand: NDArray[np.float64], scale: float) -> NDArray[np.float64]:
    """Coordinates s (r,) of `WrenchDistance` of a scaled demand (n,), what no forces of any size can make left out."""
    goal = np.zeros(distance.basis.shape[1])
    for b in range(goal.shape[0]):
        for a in range(demand.shape[0]):
            goal[b] += distance.basis[a, b] * distance.weights[a] * (demand[a] * scale)
    return goal
