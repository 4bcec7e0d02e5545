"""What a hull shows to the flow: its shadow along each axis, with the moments that its drag in rotation needs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.hull_shape.mesh import ClosedMesh
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector

CELLS = 600
"""Along the longer side of a shadow (a choice: its area is good to a third of a per cent)."""
_FLAT = 0.9
"""A face whose normal has this share along the flow meets it flat."""


@dataclass(frozen=True)
class Silhouettes:
    """Shadows along x, y and z.

    Attributes:
        areas: (3,) [m^2].
        third_moments: (3,3), [i, k] the integral of |r_k|^3 over the shadow along axis i, r from the body origin [m^5];
            0 for k = i.
        flat: (3,) share of the shadow that faces within 26 degrees of the flow cast, 1 for a box.
    """

    areas: Vector
    third_moments: Matrix
    flat: Vector


def silhouettes_of(mesh: ClosedMesh) -> Silhouettes:
    """Shadows of a surface, on a grid of cells; what hides behind something is not counted twice."""
    triangles = mesh.triangles
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    along = np.abs(normals) / np.where(doubled > 0.0, doubled, 1.0)[:, None]
    areas, moments, flat = np.zeros(3), np.zeros((3, 3)), np.zeros(3)
    for i in range(3):
        plane = [k for k in range(3) if k != i]
        flatly = triangles[:, :, plane]
        low, high = flatly.min(axis=(0, 1)), flatly.max(axis=(0, 1))
        cell = float((high - low).max()) / CELLS
        shape = tuple(int(n) for n in np.maximum(np.ceil((high - low) / cell), 1))
        shadow = np.zeros(shape, np.bool_)
        cover(np.ascontiguousarray((flatly - low) / cell), shadow)
        areas[i] = shadow.sum() * cell**2
        for axis, k in enumerate(plane):
            middles = np.abs(low[axis] + (np.arange(shape[axis]) + 0.5) * cell)
            moments[i, k] = (shadow.sum(axis=1 - axis) * middles**3).sum() * cell**2
        cast = 0.5 * np.abs(normals[:, i])
        flat[i] = cast[along[:, i] > _FLAT].sum() / cast.sum()
    return Silhouettes(areas, moments, flat)


@compiled
def cover(triangles, shadow):  # type: ignore[no-untyped-def]
    """Mark the cells whose middles lie in a triangle.

    Args:
        triangles: (k,3,2) corners, in cells.
        shadow: (n,m) bool, marked.
    """
    for t in range(triangles.shape[0]):
        ax, ay = triangles[t, 0, 0], triangles[t, 0, 1]
        bx, by = triangles[t, 1, 0], triangles[t, 1, 1]
        cx, cy = triangles[t, 2, 0], triangles[t, 2, 1]
        doubled = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if doubled == 0.0:
            continue
        first, last = max(int(min(ax, bx, cx) - 0.5), 0), min(int(max(ax, bx, cx) + 0.5), shadow.shape[0] - 1)
        low, high = max(int(min(ay, by, cy) - 0.5), 0), min(int(max(ay, by, cy) + 0.5), shadow.shape[1] - 1)
        for i in range(first, last + 1):
            for j in range(low, high + 1):
                x, y = i + 0.5, j + 0.5
                u = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / doubled
                v = ((cx - bx) * (y - by) - (cy - by) * (x - bx)) / doubled
                w = ((ax - cx) * (y - cy) - (ay - cy) * (x - cx)) / doubled
                if u >= 0.0 and v >= 0.0 and w >= 0.0:
                    shadow[i, j] = True
