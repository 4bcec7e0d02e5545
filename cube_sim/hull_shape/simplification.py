"""A closed surface in fewer triangles: edges drawn together, those first that leave it as it is.

Each corner knows the planes of the faces it came from; what drawing an edge together costs is the sum of squared
distances of the new corner to the planes of both (M. Garland and P. Heckbert, SIGGRAPH 1997). Flat parts become large
triangles, sharp edges stay. Many edges are drawn together in one round, none with a face in common with another.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array

from cube_sim.hull_shape.division import edges_of
from cube_sim.hull_shape.mesh import ClosedMesh, Faces
from cube_sim.hull_shape.slivers import thinness
from cube_sim.hull_shape.solid import solid_of
from cube_sim.spatial import Matrix, Vector

_REGULAR = 1e-4
"""Share of an edge's squared length times the area around it that counts too: on a flat part short edges go first."""
_THINNEST = 0.02
"""Twice a face's area over its longest side squared: thinner ones are not made (a choice)."""
_NO_COST = 1e-30
"""What drawing an edge together costs at least, of a hull of length one; for the logarithm."""
_SCATTER = 2654435761
"""Times this, and modulo 2^32, neighbouring numbers come far apart (2^32 over the golden ratio)."""
_TURNED = 0.3
"""A face may turn until its normals have this product, at most (a choice)."""


def simplified(mesh: ClosedMesh, count: int) -> ClosedMesh:
    """The same surface in about so many faces, of the same volume; as few as it can be drawn to if that is more."""
    vertices, faces = mesh.vertices.copy(), mesh.faces
    planes = _planes(vertices, faces)
    refused = np.zeros(0, np.int64)
    while len(faces) > count:
        edges, _ = edges_of(faces)
        cost, place = _cost(vertices, planes, edges)
        size = len(vertices)
        code = edges[:, 0] * size + edges[:, 1]
        cost[np.isin(code, refused) | ~_two_in_common(edges, size)] = np.inf
        chosen = _apart(cost, edges, size)
        most = max((len(faces) - count) // 2, 1)  # each takes two faces away
        chosen = chosen[np.argsort(cost[chosen], kind="stable")][:most]
        if not len(chosen):
            break
        moved, target = vertices.copy(), np.arange(size)
        moved[edges[chosen, 0]] = place[chosen]
        moved[edges[chosen, 1]] = place[chosen]
        target[edges[chosen, 1]] = edges[chosen, 0]
        bad = _turned_over(vertices, moved, faces, target, edges[chosen])
        refused = np.concatenate([refused, code[chosen[bad]]])
        chosen = chosen[~bad]
        keep, gone = edges[chosen].T
        vertices[keep] = place[chosen]
        planes[keep] += planes[gone]
        target = np.arange(size)
        target[gone] = keep
        faces = target[faces]
        faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    used, faces = np.unique(faces, return_inverse=True)
    drawn = ClosedMesh(vertices[used], faces.reshape(-1, 3).astype(np.int64))
    before, after = solid_of(mesh), solid_of(drawn)
    grown = (before.volume / after.volume) ** (1.0 / 3.0)
    return ClosedMesh(before.centre + grown * (drawn.vertices - after.centre), drawn.faces)


def _planes(vertices: Matrix, faces: Faces) -> NDArray[np.float64]:
    """(n,4,4) sums of area times p p' over the faces at each corner, p their planes (normal, -distance)."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    doubled = np.linalg.norm(normals, axis=1)
    normals /= np.where(doubled > 0.0, doubled, 1.0)[:, None]
    plane = np.column_stack([normals, -np.einsum("ki,ki->k", normals, a)])
    each = 0.5 * doubled[:, None, None] * plane[:, :, None] * plane[:, None, :]
    sums = np.zeros((len(vertices), 4, 4))
    for corner in range(3):
        np.add.at(sums, faces[:, corner], each)
    return sums


def _cost(vertices: Matrix, planes: NDArray[np.float64], edges: NDArray[np.int64]) -> tuple[Vector, Matrix]:
    """Of drawing each edge together (e,), and where to (e,3): one of its ends, or its middle."""
    a, b = vertices[edges[:, 0]], vertices[edges[:, 1]]
    both = planes[edges[:, 0]] + planes[edges[:, 1]]
    places = np.stack([a, b, 0.5 * (a + b)])
    seen = np.concatenate([places, np.ones((3, len(edges), 1))], axis=2)
    distance = np.einsum("pei,eij,pej->pe", seen, both, seen)
    best = distance.argmin(axis=0)
    area = both[:, 0, 0] + both[:, 1, 1] + both[:, 2, 2]
    length = ((b - a) ** 2).sum(axis=1)
    return distance.min(axis=0) + _REGULAR * area * length, places[best, np.arange(len(edges))]


def _two_in_common(edges: NDArray[np.int64], size: int) -> NDArray[np.bool_]:
    """Whether the ends of each edge have two neighbours in common, no more: else faces would fold onto each other.

    Nor do two ends that have three neighbours each: they are those of a tetrahedron, which would vanish.
    """
    both = np.concatenate([edges, edges[:, ::-1]])
    beside: Any = coo_array((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=(size, size)).tocsr()
    shared = (beside @ beside).multiply(beside).tocsr()
    many = np.bincount(both[:, 0], minlength=size)[edges]
    return (np.asarray(shared[edges[:, 0], edges[:, 1]]).ravel() == 2.0) & (many.max(axis=1) > 3)


def _apart(cost: Vector, edges: NDArray[np.int64], size: int) -> NDArray[np.int64]:
    """Edges that are cheaper than any other near them: no face has corners on two of them.

    Costs within a factor of two count as the same, and are told apart as if by lot: on a flat or evenly curved part
    they would else grow from one end to the other, and few edges be the cheapest of their surroundings.
    """
    grade = np.floor(np.log2(np.maximum(cost, _NO_COST)))
    lot = np.arange(len(cost)) * _SCATTER % 2**32
    rank = np.empty(len(cost), np.int64)
    rank[np.lexsort((lot, grade))] = np.arange(len(cost))
    nearest = np.full(size, len(cost))
    for end in (0, 1):
        np.minimum.at(nearest, edges[:, end], rank)
    around = nearest.copy()
    np.minimum.at(around, edges[:, 0], nearest[edges[:, 1]])
    np.minimum.at(around, edges[:, 1], nearest[edges[:, 0]])
    return np.flatnonzero((around[edges[:, 0]] == rank) & (around[edges[:, 1]] == rank) & np.isfinite(cost))


def _turned_over(
    vertices: Matrix, moved: Matrix, faces: Faces, target: NDArray[np.int64], chosen: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Which of the chosen edges (c,2) turn a face over when they are drawn together."""
    owner = np.full(len(vertices), -1)
    owner[chosen.ravel()] = np.repeat(np.arange(len(chosen)), 2)
    of = owner[faces].max(axis=1)
    drawn = target[faces]
    stays = (of >= 0) & (drawn[:, 0] != drawn[:, 1]) & (drawn[:, 1] != drawn[:, 2]) & (drawn[:, 2] != drawn[:, 0])
    before, after = (
        np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]) for at in (vertices[faces[stays]], moved[drawn[stays]])
    )
    product = np.einsum("ki,ki->k", before, after)
    lengths = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    became, was = thinness(moved[drawn[stays]]), thinness(vertices[faces[stays]])
    bad = np.zeros(len(chosen), bool)
    bad[of[stays][(product < _TURNED * lengths) | ((became < _THINNEST) & (became < was))]] = True
    return bad
