"""The set of wrenches that forces make, ready to be asked which part of a line of wrenches it holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.attained_intervals import attained
from cube_sim.wrench.axes import Matrix, Vector
from cube_sim.wrench.facets import facet_normals
from cube_sim.wrench.line_interval import interval_in_box
from cube_sim.wrench.tolerances import NO_GAIN, RANK_THRESHOLD


@dataclass(frozen=True)
class WrenchLine:
    """The wrenches t d that boxes of forces attain, in terms of facets.

    Attributes:
        along: (h,) normals . d; all zero where the thrusters attain d at t = 0 only.
        gain: (h,m) what one newton of each thruster makes along each normal.
        farthest: largest |t| to look at: 0 where only t = 0 is attained, else infinite.
    """

    along: Vector
    gain: Matrix
    farthest: float

    def box(self, allowed: AllowedForces) -> tuple[float, float]:
        """(lowest, highest) t over the box between the thrusters' most extreme forces, which holds 0."""
        if not self.farthest or not len(self.along):
            return 0.0, 0.0
        ends = self.gain[:, :, None] * np.stack([allowed.minimum, allowed.maximum], axis=1)
        lower, upper = ends.min(axis=2).sum(axis=1), ends.max(axis=2).sum(axis=1)
        return interval_in_box(self.along, lower, upper, self.farthest, 0.0)

    def intervals(self, allowed: AllowedForces, join: float) -> Matrix | None:
        """(i,2) disjoint intervals of t that allowed forces attain, ascending, gaps up to `join` closed.

        None when it took more than `attained_intervals.MOST_WORK`.
        """
        count = np.count_nonzero(~np.isnan(allowed.low), axis=1)
        gaps = np.nan_to_num(allowed.low[:, 1:] - allowed.high[:, :-1]).max(axis=1, initial=0.0)
        influence = np.linalg.norm(self.gain, axis=0)
        moves = np.flatnonzero(influence > 0.0)
        order = moves[np.argsort(-(gaps * influence)[moves], kind="stable")]
        scale = float(np.max(np.abs(self.gain) @ np.maximum(-allowed.minimum, allowed.maximum), initial=0.0))
        found, proven = attained(
            self.along,
            np.ascontiguousarray(self.gain[:, order].T),
            np.nan_to_num(allowed.low[order]),
            np.nan_to_num(allowed.high[order]),
            count[order],
            self.farthest,
            NO_GAIN * scale,
            join,
        )
        return found if proven else None


@dataclass(frozen=True)
class WrenchSet:
    """All {A F_m}, ready to be asked about any line.

    Attributes:
        coordinates: (r,n) of a wrench in the basis in which A has orthonormal rows.
        basis: (n,r) orthonormal, of range(A).
        normals: (h,r) of the facets, in these coordinates.
        gain: (h,m) what one newton of each thruster makes along each normal.
    """

    coordinates: Matrix
    basis: Matrix
    normals: Matrix
    gain: Matrix

    @staticmethod
    def of(A: Matrix) -> WrenchSet:
        """Read it off A (n,m)."""
        U, sigma, Vt = np.linalg.svd(A, full_matrices=False)
        r = int(np.count_nonzero(sigma > RANK_THRESHOLD * max(sigma[0], np.finfo(float).tiny)))
        generators = Vt[:r]
        generators[:, ~np.any(A, axis=0)] = 0.0
        normals = facet_normals(generators) if r else np.zeros((0, 0))
        gain = normals @ generators if r else np.zeros((0, A.shape[1]))
        gain[np.abs(gain) < NO_GAIN] = 0.0
        return WrenchSet(U[:, :r].T / sigma[:r, None], U[:, :r], normals, gain)

    def line(self, direction: Vector) -> WrenchLine:
        """The wrenches t d, d (n,) not zero."""
        outside = direction - self.basis @ (self.basis.T @ direction)
        if np.linalg.norm(outside) > RANK_THRESHOLD * np.linalg.norm(direction):
            return WrenchLine(np.zeros(len(self.gain)), self.gain, 0.0)
        along = self.normals @ (self.coordinates @ direction)
        along[np.abs(along) < RANK_THRESHOLD * np.max(np.abs(along))] = 0.0
        return WrenchLine(along, self.gain, np.inf)
