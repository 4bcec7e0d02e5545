"""The convex hull of points of any dimension, flat ones included, as faces and edges that can be drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.wrench.axes import Matrix

_FLAT = 1e-6


@dataclass(frozen=True)
class ConvexShape:
    """A convex hull.

    Attributes:
        dimension: 0 a point, 1 a segment, 2 a polygon, 3 a polyhedron.
        faces: (k,d) corners of each face in order round it; one face for a polygon, none below.
        edges: (2,d) ends of each edge; the edges inside a flat face of a polyhedron are left out.
    """

    dimension: int
    faces: tuple[Matrix, ...]
    edges: tuple[Matrix, ...]


def convex_shape(points: Matrix) -> ConvexShape:
    """Hull of points (p,d), d <= 3, in the smallest flat that contains them."""
    from scipy.spatial import ConvexHull

    centre = points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(points - centre, full_matrices=False)
    dimension = int(np.count_nonzero(sizes > _FLAT * max(float(np.max(np.abs(points))), 1e-12)))
    if dimension == 0:
        return ConvexShape(0, (), ())
    flat = (points - centre) @ axes[:dimension].T
    if dimension == 1:
        ends = points[[int(np.argmin(flat[:, 0])), int(np.argmax(flat[:, 0]))]]
        return ConvexShape(1, (), (ends,))
    hull = ConvexHull(flat)
    if dimension == 2:
        ring = points[hull.vertices]
        return ConvexShape(2, (ring,), tuple(np.stack([a, b]) for a, b in zip(ring, np.roll(ring, -1, 0), strict=True)))
    return ConvexShape(3, tuple(points[triangle] for triangle in hull.simplices), _creases(points, hull))


def _creases(points: Matrix, hull) -> tuple[Matrix, ...]:
    """Edges between triangles of different planes."""
    edges = []
    for triangle, (corners, neighbours) in enumerate(zip(hull.simplices, hull.neighbors, strict=True)):
        for place, neighbour in enumerate(neighbours):
            bent = np.dot(hull.equations[triangle, :3], hull.equations[neighbour, :3]) < 1.0 - _FLAT
            if triangle < neighbour and bent:
                edges.append(points[np.delete(corners, place)])
    return tuple(edges)
