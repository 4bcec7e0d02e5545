"""A surface divided further: triangles halved across their longest sides, with their neighbours, finest at edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.hull_shape.mesh import ClosedMesh, Faces
from cube_sim.spatial import Matrix, Vector

_SHARP = np.cos(np.radians(30.0))
"""Edges that turn by more are sharp: there the flow is singular (a choice; a sixteen-sided cylinder has none)."""
_FINEST = 0.15
"""Triangles at a sharp edge are this share of those far from any, at least (a choice)."""
_MOST_POINTS = 20_000
"""Of sharp edges, from which distances are taken (a choice)."""


def divided(mesh: ClosedMesh, count: int) -> ClosedMesh:
    """The same surface in more triangles: as many as come without being more than `count`.

    A mesh that has more already is returned as it is.
    """
    if len(mesh.faces) >= count:
        return mesh
    edges = _points_on_sharp_edges(mesh)
    best = mesh
    size = float(np.sqrt(_areas(mesh).sum() / count))
    low, high = 0.5 * size, 30.0 * size
    for _ in range(10):
        size = float(np.sqrt(low * high))
        tried = _with_sides_below(mesh, size, edges, count)
        if tried is None:
            low = size
        else:
            high, best = size, tried
    return best


def _areas(mesh: ClosedMesh) -> Vector:
    a, b, c = (mesh.triangles[:, i] for i in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def edges_of(faces: Faces) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Every edge once (e,2), and which of them the sides (k,3) of each face are: side i from corner i to the next."""
    sides = np.sort(np.stack([faces, faces[:, [1, 2, 0]]], axis=2).reshape(-1, 2), axis=1)
    edges, index = np.unique(sides, axis=0, return_inverse=True)
    return edges, index.reshape(-1, 3)


def _points_on_sharp_edges(mesh: ClosedMesh) -> Matrix:
    """(n,3) close to each other, on every edge that is sharp."""
    triangles = mesh.triangles
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    normals = normals / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    edges, index = edges_of(mesh.faces)
    beside = np.argsort(index.ravel(), kind="stable").reshape(-1, 2) // 3  # two faces share each edge of a closed one
    one, other = beside.T
    known = (lengths[one] > 0.0) & (lengths[other] > 0.0)
    sharp = edges[known & (np.einsum("ki,ki->k", normals[one], normals[other]) < _SHARP)]
    a, b = mesh.vertices[sharp[:, 0]], mesh.vertices[sharp[:, 1]]
    length = np.linalg.norm(b - a, axis=1)
    steps = np.ceil(length * _MOST_POINTS / max(length.sum(), 1e-300)).astype(int) + 1
    points = [p + (q - p) * np.linspace(0.0, 1.0, n)[:, None] for p, q, n in zip(a, b, steps, strict=True)]
    return np.concatenate(points) if points else np.empty((0, 3))


def _with_sides_below(mesh: ClosedMesh, size: float, edges: Matrix, count: int) -> ClosedMesh | None:
    """The surface divided until no side is longer than wanted there; None once it takes more than so many faces."""
    from scipy.spatial import KDTree

    tree = KDTree(edges) if len(edges) else None
    reach = 0.25 * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    vertices, faces = mesh.vertices, mesh.faces
    while True:
        sides = np.linalg.norm(vertices[faces[:, [1, 2, 0]]] - vertices[faces], axis=2)
        wanted = np.full(len(faces), size)
        if tree is not None:
            # Widths that grow with the root of the distance to the edge: each part of the face errs as much.
            distance = tree.query(vertices[faces].mean(axis=1))[0]
            wanted *= np.clip(np.sqrt(distance / reach), _FINEST, 1.0)
        large = sides.max(axis=1) > wanted
        if not large.any():
            return ClosedMesh(vertices, faces)
        vertices, faces = _halved(vertices, faces, sides, large)
        if len(faces) > count:
            return None


def _halved(vertices: Matrix, faces: Faces, sides: Matrix, large: NDArray[np.bool_]) -> tuple[Matrix, Faces]:
    """Some faces halved across their longest side; a face of which any side is halved is so across its longest too.

    (M. C. Rivara, Int. J. Numer. Meth. Eng. 20, 1984: so no corner stands in the middle of a side, and no face becomes
    thinner than half of what it came from.)
    """
    edges, index = edges_of(faces)
    longest = sides.argmax(axis=1)
    rows = np.arange(len(faces))
    halved = np.zeros(len(edges), bool)
    touched = large
    while True:
        halved[index[rows[touched], longest[touched]]] = True
        more = halved[index].any(axis=1)
        if (more == touched).all():
            break
        touched = more
    number = np.cumsum(halved) - 1 + len(vertices)
    vertices = np.concatenate([vertices, 0.5 * (vertices[edges[halved, 0]] + vertices[edges[halved, 1]])])
    turned = (longest[:, None] + np.arange(3)) % 3  # so that the longest side goes from corner 0 to 1
    corner, at = np.take_along_axis(faces, turned, axis=1), np.take_along_axis(index, turned, axis=1)
    cut, middle = halved[at], number[at]
    pieces = [faces[~touched]]
    for second, third in ((False, False), (True, False), (False, True), (True, True)):
        these = touched & (cut[:, 1] == second) & (cut[:, 2] == third)
        (a, b, c), (ab, bc, ca) = corner[these].T, middle[these].T
        made = [(ab, b, bc), (ab, bc, c)] if second else [(ab, b, c)]
        made += [(a, ab, ca), (ca, ab, c)] if third else [(a, ab, c)]
        pieces += [np.stack(piece, axis=1) for piece in made]
    return vertices, np.concatenate(pieces)
