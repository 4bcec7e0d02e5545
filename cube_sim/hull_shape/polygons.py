"""A flat polygon cut into triangles: ears, corners that nothing of it lies in, are cut off one after the other."""

from __future__ import annotations

import numpy as np

from cube_sim.spatial import Matrix

Corners = tuple[int, int, int]


def triangulated(corners: Matrix) -> list[Corners]:
    """Triangles of a polygon, as indices of its corners.

    Args:
        corners: (n,3) in order, on a plane or nearly so; the polygon does not cross itself.
    """
    after = np.roll(corners, -1, axis=0)
    normal = np.cross(corners, after).sum(axis=0)  # Newell's: of the plane, twice the area long
    left = list(range(len(corners)))
    triangles: list[Corners] = []
    while len(left) > 3:
        at = next((i for i in range(len(left)) if _is_ear(corners, left, i, normal)), 0)
        triangles.append((left[at - 1], left[at], left[(at + 1) % len(left)]))
        del left[at]
    return [*triangles, (left[0], left[1], left[2])]


def _is_ear(corners: Matrix, left: list[int], at: int, normal: np.ndarray) -> bool:
    a, b, c = (corners[left[i % len(left)]] for i in (at - 1, at, at + 1))
    if np.cross(b - a, c - b) @ normal <= 0.0:
        return False
    others = corners[[k for i, k in enumerate(left) if i not in {(at - 1) % len(left), at, (at + 1) % len(left)}]]
    inside = np.ones(len(others), bool)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= np.cross(q - p, others - p) @ normal >= 0.0
    return not inside.any()
