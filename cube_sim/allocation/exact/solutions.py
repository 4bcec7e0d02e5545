"""All forces that make a wrench, written in the coordinates the searches work in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.wrench.axes import axes_of
from cube_sim.wrench.tolerances import RANK_THRESHOLD


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


def force_solutions(A: NDArray[np.float64], thruster_weights: NDArray[np.float64], length_m: float) -> ForceSolutions:
    """Solve ``A f = F`` once for every F, by the singular value decomposition of the scaled matrix.

    Args:
        A: (n, m) actuation matrix.
        thruster_weights: (m,) positive cost weights w.
        length_m: length dividing the torque rows before ranks are judged.
    """
    scale = axes_of(len(A)).scale(length_m)
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
