"""What A can produce and what it cannot: rank, range, kernel, projector, all solutions (the report's section 4.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.actuation.directions.lost_combinations import Combination, combinations
from cube_sim.actuation.directions.threshold import Threshold
from cube_sim.errors import ActuationError
from cube_sim.wrench.axes import Matrix, Vector, WrenchAxes
from cube_sim.wrench.matrix import actuation_matrix, lever_arm, positive_length

_EXACT = 1e-6


@dataclass(frozen=True)
class Solutions:
    """All thruster forces with A F_m = F_B: particular + kernel lambda.

    Attributes:
        particular: (m,) A^+ F_B [N], the one of least norm.
        kernel: (m,k) orthonormal basis r_1..r_k of ker A.
        unreachable: (n,) [N, N m] the part of F_B no forces produce; zero when F_B is in the range.
    """

    particular: Vector
    kernel: Matrix
    unreachable: Vector

    def force(self, parameters: ArrayLike) -> Vector:
        """F_m (m,) [N] at kernel coordinates lambda (k,) [N]."""
        return self.particular + self.kernel @ np.asarray(parameters, dtype=float)


@dataclass(frozen=True)
class Subspaces:
    """The four subspaces of one actuation matrix, with W = diag(1.., 1/L..) making all components newtons.

    Attributes:
        matrix: A (n,m).
        axes: what the rows are.
        length_m: L, the length torques are divided by [m].
        singular_values: (min(n,m),) of W A, descending [1].
        threshold: which of them count.
        rank: how many do; range, kernel, projector and the rest speak of these.
        range_basis: (n,rank) wrenches [N, N m] spanning range(A); orthonormal after scaling by W.
        kernel_basis: (m,m-rank) orthonormal thruster forces [1] without effect, or with one that does not count.
        pseudo_inverse: (m,n) (W A)^+ W with A cut to its rank: the least-norm forces of a wrench.
        projector: (n,n) W^-1 (W A)(W A)^+ W onto range(A).
        unreachable: n - rank independent combinations of F_B that are zero, or as good as zero, for every F_m.
        pure_forces: (forces,p) orthonormal directions of the forces producible with zero torque [1].
        pure_torques: (n-forces,q) orthonormal directions of the torques producible with zero force [1].
        isolated: (n,) which components can be produced with all others zero.
    """

    matrix: Matrix
    axes: WrenchAxes
    length_m: float
    singular_values: Vector
    threshold: Threshold
    rank: int
    range_basis: Matrix
    kernel_basis: Matrix
    pseudo_inverse: Matrix
    projector: Matrix
    unreachable: tuple[Combination, ...]
    pure_forces: Matrix
    pure_torques: Matrix
    isolated: tuple[bool, ...]

    @property
    def redundancy(self) -> int:
        """m - rank: free parameters left once a producible wrench is asked for."""
        return self.matrix.shape[1] - self.rank

    @property
    def redundant(self) -> bool:
        """Whether m > rank(A); full row rank is not needed (the report asks for it)."""
        return self.redundancy > 0

    def reachable(self, wrench: ArrayLike, tolerance: float = 1e-9) -> bool:
        """Whether F_B (n,) [N, N m] is in range(A): (I - projector) F_B = 0 up to `tolerance` relative to |W F_B|.

        Raises:
            ActuationError: the wrench is not n finite numbers.
        """
        F, W = self._wrench(wrench), self.axes.scale(self.length_m)
        return bool(np.linalg.norm(W * (F - self.projector @ F)) <= tolerance * np.linalg.norm(W * F))

    def solutions(self, wrench: ArrayLike) -> Solutions:
        """All forces that produce F_B (n,) [N, N m], or its projection onto range(A) where A cannot produce it.

        Raises:
            ActuationError: the wrench is not n finite numbers.
        """
        F = self._wrench(wrench)
        return Solutions(self.pseudo_inverse @ F, self.kernel_basis, F - self.projector @ F)

    def _wrench(self, wrench: ArrayLike) -> Vector:
        F = np.asarray(wrench, dtype=float)
        if F.shape != (len(self.axes.names),) or not np.all(np.isfinite(F)):
            raise ActuationError(f"the wrench {F.tolist()} is not {len(self.axes.names)} finite numbers")
        return F

    def with_only(self, used: Vector) -> Subspaces:
        """The same by the same threshold, as if thrusters where `used` (m,) is 0 or False did nothing."""
        least = self.threshold
        return subspaces(
            self.matrix * used,
            length_m=self.length_m,
            rank_tolerance=least.rank_tolerance,
            cost_limit=least.cost_limit,
        )


def subspaces(
    A: ArrayLike,
    *,
    length_m: float | None = None,
    rank_tolerance: float | None = None,
    cost_limit: float | None = None,
) -> Subspaces:
    """Split wrench space and thruster space by an actuation matrix.

    Args:
        A: (6,m) or (3,m), F_B = A F_m.
        length_m: L that torques are divided by before anything is compared [m]; default the rms lever arm.
        rank_tolerance: singular values of W A at or below this share of the largest count as zero; by default 1 %,
            and with a cost limit nothing but rounding.
        cost_limit: directions that cost more than this [N/N] count as lost; default none.

    Raises:
        ActuationError: A is malformed, the length or the limit is not positive, or the tolerance is not in [0, 1).
    """
    matrix, axes = actuation_matrix(A)
    threshold = Threshold.of(rank_tolerance, cost_limit)
    L = lever_arm(matrix, axes) if length_m is None else positive_length(length_m)
    W = axes.scale(L)
    scaled = W[:, None] * matrix
    U, sigma, Vt = np.linalg.svd(scaled)
    rank = threshold.rank(sigma)
    U_r, V_r = U[:, :rank], Vt[:rank].T
    f = axes.forces
    return Subspaces(
        matrix=matrix,
        axes=axes,
        length_m=L,
        singular_values=sigma,
        threshold=threshold,
        rank=rank,
        range_basis=U_r / W[:, None],
        kernel_basis=Vt[rank:].T,
        pseudo_inverse=(V_r / sigma[:rank]) @ U_r.T * W,
        projector=U_r @ U_r.T * W / W[:, None],
        unreachable=combinations(U[:, rank:].T, scaled, axes, L),
        pure_forces=_intersection(U_r, f, keep=slice(0, f)),
        pure_torques=_intersection(U_r, f, keep=slice(f, None)),
        isolated=tuple(bool(np.linalg.norm(row) <= _EXACT) for row in U[:, rank:]),
    )


def _intersection(U_r: Matrix, forces: int, keep: slice) -> Matrix:
    """Orthonormal basis of the wrenches of range(U_r) whose other half is zero, seen in the half that is kept."""
    other = U_r[forces:] if keep.start == 0 else U_r[:forces]
    if U_r.shape[1] == 0:
        return np.zeros((len(U_r[keep]), 0))
    _, sines, Vt = np.linalg.svd(other)
    free = Vt[np.count_nonzero(sines > _EXACT) :].T
    return U_r[keep] @ free
