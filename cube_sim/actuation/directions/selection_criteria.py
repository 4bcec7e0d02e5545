"""The three selection criteria of the report's section 4.2: which directions are worth using.

All three run on W A, torques divided by a length: a cost is newtons of thruster force (2-norm over the thrusters) per
newton of wrench. They use every direction that is not zero to rounding. No rank tolerance hides a costly direction: it
is listed with its cost, and `Directions.within_cost_limit` drops it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.actuation.directions.threshold import Threshold
from cube_sim.errors import ActuationError
from cube_sim.wrench.axes import Matrix, Vector, WrenchAxes
from cube_sim.wrench.matrix import actuation_matrix, lever_arm, positive_length
from cube_sim.wrench.tolerances import RANK_ROUNDING

_EXACT = 1e-9


@dataclass(frozen=True)
class Directions:
    """Orthonormal directions of the scaled wrench space and what a unit wrench along each costs, least costly first.

    Attributes:
        axes: what the wrench components are.
        length_m: the length torques were divided by [m].
        vectors: (n,d) columns v_j, orthonormal, in scaled components W F_B.
        gains: (d,) sigma_j = sqrt(lambda_j) of A A^T: wrench per thruster-force norm [N/N].
    """

    axes: WrenchAxes
    length_m: float
    vectors: Matrix
    gains: Vector

    @property
    def costs(self) -> Vector:
        """(d,) 1/sigma_j [N/N]: the exact least thruster-force norm of a unit wrench along v_j."""
        return 1.0 / self.gains

    @property
    def wrenches(self) -> Matrix:
        """(n,d) the same directions as physical wrenches W^-1 v_j [N, N m]: one scaled newton each."""
        return self.vectors / self.axes.scale(self.length_m)[:, None]

    @property
    def projector(self) -> Matrix:
        """(n,n) W^-1 V V^T W: what of a wrench F_B lies along these directions."""
        W = self.axes.scale(self.length_m)
        return self.vectors @ self.vectors.T * W / W[:, None]

    def coordinates(self, wrench: ArrayLike) -> Vector:
        """(d,) V^T W F_B [N]: a wrench F_B (n,) [N, N m] in the basis (v_1..v_d)."""
        return self.vectors.T @ (self.axes.scale(self.length_m) * np.asarray(wrench, dtype=float))

    def least_costly(self, count: int) -> Directions:
        """The `count` directions that cost least."""
        return Directions(self.axes, self.length_m, self.vectors[:, :count], self.gains[:count])

    def within_cost_limit(self, cost_limit: float) -> Directions:
        """The directions whose cost does not exceed the limit [N/N]: those a controller should be built on.

        Raises:
            ActuationError: the limit is not positive.
        """
        return self.least_costly(Threshold.of(cost_limit=cost_limit).rank(self.gains))


def first_approach(A: ArrayLike, P: ArrayLike | None = None, *, length_m: float | None = None) -> Vector:
    """Gains (rank,) of the reachable rows of P A [N/N], section 4.2.1: P orthogonal, I - A A^+ = P^T D P.

    The report calls the norms of the last rank(A) rows of P A a cost. They are gains: small where motion is costly.
    Any rotation inside the reachable rows of P changes them. With the left singular vectors, the default, they are the
    singular values, and each is 1 / cost of `final_approach`.

    Args:
        A: (6,m) or (3,m).
        P: (n,n) orthogonal, its first n - rank rows spanning the unreachable wrenches in scaled components.
        length_m: what torques are divided by [m]; default the rms lever arm.

    Raises:
        ActuationError: A is malformed, or P is not such a matrix.
    """
    scaled, _, _ = _scaled(A, length_m)
    U, sigma, _ = np.linalg.svd(scaled)
    rank = _rank(sigma)
    n = len(U)
    default = np.vstack([U[:, rank:].T, U[:, :rank].T])
    chosen = default if P is None else np.asarray(P, dtype=float)
    if chosen.shape != (n, n) or np.max(np.abs(chosen @ chosen.T - np.eye(n))) > _EXACT:
        raise ActuationError(f"P must be an orthogonal {n} x {n} matrix")
    rows = chosen @ scaled
    if np.max(np.abs(rows[: n - rank]), initial=0.0) > _EXACT * max(sigma[0], 1.0):
        raise ActuationError(f"the first {n - rank} rows of P must be unreachable: P A has to vanish there")
    return np.linalg.norm(rows[n - rank :], axis=1)


def second_approach(A: ArrayLike, *, length_m: float | None = None) -> Vector:
    """Costs (n,) of the wrench components, c(F_j) = norm of column j of (W A)^+ [N/N], section 4.2.2.

    It is the least thruster-force norm that produces one scaled newton of component j and nothing else. It is infinite
    where the thrusters cannot isolate component j (the report, assuming full rank, leaves that case open).

    Args:
        A: (6,m) or (3,m).
        length_m: what torques are divided by [m]; default the rms lever arm.

    Raises:
        ActuationError: A or the length is malformed.
    """
    scaled, _, _ = _scaled(A, length_m)
    U, sigma, Vt = np.linalg.svd(scaled)
    rank = _rank(sigma)
    inverse = (Vt[:rank].T / sigma[:rank]) @ U[:, :rank].T
    costs = np.linalg.norm(inverse, axis=0)
    costs[np.linalg.norm(U[:, rank:], axis=1) > _EXACT] = np.inf
    return costs


def thruster_space(A: ArrayLike, *, length_m: float | None = None) -> Matrix:
    """Q (m,m) orthogonal with A^+ A = Q^T diag(0.., 1..) Q, the zeros first (section 4.2.2).

    The first m - rank rows are combinations of thruster forces without effect: the least-norm solution has none of
    them. The printed Q of the report needs -0.6742 at (2,3) and -0.4956 at (4,4) to be orthogonal.

    Args:
        A: (6,m) or (3,m).
        length_m: what torques are divided by [m]; default the rms lever arm.

    Raises:
        ActuationError: A or the length is malformed.
    """
    scaled, _, _ = _scaled(A, length_m)
    _, sigma, Vt = np.linalg.svd(scaled)
    rank = _rank(sigma)
    return np.vstack([Vt[rank:], Vt[:rank]])


def final_approach(A: ArrayLike, *, length_m: float | None = None) -> Directions:
    """Eigenvectors v_j of (W A)(W A)^T with their costs 1/sqrt(lambda_j), section 4.2.3.

    The report bounds the cost by a multiple of 1/lambda_j; the norm of A^T v_j / lambda_j is exactly
    1/sqrt(lambda_j) = 1/sigma_j. Directions with lambda_j = 0 to rounding are unreachable and not listed.

    Args:
        A: (6,m) or (3,m).
        length_m: what torques are divided by [m]; default the rms lever arm.

    Raises:
        ActuationError: A or the length is malformed.
    """
    scaled, axes, length = _scaled(A, length_m)
    U, sigma, _ = np.linalg.svd(scaled)
    rank = _rank(sigma)
    return Directions(axes, length, _aligned(U[:, :rank], sigma[:rank]), sigma[:rank])


def _aligned(vectors: Matrix, gains: Vector) -> Matrix:
    """The same eigenspaces, those of equal gain spanned by vectors as near to the wrench axes as can be.

    Where gains are equal the singular vectors are any basis. The projected axes, the longest first, are one that a
    reader understands.
    """
    aligned = vectors.copy()
    start = 0
    for end in range(1, len(gains) + 1):
        if end == len(gains) or gains[start] - gains[end] > _EXACT * gains[start]:
            left = vectors[:, start:end] @ vectors[:, start:end].T
            for j in range(start, end):
                longest = int(np.argmax(np.linalg.norm(left, axis=0).round(9)))
                aligned[:, j] = left[:, longest] / np.linalg.norm(left[:, longest])
                left = left - np.outer(aligned[:, j], aligned[:, j] @ left)
            start = end
    return aligned


def _scaled(A: ArrayLike, length_m: float | None) -> tuple[Matrix, WrenchAxes, float]:
    matrix, axes = actuation_matrix(A)
    length = lever_arm(matrix, axes) if length_m is None else positive_length(length_m)
    return axes.scale(length)[:, None] * matrix, axes, length


def _rank(sigma: Vector) -> int:
    return int(np.count_nonzero(sigma > RANK_ROUNDING * sigma[0]))
