"""Faces without area, three corners on a line, as CAD programs leave them: their neighbours take their corners in."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.hull_shape.mesh import ClosedMesh, Faces

THIN = 1e-6
"""Twice a face's area over its longest side squared, below which it has none (a choice)."""


def thinness(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Twice the area over the longest side squared of each triangle (k,3,3): at most sqrt(3)/2, 0 of a line."""
    sides = corners[:, [1, 2, 0]] - corners
    doubled = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    longest = (sides**2).sum(axis=2).max(axis=1)
    return doubled / np.where(longest > 0.0, longest, 1.0)


def without_slivers(mesh: ClosedMesh) -> ClosedMesh:
    """The same closed surface, each face with an area.

    A sliver's middle corner lies on its longest side. That side is turned: it then goes from the middle corner to the
    corner across from it in the neighbour, and cuts that in two. Slivers beside each other take several rounds.
    """
    faces = mesh.faces
    for _ in range(len(faces)):
        thin = np.flatnonzero(thinness(mesh.vertices[faces]) < THIN)
        if not len(thin):
            return ClosedMesh(mesh.vertices, faces, mesh.remarks)
        turned = _turned(mesh, faces, thin)
        if turned is None:
            break
        faces = turned
    return ClosedMesh(mesh.vertices, faces, mesh.remarks)


def _turned(mesh: ClosedMesh, faces: Faces, thin: NDArray[np.int64]) -> Faces | None:
    """Faces after the longest sides of slivers were turned; None where none can be."""
    beside = {(int(face[i]), int(face[i - 2])): k for k, face in enumerate(faces) for i in range(3)}
    faces, done, touched = faces.copy(), False, set[int]()
    for k in map(int, thin):
        sides = np.linalg.norm(mesh.vertices[np.roll(faces[k], -1)] - mesh.vertices[faces[k]], axis=1)
        start = int(sides.argmax())
        a, c, b = (int(faces[k][(start + i) % 3]) for i in range(3))  # b lies between a and c
        other = beside.get((c, a))
        if other is None or {k, other} & touched:
            continue
        [d] = [int(corner) for corner in faces[other] if corner not in (a, c)] or [b]
        if d == b or (b, d) in beside or (d, b) in beside:
            continue
        faces[k], faces[other] = (a, d, b), (d, c, b)
        touched |= {k, other}
        done = True
    return faces if done else None
