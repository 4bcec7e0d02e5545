"""The set {A F_m : F_min <= F_m <= F_max}, a zonotope: support, volume and inscribed ball in closed form.

G. M. Ziegler, Lectures on Polytopes (1995), chapter 7; volume after P. McMullen (1984). Matrices here are scaled to
one unit and given in coordinates of their range, so that they have full row rank.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from cube_sim.wrench.axes import Matrix, Vector
from cube_sim.wrench.facets import facet_normals


def support(generators: Matrix, low: Vector, high: Vector, directions: Matrix) -> Vector:
    """Largest d . (G F) over the box [low, high] for each row d.

    Args:
        generators: G (r,m).
        low: (m,) [N].
        high: (m,) [N].
        directions: (p,r).

    Returns:
        (p,) in the unit of G F.
    """
    per_newton = directions @ generators
    return np.sum(np.maximum(per_newton * low, per_newton * high), axis=1)


def facets(generators: Matrix, low: Vector, high: Vector) -> tuple[Matrix, Vector]:
    """The zonotope as {w : normals w <= offsets}: unit normals (p,r) in both signs, and offsets (p,)."""
    normals = facet_normals(generators)
    normals = np.concatenate([normals, -normals])
    return normals, support(generators, low, high, normals)


def inscribed_radius(generators: Matrix, low: Vector, high: Vector) -> float:
    """Radius of the largest ball round zero inside the zonotope; 0 when zero is on its boundary or outside.

    The ball touches a facet: exact.
    """
    _, offsets = facets(generators, low, high)
    return max(0.0, float(np.min(offsets, initial=np.inf)))


def volume(generators: Matrix, low: Vector, high: Vector) -> float:
    """Volume of the zonotope: sum over all r-subsets of generators of |det| times their ranges."""
    r, m = generators.shape
    spans = generators * (high - low)
    choices = np.array(list(combinations(range(m), r)), dtype=int).reshape(-1, r)
    return float(np.sum(np.abs(np.linalg.det(np.transpose(spans[:, choices], (1, 0, 2))))))
