"""The attitudes in which thrusters that produce all components have most to spare for a course."""

from __future__ import annotations

import numpy as np

from cube_sim.actuation.attainable import Attainable
from cube_sim.actuation.courses import Course, course_velocity
from cube_sim.actuation.hull import Hull
from cube_sim.actuation.subspaces import Subspaces
from cube_sim.actuation.wrench_axes import Matrix

_COARSE = 3000
_STARTS = 8
_APART_RAD = np.radians(30.0)
_TRIES = 48
_ROUNDS = 100
_WIDEST_RAD = 0.3
_WIDER, _CLOSER = 1.5, 0.8


def best_attitudes(
    hull: Hull, actuation: Subspaces, reach: Attainable, speed_m_s: float, inclination_rad: float
) -> tuple[Course, ...]:
    """Local maxima over all attitudes of the share of a course's wrench that thrusters attain, the largest first.

    Nothing restricts the attitude of a body whose thrusters produce all components, so that it is sought by the share
    alone, which is continuous, but has kinks: the best of some thousand attitudes spread over SO(3) and the best of
    those well apart from it, each moved to the best of some attitudes about it, over and over: further ones after
    a success, closer ones after none.

    Args:
        hull: the body.
        actuation: of the thrusters that are left, of full rank; 3 components are motion in the plane.
        reach: what they attain.
        speed_m_s: speed over the course.
        inclination_rad: angle of the course above the horizontal.

    Returns:
        Not necessarily within the limits.
    """
    planar = len(actuation.matrix) == 3
    rows = [0, 1, 5] if planar else list(range(6))
    course_W = course_velocity(speed_m_s, inclination_rad)

    def wrenches(R: Matrix) -> Matrix:
        return hull.steady_wrenches(course_W @ R, R[:, 2])[:, rows]

    rng = np.random.default_rng(0)
    coarse = _headings() if planar else _spread()
    R = _well_apart(coarse, reach.share(wrenches(coarse)))
    shares = reach.share(wrenches(R))
    spreads = np.full(len(R), _WIDEST_RAD)
    for _ in range(_ROUNDS):
        turns = rng.uniform(-1.0, 1.0, (_TRIES, 3)) * ([0.0, 0.0, 1.0] if planar else 1.0)
        tried = R[:, None] @ _rotations((spreads[:, None, None] * turns).reshape(-1, 3)).reshape(len(R), -1, 3, 3)
        found = reach.share(wrenches(tried.reshape(-1, 3, 3))).reshape(len(R), -1)
        best = np.argmax(found, axis=1)
        better = found[np.arange(len(R)), best] > shares
        R[better], shares[better] = tried[better, best[better]], found[better, best[better]]
        spreads *= np.where(better, _WIDER, _CLOSER)
    order = np.argsort(-shares, kind="stable")
    return tuple(
        Course(inclination_rad, course_W @ R[i], R[i, 2], wrench, actuation.pseudo_inverse @ wrench)
        for i, wrench in zip(order, wrenches(R[order]), strict=True)
    )


def _well_apart(R: Matrix, shares: Matrix) -> Matrix:
    """The best of some rotations (q,3,3), then always the best of those well apart from all chosen so far."""
    left, chosen = np.argsort(-shares, kind="stable"), []
    while len(left) and len(chosen) < _STARTS:
        chosen.append(R[left[0]])
        cosine = (np.einsum("ij,qij->q", chosen[-1], R[left]) - 1.0) / 2.0
        left = left[cosine < np.cos(_APART_RAD)]
    return np.array(chosen)


def _rotations(vectors: Matrix) -> Matrix:
    """(q,3,3) exp(S(vector)) of vectors (q,3)."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(vectors).as_matrix()


def _headings() -> Matrix:
    return _rotations(np.outer(np.linspace(0.0, 2.0 * np.pi, _COARSE // 8, endpoint=False), [0.0, 0.0, 1.0]))


def _spread() -> Matrix:
    """(q,3,3) attitudes evenly over SO(3): super-Fibonacci spirals (Alexa, CVPR 2022)."""
    from scipy.spatial.transform import Rotation

    s = np.arange(_COARSE) + 0.5
    inner, outer = np.sqrt(s / _COARSE), np.sqrt(1.0 - s / _COARSE)
    alpha, beta = 2.0 * np.pi * s / np.sqrt(2.0), 2.0 * np.pi * s / 1.533751168755204288118041
    spiral = [inner * np.sin(alpha), inner * np.cos(alpha), outer * np.sin(beta), outer * np.cos(beta)]
    return Rotation.from_quat(np.column_stack(spiral)).as_matrix()
