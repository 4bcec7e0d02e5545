"""Which wrenches the thrusters make within their maxima: the facets of the set, so that every use of ker A counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.axes import Matrix, Vector
from cube_sim.wrench.tolerances import RANK_THRESHOLD
from cube_sim.wrench.zonotope import facets

_NO_WRENCH = 1e-12
_NO_DEMAND = 1e-9
_NO_OFFSET = 1e-12


@dataclass(frozen=True)
class AttainableSet:
    """The set {A F_m : F_min <= F_m <= F_max} = {F_B in range(A) : normals F_B <= offsets}, dead zones left out.

    Attributes:
        normals: (p,n) of the p facets, [1] for forces, [1/m] for torques.
        offsets: (p,) of the facets [N], never negative: rest is allowed.
    """

    normals: Matrix
    offsets: Vector

    def share(self, wrenches: Matrix) -> Vector:
        """How many times each wrench of range(A) fits into the set.

        Args:
            wrenches: F_B (q,n) [N, N m].

        Returns:
            (q,) the largest t with t F_B attainable: from 1 on it can be held, 0 is not at all; infinite for no wrench.
        """
        demand = wrenches @ self.normals.T
        largest = np.max(np.abs(demand), axis=1, initial=0.0, keepdims=True)
        asked = demand > np.maximum(_NO_WRENCH, _NO_DEMAND * largest)
        return np.min(
            np.divide(self.offsets, demand, out=np.full(demand.shape, np.inf), where=asked), axis=1, initial=np.inf
        )


def attainable_set(actuation: Subspaces, allowed: AllowedForces) -> AttainableSet:
    """The facets of what is attainable.

    Args:
        actuation: A, m thrusters; nothing is cut from it, however small its singular value.
        allowed: their forces; only the maxima are looked at.
    """
    W = actuation.axes.scale(actuation.length_m)
    U, sigma, _ = np.linalg.svd(W[:, None] * actuation.matrix)
    U_r = U[:, : np.count_nonzero(sigma > RANK_THRESHOLD * max(sigma[0], np.finfo(float).tiny))]
    if U_r.shape[1] == 0:
        return AttainableSet(np.zeros((0, len(W))), np.zeros(0))
    generators = U_r.T @ (W[:, None] * actuation.matrix)
    normals, offsets = facets(generators, allowed.minimum, allowed.maximum)
    offsets[offsets <= _NO_OFFSET * np.max(offsets)] = 0.0
    return AttainableSet(normals @ U_r.T * W, offsets)


def holding_forces(A: Matrix, allowed: AllowedForces, wrench: Vector) -> Vector:
    """(m,) forces [N] with A F_m = F_B that use the least share of the thrusters' maxima.

    A linear programme finds the largest t with A F_m = t F_B within the maxima; F_m / t is returned. Rest is allowed,
    so these forces lie within the maxima whenever t >= 1.

    Args:
        A: (n,m).
        allowed: forces of the thrusters.
        wrench: F_B (n,) [N, N m], attainable and not zero.
    """
    from scipy.optimize import linprog

    U, sigma, Vt = np.linalg.svd(A, full_matrices=False)
    rank = np.count_nonzero(sigma > RANK_THRESHOLD * sigma[0])
    scale = float(np.max(np.abs([allowed.minimum, allowed.maximum])))
    rows = np.column_stack([Vt[:rank], -(U[:, :rank].T @ wrench) / sigma[:rank] / scale])
    found = linprog(
        -np.eye(1, rows.shape[1], rows.shape[1] - 1)[0],
        A_eq=rows,
        b_eq=np.zeros(rank),
        bounds=[*zip(allowed.minimum / scale, allowed.maximum / scale, strict=True), (0.0, None)],
    )
    return found.x[:-1] * scale / found.x[-1]
