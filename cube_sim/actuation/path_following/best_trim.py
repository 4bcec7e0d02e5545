"""The trim conditions of a course in which the thrusters have most to spare, searched for over all attitudes."""

from __future__ import annotations

import numpy as np

from cube_sim.actuation.attainable.attainable_set import AttainableSet
from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.actuation.path_following.trim import CourseAttitudes, TrimCondition, conditions_at, rotations
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.axes import Matrix, Vector

_COARSE_FREE, _COARSE_RESTRICTED, _HEADINGS = 3000, 1000, 375
_STARTS = 24
_APART_RAD = np.radians(20.0)
_ROUNDS = 60
_WIDEST_RAD = 0.3
_WIDER, _CLOSER = 2.0, 0.5
_WORTH = 5e-4
"""A turn that promises less of a gain than this is not worth making."""
_BEHIND = 0.9
"""Where a turn does not promise this much of the best share so far, the search ends."""
_NO_OFFSET = 1e-10


def best_trims(
    hull: Dynamics, actuation: Subspaces, attainable: AttainableSet, speed_m_s: float, inclination_rad: float
) -> tuple[TrimCondition, ...]:
    """Local maxima over all attitudes of the share of a course's wrench that thrusters attain, the largest first.

    Where the thrusters produce all components, nothing but the limits restricts the attitude. Where some are missing,
    only attitudes count in which the wrench does without them; each that is looked at is moved to the nearest such.
    The search starts from the best of some thousand attitudes spread over SO(3) and from the best of those well apart
    from it. It goes uphill by linear programmes: the share is that of the facet that gives least, and each facet's is
    linear for small turns.

    Args:
        hull: the body.
        actuation: of the thrusters that are left; 3 components are motion in the plane.
        attainable: the wrenches they attain.
        speed_m_s: speed over the course.
        inclination_rad: angle of the course above the horizontal.

    Returns:
        They need not be within the limits. There are none when the wrench can be produced in no attitude.
    """
    attitudes = CourseAttitudes.on(hull, actuation, speed_m_s, inclination_rad)
    # How much of each facet's offset is used, per newton and newton metre.
    least = _NO_OFFSET * np.max(attainable.offsets, initial=0.0)
    use = attainable.normals / np.maximum(attainable.offsets, least)[:, None]

    def nearest(R: Matrix) -> tuple[Matrix, Vector]:
        """The nearest attitudes in trim, and their shares; -1 where there is none."""
        R, in_trim = attitudes.trimmed(R)
        used = np.max(attitudes.wrenches(R) @ use.T, axis=1, initial=np.finfo(float).tiny)
        return R, np.where(in_trim, 1.0 / used, -1.0)

    W = actuation.axes.scale(actuation.length_m)
    R, shares = nearest(_everywhere(attitudes))
    starts = _well_apart(W * attitudes.wrenches(R), shares)
    R, shares = R[starts], shares[starts]
    within = np.full(len(R), _WIDEST_RAD if len(use) else 0.0)
    for _ in range(_ROUNDS):
        moving = np.flatnonzero(within)
        if not len(moving):
            break
        used, slopes = attitudes.wrenches(R[moving]) @ use.T, attitudes.slopes(R[moving])
        steps = [
            _uphill(u, use @ slope, attitudes.unreachable @ slope, most)
            for u, slope, most in zip(used, slopes, within[moving], strict=True)
        ]
        tried, found = nearest(attitudes.turned(R[moving], np.array([turn for turn, _ in steps])))
        better, gains = found > shares[moving], np.array([gain for _, gain in steps])
        promising = (gains > 1.0 + _WORTH) & (gains * shares[moving] > _BEHIND * np.max(shares))
        within[moving] *= np.where(better, _WIDER, _CLOSER) * promising
        R[moving[better]], shares[moving[better]] = tried[better], found[better]
    return conditions_at(attitudes, R[np.argsort(-shares, kind="stable")], actuation, inclination_rad)


def _uphill(used: Vector, slopes: Matrix, keeping: Matrix, most: float) -> tuple[Vector, float]:
    """The turn that lowers the largest use of a facet's offset the most, and by which factor it promises to.

    Args:
        used: (p,) of each facet.
        slopes: (p,k) its derivatives by the turn.
        keeping: (d,k) derivatives of what must stay as it is.
        most: the largest angle about each axis [rad].
    """
    from scipy.optimize import Bounds, LinearConstraint, milp

    largest, k = float(np.max(used)), slopes.shape[1]
    # Unknown are the turn in units of the largest, the largest use in units of what it is, and 1.
    rows = np.column_stack([slopes * most, np.full(len(used), -largest), used])
    kept = np.pad(keeping, ((0, 0), (0, 2)))
    found = milp(
        np.eye(1, k + 2, k)[0],
        constraints=[
            LinearConstraint(rows / _largest(rows), -np.inf, 0.0),
            LinearConstraint(kept / _largest(kept), 0.0, 0.0),
        ],
        bounds=Bounds(np.r_[-np.ones(k), -np.inf, 1.0], np.r_[np.ones(k), np.inf, 1.0]),
        options={"presolve": False},
    )
    return (np.zeros(k), 1.0) if found.x is None else (most * found.x[:k], 1.0 / max(found.x[k], _NO_OFFSET))


def _largest(rows: Matrix) -> Matrix:
    """(p,1) the largest number of each row, to scale it by."""
    return np.maximum(np.max(np.abs(rows), axis=1, keepdims=True), np.finfo(float).tiny)


def _well_apart(wrenches: Matrix, shares: Vector) -> list[int]:
    """Indices of the best of wrenches (q,n), then of the best whose direction is well apart from all so far."""
    directions = wrenches / np.maximum(np.linalg.norm(wrenches, axis=1, keepdims=True), np.finfo(float).tiny)
    left, chosen = np.argsort(-shares, kind="stable")[: np.count_nonzero(shares >= 0.0)], []
    while len(left) and len(chosen) < _STARTS:
        chosen.append(int(left[0]))
        left = left[directions[left] @ directions[left[0]] < np.cos(_APART_RAD)]
    return chosen


def _everywhere(attitudes: CourseAttitudes) -> Matrix:
    """(q,3,3) all headings in the plane, all attitudes in space: super-Fibonacci spirals (Alexa, CVPR 2022)."""
    from scipy.spatial.transform import Rotation

    if len(attitudes.turns) == 1:
        return rotations(np.linspace(0.0, 2.0 * np.pi, _HEADINGS, endpoint=False)[:, None] * attitudes.turns)
    count = _COARSE_RESTRICTED if len(attitudes.unreachable) else _COARSE_FREE
    s = np.arange(count) + 0.5
    inner, outer = np.sqrt(s / count), np.sqrt(1.0 - s / count)
    alpha, beta = 2.0 * np.pi * s / np.sqrt(2.0), 2.0 * np.pi * s / 1.533751168755204288118041
    spiral = [inner * np.sin(alpha), inner * np.cos(alpha), outer * np.sin(beta), outer * np.cos(beta)]
    return Rotation.from_quat(np.column_stack(spiral)).as_matrix()
