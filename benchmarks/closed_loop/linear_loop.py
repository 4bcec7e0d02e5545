"""The loop about steady motion: x+ = A x + B push + E drag, demand = C x."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig

from closed_loop.flown_loop import NOTHING, FlownLoop, Point
from cube_sim.spatial import Matrix, Vector

STEP = 1e-5
"""Of the central differences, in SI units."""
STEPS = 12
"""Of Newton's method, at most."""
MOST_TURNED = 0.3
"""By which one of them turns anything [rad]."""
FLOWN_S = 60.0
"""How long a loop is flown where Newton's method does not help [s]."""
SETTLED = 1e-5
"""Change over a tick that counts as none, as a share of what changes, or in SI units where that is below 1."""
NEUTRAL = 1e-6
"""How far from 1 an eigenvalue is still that of something that stays where it is: for hours."""
UNMOVED = 1e-4
"""Share of a motion that counts as none."""
HULL = 9
"""The first vectors of a point: place, velocity and rates of the hull."""


@dataclass(frozen=True)
class LinearLoop:
    """About a point of steady motion.

    Attributes:
        closed: A (n,n), the derivative of a tick of the closed loop.
        push: B (n,6), by a wrench that comes on top of the one demanded [1/N, 1/(N m)].
        drag: E (n,6), by a wrench on the hull.
        demand: C (6,n), of the wrench demanded [N, N m].
        directions: (6,r) wrenches that the thrusters can make [N, N m], orthonormal with torques over their lever arm;
            the axes of the body where they can make them all.
        period: control period [s].
        point: of steady motion.
        drift: largest change over a tick that is left there, as a share of what changes.
    """

    closed: Matrix
    push: Matrix
    drag: Matrix
    demand: Matrix
    directions: Matrix
    period: float
    point: Point
    drift: float

    @property
    def open(self) -> Matrix:
        """A - B C (n,n): the controller demands, and the thrusters make nothing of it."""
        return self.closed - self.push @ self.demand

    @property
    def spectral_radius(self) -> float:
        """The largest |eigenvalue| of the closed loop, without what may stay where it is.

        That is what no thruster can move, as the depth of a vehicle for the plane, and an estimate that nothing tells
        of and that does not move the hull, as that of a current along an axis without drag.
        """
        values, left, right = eig(self.closed, left=True)
        untouched = np.linalg.norm(left.conj().T @ self.push, axis=1) < UNMOVED * np.linalg.norm(self.push)
        hull = np.concatenate([right[:HULL], right[len(self.point.vectors) :][:3]])
        unmoved = np.linalg.norm(hull, axis=0) < UNMOVED * np.linalg.norm(right, axis=0)
        neutral = (np.abs(values - 1.0) < NEUTRAL) & (untouched | unmoved)
        return float(np.abs(values[~neutral]).max())


def linearised(loop: FlownLoop, near: Point | None = None) -> LinearLoop:
    """Find steady motion and differentiate there.

    Newton's method may find one that the loop leaves: where it does, or finds none, the loop is flown to where it goes.

    Args:
        loop: the map.
        near: where to begin; default the loop's start.
    """
    found = _about(loop, loop.start if near is None else near)
    if found.drift < SETTLED and found.spectral_radius < 1.0:
        return found
    return _about(loop, loop.flown(FLOWN_S))


def _about(loop: FlownLoop, point: Point) -> LinearLoop:
    """The derivative at the steady motion that Newton's method finds from a point."""
    for _ in range(STEPS):
        off = loop.tick(point, NOTHING)[0].step_from(point)
        if _share(off, point) < SETTLED:
            break
        closed, _ = _slopes(loop, point)
        by = np.linalg.lstsq(np.eye(len(off)) - closed, off, rcond=1e-9)[0]
        turned = np.abs(by[len(point.vectors) :]).max()
        point = point.moved(by * min(1.0, MOST_TURNED / max(turned, 1e-12)))
    closed, demand = _slopes(loop, point)
    off = loop.tick(point, NOTHING)[0].step_from(point)
    push = _by_wrench(lambda wrench: loop.tick(point, wrench)[0])
    drag = _by_wrench(lambda wrench: loop.tick(point, NOTHING, wrench)[0])
    arm = float(np.linalg.norm(loop.actuation[3:]) / np.linalg.norm(loop.actuation[:3]))
    scale = np.array([1.0] * 3 + [arm] * 3)
    U, gains, _ = np.linalg.svd(loop.actuation / scale[:, None])
    rank = int(np.count_nonzero(gains > 1e-6 * gains[0]))
    directions = scale[:, None] * (np.eye(6) if rank == 6 else U[:, :rank])
    return LinearLoop(closed, push, drag, demand, directions, loop.period, point, _share(off, point))


def _share(off: Vector, point: Point) -> float:
    """The largest change (n,), as a share of what changes."""
    sizes = np.ones(len(off))
    sizes[: len(point.vectors)] += np.abs(point.vectors)
    return float(np.abs(off / sizes).max())


def _slopes(loop: FlownLoop, point: Point) -> tuple[Matrix, Matrix]:
    """A (n,n) and C (6,n)."""
    n = len(point.vectors) + 3 * len(point.rotations)
    closed, demand = np.empty((n, n)), np.empty((6, n))
    for i, unit in enumerate(STEP * np.eye(n)):
        (ahead, demanded), (behind, less) = (
            loop.tick(point.moved(unit), NOTHING),
            loop.tick(point.moved(-unit), NOTHING),
        )
        closed[:, i] = ahead.step_from(behind) / (2.0 * STEP)
        demand[:, i] = (demanded - less) / (2.0 * STEP)
    return closed, demand


def _by_wrench(after: Callable[[Vector], Point]) -> Matrix:
    """(n,6) derivative of a point by a wrench."""
    pairs = [(after(STEP * unit), after(-STEP * unit)) for unit in np.eye(6)]
    return np.column_stack([ahead.step_from(behind) / (2.0 * STEP) for ahead, behind in pairs])
