"""Compensation of the dead zone, the second strategy of Ropars et al. (Ocean Engineering 151, 2018)."""

from __future__ import annotations

import itertools
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.allocation import Allocation
from cube_sim.allocation.baselines.model import Judge
from cube_sim.allocation.exact.active_set import OPTIMAL, project
from cube_sim.allocation.previous import Standing

STILL = 1e-6
"""Part of a motor in the unit kernel below which no regime of sensible size moves it."""

_EXHAUSTIVE = 4
"""Kernels beyond this dimension have too many sectors to look through."""


class Compensation:
    """``f = A^+ F + lambda r``: a common regime r in ker A keeps every motor out of its dead zone, at zero wrench.

    r is the least regime that moves every motor by at least 1 N, but for motors that have no part in ker A: those
    rest where they would stand in their dead zone. lambda is the smallest that lifts every motor over
    its dead zone onto the side r pushes it to; the regime is mirrored only when that side no longer has room, so
    motors hardly ever reverse. When neither has room, the forces are cut off at the limits and the wrench is missed.
    For a vehicle with r = (1, 1, 1, 1) there is room if and only if
    ``max(A^+ F) - min(A^+ F) <= F_max+ - F_DZ+``.

    Args:
        A: see `Allocator`.
        limits: see `Allocator`.
        allow_off: see `Allocator`; this method lets no motor rest that a regime can move.
        power_coefficients: see `Allocator`.

    Attributes:
        regime: (m,) r [N].
    """

    def __init__(
        self,
        A: ArrayLike,
        limits: ArrayLike,
        *,
        allow_off: bool = True,
        power_coefficients: ArrayLike | None = None,
    ) -> None:
        self._judge = Judge(A, limits, allow_off, power_coefficients)
        self.regime = common_regime(self._judge.kernel)
        self._direction = 1.0

    def reset(self) -> None:
        """Forget which way round the regime ran."""
        self._direction = 1.0

    def resume(self, standing: Standing) -> None:
        """Run the regime the way round that more of the motors' last pushes agree with."""
        self._direction = -1.0 if np.sign(self.regime) @ standing.push < 0.0 else 1.0

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """Find the forces for one demanded wrench (n,)."""
        demand, finite = self._judge.demand(wrench)
        asked = self._judge.least(demand)
        low, edge_low, edge_high, high = self._judge.limits.T
        least, most = self._room(asked, self._direction)
        if least > most:
            mirrored_least, mirrored_most = self._room(asked, -self._direction)
            if mirrored_least <= mirrored_most:
                self._direction, least = -self._direction, mirrored_least
        regime = self._direction * self.regime
        force = asked + least * regime
        forward, backward = regime > 0.0, regime < 0.0
        force = np.clip(force, np.where(forward, edge_high, low), np.where(backward, edge_low, high))
        force = np.where((force > edge_low) & (force < edge_high), 0.0, force)
        return self._judge.judge(demand, finite, force)

    def _room(self, asked: NDArray[np.float64], direction: float) -> tuple[float, float]:
        """The smallest and the largest lambda >= 0 that keep every moved motor on the regime's side of it."""
        moved = self.regime != 0.0
        if not moved.any():
            return 0.0, 0.0
        low, edge_low, edge_high, high = self._judge.limits[moved].T
        asked, regime = asked[moved], direction * self.regime[moved]
        near, far = np.where(regime > 0.0, edge_high, edge_low), np.where(regime > 0.0, high, low)
        return max(0.0, float(np.max((near - asked) / regime))), float(np.min((far - asked) / regime))


def common_regime(kernel: NDArray[np.float64]) -> NDArray[np.float64]:
    """The regime of least ``|r|`` in ker A that moves every motor the kernel can move by at least 1 N.

    Every way of choosing directions that the kernel offers is looked at: with k degrees of freedom the motors cut the
    kernel into sectors, and each sector is next to a direction in which k - 1 motors stand still. Beyond 4 degrees of
    freedom only the sectors around sums of the basis vectors are.

    Args:
        kernel: (m, k) orthonormal basis of ker A.

    Returns:
        (m,) r, 0 for motors that have no part in ker A; all 0 when no such regime exists.
    """
    m, k = kernel.shape
    movable = np.linalg.norm(kernel, axis=1) >= STILL
    if not movable.any():
        return np.zeros(m)
    rows = np.ascontiguousarray(kernel[movable])
    best = np.zeros(m)
    for pattern in sorted(_patterns(rows), reverse=True):  # of mirror images, the one whose first motor pushes forward
        point, multiplier = np.empty(k), np.empty(len(rows))
        pushed = np.ascontiguousarray(np.array(pattern)[:, None] * rows)
        ends = np.ones(len(rows)), np.full(len(rows), inf)
        if project(pushed, *ends, np.zeros(k), inf, 1e-12, point, multiplier) == OPTIMAL:
            regime = np.where(movable, kernel @ point, 0.0)
            if not best.any() or regime @ regime < best @ best * (1.0 - 1e-9):
                best = regime
    return best


def _patterns(rows: NDArray[np.float64]) -> set[tuple[int, ...]]:
    """Directions (+1 or -1 per row) in which points of the kernel move the motors."""
    count, k = rows.shape
    if k > _EXHAUSTIVE:
        mixes = np.array(list(itertools.product((1.0, -1.0), repeat=k)))
        return {tuple(np.where(moved < 0.0, -1, 1).tolist()) for moved in mixes @ rows.T}
    patterns = set()
    for standing in itertools.combinations(range(count), k - 1):
        _, sigma, Vt = np.linalg.svd(np.vstack([rows[list(standing)], np.zeros((1, k))]))
        if k > 1 and sigma[k - 2] < STILL:
            continue
        moved = rows @ Vt[-1]
        undecided = np.flatnonzero(np.abs(moved) < 1e-9)
        for way in (1.0, -1.0):
            pattern = np.where(way * moved < 0.0, -1, 1)
            for signs in itertools.product((1, -1), repeat=min(len(undecided), 10)):
                pattern[undecided[:10]] = signs
                patterns.add(tuple(pattern.tolist()))
    return patterns
