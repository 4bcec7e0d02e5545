"""All forces that make a wrench, written in the coordinates the searches work in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import bounded, numbers

RANK_THRESHOLD = 1e-9
"""Singular values below this part of the largest one are rounding, not authority.

Deliberately near machine precision: a nearly singular vehicle (thrusters lost, built imperfectly) keeps its weak
direction, and a demand along it that exceeds the limits is answered as unattainable, exactly.
"""


SMALLEST = 1e-30
"""Least size of an actuation matrix, for the same reason as `arguments.LARGEST`."""


class ForceSolutions(NamedTuple):
    """Every force vector that makes a wrench: ``f = particular @ F + null_space @ z`` for any z.

    Attributes:
        particular: (m, n) weighted pseudo-inverse of A. Of all forces that make F it gives those of least
            ``sum w f^2``.
        null_space: (m, k) basis N of ker A, orthonormal in the weighted sense ``N.T @ diag(w) @ N = I``. A distance in
            z is therefore a cost in f.
        equations: (r, m) orthonormal rows spanning the row space of A, r = rank A. ``equations @ f`` [N] fixes the
            wrench, whatever the units and the conditioning of A.
        outside_range: (n, n) takes a wrench to its part outside range(A), torques divided by a length [N].
        rank: r.
    """

    particular: NDArray[np.float64]
    null_space: NDArray[np.float64]
    equations: NDArray[np.float64]
    outside_range: NDArray[np.float64]
    rank: int


class WrenchMetric(NamedTuple):
    """Coordinates (s, z) of forces in which the weighted wrench error ``|W (A f - F)|`` is a plain distance.

    ``f = G_pinv @ s + null_space @ z`` and ``W A f = basis @ s``: s alone decides the wrench, z does not change it.

    Attributes:
        G_pinv: (m, r) pseudo-inverse of G.
        null_space: (m, k) orthonormal basis of ker A.
        basis: (n, r) orthonormal basis of range(W A).
        G: (r, m) W A in that basis: ``s = G @ f``.
        weights: (n,) diagonal of W [1] for forces, [1/m] for torques.
    """

    G_pinv: NDArray[np.float64]
    null_space: NDArray[np.float64]
    basis: NDArray[np.float64]
    G: NDArray[np.float64]
    weights: NDArray[np.float64]


def actuation_matrix(A: ArrayLike) -> NDArray[np.float64]:
    """Check an actuation matrix: (3, m) rows ``[Fx Fy Mz]`` or (6, m) rows ``[Fx Fy Fz Mx My Mz]``.

    Raises:
        AllocationError: another shape, no thruster, an entry that is not finite, nothing but zeros, or absurd sizes.
    """
    matrix = numbers("A", A, "matrix")
    if matrix.ndim != 2 or matrix.shape[0] not in (3, 6) or matrix.shape[1] == 0:
        raise AllocationError(f"A has shape {matrix.shape}; it must be (3, m) or (6, m) with at least one thruster")
    if not np.all(np.isfinite(matrix)):
        row, column = np.argwhere(~np.isfinite(matrix))[0]
        raise AllocationError(f"A[{row}, {column}] is {matrix[row, column]}; every entry must be finite")
    if not np.any(matrix):
        raise AllocationError("A is zero: no thruster makes any wrench")
    bounded("A", matrix)
    if np.max(np.abs(matrix)) < SMALLEST:
        raise AllocationError(
            f"A holds {np.max(np.abs(matrix)):g} at most; below {SMALLEST:g} squares leave double precision"
        )
    return matrix


def torque_rows(n: int) -> slice:
    """Rows of an n-row wrench that hold torques."""
    return slice(2, 3) if n == 3 else slice(3, 6)


def lever_length(A: NDArray[np.float64]) -> float:
    """Length that turns torques into comparable forces [m]: rms torque per rms force over A's columns, 1 if none."""
    torque = np.linalg.norm(A[torque_rows(len(A))])
    force = np.linalg.norm(np.delete(A, np.r_[torque_rows(len(A))], axis=0))
    return float(torque / force) if torque > 0.0 and force > 0.0 else 1.0


def error_size(error: NDArray[np.float64], length_m: float) -> float:
    """Norm of a wrench error (n,) [N], torques divided by a length; entries beyond 1e300 count as that, and no more."""
    scaled = error.copy()
    with np.errstate(over="ignore"):
        scaled[torque_rows(len(error))] /= length_m
    scaled = np.clip(scaled, -1e300, 1e300)
    largest = float(np.max(np.abs(scaled)))
    return largest * float(np.linalg.norm(scaled / largest)) if largest > 0.0 else 0.0


def force_solutions(A: NDArray[np.float64], thruster_weights: NDArray[np.float64], length_m: float) -> ForceSolutions:
    """Solve ``A f = F`` once for every F, by the singular value decomposition of the scaled matrix.

    Args:
        A: (n, m) actuation matrix.
        thruster_weights: (m,) positive cost weights w.
        length_m: length dividing the torque rows before ranks are judged.
    """
    scale = np.ones(len(A))
    scale[torque_rows(len(A))] = 1.0 / length_m
    root = np.sqrt(thruster_weights)
    U, sigma, Vt, rank = _decompose(scale[:, None] * A / root)
    _, _, plain_Vt, _ = _decompose(scale[:, None] * A)
    return ForceSolutions(
        particular=np.ascontiguousarray((Vt[:rank].T / sigma[:rank]) @ (U[:, :rank].T * scale) / root[:, None]),
        null_space=np.ascontiguousarray(Vt[rank:].T / root[:, None]),
        equations=np.ascontiguousarray(plain_Vt[:rank]),
        outside_range=(np.eye(len(A)) - U[:, :rank] @ U[:, :rank].T) * scale,
        rank=rank,
    )


def wrench_metric(A: NDArray[np.float64], wrench_weights: NDArray[np.float64]) -> WrenchMetric:
    """Coordinates in which ``|W (A f - F)|`` is a distance, by the singular value decomposition of W A.

    Args:
        A: (n, m) actuation matrix.
        wrench_weights: (n,) positive diagonal of W.
    """
    U, sigma, Vt, rank = _decompose(wrench_weights[:, None] * A)
    return WrenchMetric(
        G_pinv=np.ascontiguousarray(Vt[:rank].T / sigma[:rank]),
        null_space=np.ascontiguousarray(Vt[rank:].T),
        basis=np.ascontiguousarray(U[:, :rank]),
        G=np.ascontiguousarray(sigma[:rank, None] * Vt[:rank]),
        weights=wrench_weights,
    )


def _decompose(
    matrix: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], int]:
    U, sigma, Vt = np.linalg.svd(matrix, full_matrices=True)
    rank = int(np.sum(sigma > RANK_THRESHOLD * sigma[0])) if sigma[0] > 0.0 else 0
    return U, sigma, Vt, rank
