"""Compensation of the dead zone, the second strategy of Ropars et al. (Ocean Engineering 151, 2018)."""

from __future__ import annotations

import itertools
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.allocation import Allocation
from cube_sim.allocation.baselines.model import BaselineModel, flown_by
from cube_sim.allocation.baselines.packing import COMPENSATION, unpack_baseline
from cube_sim.allocation.baselines.rules import compensate
from cube_sim.allocation.flown import FlownAllocator
from cube_sim.allocation.previous import PreviousForces

STILL = 1e-6
"""Part of a thruster in the unit kernel below which no regime of sensible size moves it."""

_EXHAUSTIVE = 4
"""Kernels beyond this dimension have too many sectors to look through."""


class Compensation:
    """``f = A^+ F + lambda r``: a common regime r in ker A keeps every thruster out of its dead zone, at zero wrench.

    r is the least regime that moves every thruster by at least 1 N, but for thrusters that have no part in ker A: those
    rest where their force would lie in their dead zone. lambda is the smallest that lifts every thruster over
    its dead zone onto the side r pushes it to; the regime is mirrored only when that side no longer has room, so
    thrusters hardly ever reverse. When neither has room, the forces are cut off at the limits and the wrench is missed.
    For a vehicle with r = (1, 1, 1, 1) there is room if and only if
    ``max(A^+ F) - min(A^+ F) <= F_max+ - F_DZ+``.

    Args:
        A: see `Allocator`.
        limits: see `Allocator`.
        allow_off: see `Allocator`; this method lets no thruster rest that a regime can move.

    Attributes:
        regime: (m,) r [N].
    """

    def __init__(self, A: ArrayLike, limits: ArrayLike, *, allow_off: bool = True) -> None:
        self._model = BaselineModel(A, limits, allow_off)
        self.regime = common_regime(self._model.kernel)
        self._packed = self._model.packed(COMPENSATION, self.regime)

    def reset(self) -> None:
        """Forget which way round the regime ran."""
        self._direction[0] = 1.0

    def resume(self, previous: PreviousForces) -> None:
        """Run the regime the way round that more of the thrusters' last pushes agree with."""
        self._direction[0] = -1.0 if np.sign(self.regime) @ previous.push < 0.0 else 1.0

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """Find the forces for one demanded wrench (n,)."""
        demand, finite = self._model.demand(wrench)
        asked = self._model.least_squares_forces(demand)
        force = np.empty_like(asked)
        compensate(self._model.limits, self.regime, self._direction, asked, force)
        return self._model.assess(demand, finite, force)

    def flown(self, two_parts: bool) -> FlownAllocator:
        """See `FlownAllocator`."""
        return flown_by(self._packed)

    def allocate_by_priority(self, primary: ArrayLike, secondary: ArrayLike) -> Allocation:
        """Find the forces for the sum of both parts (n,), which this method does not tell apart."""
        return self.allocate(self._model.sum_of_parts(primary, secondary))

    @property
    def _direction(self) -> NDArray[np.float64]:
        """Which way round the regime runs, (1,) 1 or -1."""
        return unpack_baseline(self._packed)[-1]


def common_regime(kernel: NDArray[np.float64]) -> NDArray[np.float64]:
    """The regime of least ``|r|`` in ker A that moves every thruster the kernel can move by at least 1 N.

    Every way of choosing directions that the kernel offers is looked at. With k degrees of freedom the thrusters cut
    the kernel into sectors, and each sector is next to a direction in which k - 1 thrusters are not moved. Beyond 4
    degrees of freedom only the sectors around sums of the basis vectors are looked at.

    Args:
        kernel: (m, k) orthonormal basis of ker A.

    Returns:
        (m,) r, 0 for thrusters that have no part in ker A; all 0 when no such regime exists.
    """
    from cube_sim.allocation.exact.active_set import OPTIMAL, project  # compiled, so loaded when first needed

    m, k = kernel.shape
    movable = np.linalg.norm(kernel, axis=1) >= STILL
    if not movable.any():
        return np.zeros(m)
    rows = np.ascontiguousarray(kernel[movable])
    best = np.zeros(m)
    # Of mirror images the one whose first thruster pushes forward comes first, and stays.
    for pattern in sorted(_patterns(rows), reverse=True):
        point, multiplier = np.empty(k), np.empty(len(rows))
        pushed = np.ascontiguousarray(np.array(pattern)[:, None] * rows)
        ends = np.ones(len(rows)), np.full(len(rows), inf)
        if project(pushed, *ends, np.zeros(k), inf, 1e-12, point, multiplier) == OPTIMAL:
            regime = np.where(movable, kernel @ point, 0.0)
            if not best.any() or regime @ regime < best @ best * (1.0 - 1e-9):
                best = regime
    return best


def _patterns(rows: NDArray[np.float64]) -> set[tuple[int, ...]]:
    """Directions (+1 or -1 per row) in which points of the kernel move the thrusters."""
    count, k = rows.shape
    if k > _EXHAUSTIVE:
        mixes = np.array(list(itertools.product((1.0, -1.0), repeat=k)))
        return {tuple(np.where(moved < 0.0, -1, 1).tolist()) for moved in mixes @ rows.T}
    patterns = set()
    for unmoved in itertools.combinations(range(count), k - 1):
        _, sigma, Vt = np.linalg.svd(np.vstack([rows[list(unmoved)], np.zeros((1, k))]))
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
