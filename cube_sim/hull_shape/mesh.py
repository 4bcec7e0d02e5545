"""A closed surface of triangles, and what can be wrong with one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ShapeError
from cube_sim.spatial import Matrix, Vector

Faces = NDArray[np.int64]
Lines = NDArray[np.int64]
_SAME = 1e-6
"""Vertices closer than this share of the mesh's size are one: single precision, as STL has it, tells 1e-7 apart."""
_SAMPLED = 200
"""So many faces are asked whether they lie inside another body (a choice)."""


@dataclass(frozen=True)
class ClosedMesh:
    """One closed surface, or several apart from each other, with faces that wind so that normals point out.

    Attributes:
        vertices: (n,3) [m], body axes.
        faces: (k,3) indices of vertices, counter-clockwise seen from the water.
        remarks: what was mended, in words for the user.
    """

    vertices: Matrix
    faces: Faces
    remarks: tuple[str, ...] = ()

    @property
    def triangles(self) -> NDArray[np.float64]:
        """(k,3,3) corners [m]."""
        return self.vertices[self.faces]

    def moved(self, rotation: Matrix, origin: Vector) -> ClosedMesh:
        """The same surface seen from another frame.

        Args:
            rotation: (3,3) that takes old axes' components to new ones; a mirror is refused.
            origin: (3,) of the new frame, in old axes [m].
        """
        if np.linalg.det(rotation) <= 0.0:
            raise ValueError("a frame is turned, not mirrored")
        return ClosedMesh((self.vertices - origin) @ rotation.T, self.faces, self.remarks)


def closed_mesh(file: Path, corners: NDArray[np.float64], lines: Lines | None = None) -> ClosedMesh:
    """Weld triangles to a closed surface, turn its normals outwards, leave inner walls out.

    Args:
        file: for errors.
        corners: (k,3,3) of each triangle [m], in the order of the file.
        lines: (k,) line of each in the file; None for a file without lines.

    Raises:
        ShapeError: the surface is open, joined wrongly or encloses nothing; names the face.
    """
    if not len(corners):
        raise ShapeError(f"{file}: holds no triangle")
    if not np.isfinite(corners).all():
        at = int(np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))[0])
        raise ShapeError(f"{_at(file, lines, at)}: a coordinate is not finite")
    vertices, faces = _welded(corners)
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    remarks = []
    if dropped := int((~whole).sum()):
        remarks.append(f"{dropped} faces without extent were left out")
    kept = np.flatnonzero(whole)
    if not len(kept):
        raise ShapeError(f"{file}: every face is without extent")
    body, turned = _oriented(file, vertices, faces[kept], kept, lines)
    faces = faces[kept]
    faces[turned] = faces[turned][:, ::-1]
    if turned.any():
        remarks.append(f"{int(turned.sum())} faces were turned: their corners ran the other way than their neighbours'")
    faces, inside_out = _outwards(file, vertices, faces, body)
    if inside_out:
        remarks.append("normals pointed inwards and were turned")
    faces, inner = _without_inner_walls(file, vertices, faces, body)
    if inner:
        what = "a body inside another was" if inner == 1 else f"{inner} bodies inside another were"
        remarks.append(f"{what} taken for an inner wall and left out: a hull displaces what its outer wall encloses")
    used, faces = np.unique(faces, return_inverse=True)
    return ClosedMesh(vertices[used], faces.reshape(-1, 3).astype(np.int64), tuple(remarks))


def _at(file: Path, lines: Lines | None, face: int) -> str:
    return f"{file}: triangle {face + 1}" if lines is None else f"{file}:{lines[face]}"


def _welded(corners: NDArray[np.float64]) -> tuple[Matrix, Faces]:
    """Vertices (n,3), each once, and faces (k,3)."""
    from scipy.spatial import KDTree

    points, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    close = KDTree(points).query_pairs(_SAME * float(np.ptp(points, axis=0).max()), output_type="ndarray")
    label = _components(len(points), close[:, 0], close[:, 1])
    _, representative = np.unique(label, return_index=True)
    return points[representative], label[index].reshape(-1, 3).astype(np.int64)


def _oriented(
    file: Path, vertices: Matrix, faces: Faces, numbers: NDArray[np.int64], lines: Lines | None
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Body (k,) of each face, and which faces (k,) must be turned for all of a body to wind alike.

    Raises:
        ShapeError: an edge is not shared by exactly two faces, or the surface has one side only.
    """
    start, end = faces[:, [0, 1, 2]].ravel(), faces[:, [1, 2, 0]].ravel()
    face = np.repeat(np.arange(len(faces)), 3)
    forward = start < end
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort((high, low))
    key = np.stack([low[order], high[order]], axis=1)
    begins = np.flatnonzero(np.r_[True, (key[1:] != key[:-1]).any(axis=1)])
    counts = np.diff(np.r_[begins, len(key)])
    for wrong in np.flatnonzero(counts != 2)[:1]:
        sharing = face[order[begins[wrong] : begins[wrong] + counts[wrong]]]
        a, b = (" ".join(f"{x:.6g}" for x in vertices[i]) for i in key[begins[wrong]])
        many = int((counts == 1).sum())
        told = (
            f"the edge from ({a}) to ({b}) belongs to this face alone: the surface is open, {many} such edges; close it"
            if counts[wrong] == 1
            else f"the edge from ({a}) to ({b}) belongs to {counts[wrong]} faces; two share an edge"
        )
        raise ShapeError(f"{_at(file, lines, int(numbers[sharing].min()))}: {told}")
    first, second = order[begins], order[begins + 1]
    one, other, alike = face[first], face[second], forward[first] != forward[second]
    body = _components(len(faces), one, other)
    # Each face as it is and turned: what must wind alike is joined, and a body falls into two parts.
    k = len(faces)
    part = _components(2 * k, np.r_[one, one + k], np.r_[other + k * ~alike, other + k * alike])
    if (part[:k] == part[k:]).any():
        at = int(numbers[np.flatnonzero(part[:k] == part[k:])[0]])
        raise ShapeError(f"{_at(file, lines, at)}: the surface has one side only; a hull has an inside")
    _, root = np.unique(body, return_index=True)
    turned = part[:k] != part[root][body]
    most = np.bincount(body, turned) > 0.5 * np.bincount(body)
    return body, turned ^ most[body]


def _components(count: int, one: NDArray[np.int64], other: NDArray[np.int64]) -> NDArray[np.int64]:
    """Number (count,) of the connected part each node belongs to."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    return connected_components(coo_array((np.ones(len(one)), (one, other)), shape=(count, count)), directed=False)[
        1
    ].astype(np.int64)


def _outwards(file: Path, vertices: Matrix, faces: Faces, body: NDArray[np.int64]) -> tuple[Faces, int]:
    """Faces that wind outwards, and how many bodies had to be turned."""
    a, b, c = (vertices[faces[:, i]] - vertices.mean(axis=0) for i in range(3))
    volumes = np.bincount(body, np.einsum("ki,ki->k", a, np.cross(b, c)) / 6.0)
    size = float(np.ptp(vertices, axis=0).max())
    flat = np.flatnonzero(np.abs(volumes) <= 1e-12 * size**3)
    if len(flat):
        raise ShapeError(f"{file}: a body of the surface encloses nothing: it is flat")
    inside_out = volumes < 0.0
    faces = faces.copy()
    faces[inside_out[body]] = faces[inside_out[body]][:, ::-1]
    return faces, int(inside_out.sum())


def _without_inner_walls(file: Path, vertices: Matrix, faces: Faces, body: NDArray[np.int64]) -> tuple[Faces, int]:
    """Faces without those of bodies inside others, and how many bodies that were.

    Raises:
        ShapeError: two bodies overlap.
    """
    bodies = int(body.max()) + 1
    if bodies == 1:
        return faces, 0
    inner = np.zeros(bodies, bool)
    order = np.argsort(body, kind="stable")
    apart = np.split(vertices[faces][order], np.cumsum(np.bincount(body))[:-1])
    lows = np.array([each.min(axis=(0, 1)) for each in apart])
    highs = np.array([each.max(axis=(0, 1)) for each in apart])
    for one, mine in enumerate(apart):
        some = mine[:: max(1, len(mine) // _SAMPLED)].mean(axis=1)
        beside = ((lows <= highs[one]) & (highs >= lows[one])).all(axis=1)
        for other in (int(each) for each in np.flatnonzero(beside) if each != one):
            near = ((some >= lows[other]) & (some <= highs[other])).all(axis=1)
            if not near.any():
                continue
            inside = np.zeros(len(some), bool)
            inside[near] = winding(some[near], apart[other]) > 0.5
            if inside.all():
                inner[one] = True
            elif inside.any():
                raise ShapeError(
                    f"{file}: two of its {bodies} bodies overlap, and what they share would count twice: unite them "
                    "in your CAD program, in Blender (modifier Boolean, Union) or in MeshLab (Mesh Boolean: Union)"
                )
    return faces[~inner[body]], int(inner.sum())


def winding(points: Matrix, triangles: NDArray[np.float64]) -> Vector:
    """How often a closed surface goes around each point: 1 inside, 0 outside.

    By the solid angle of each triangle (Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30, 1983).

    Args:
        points: (n,3).
        triangles: (k,3,3).
    """
    total = np.empty(len(points))
    for i, point in enumerate(points):
        a, b, c = (triangles[:, j] - point for j in range(3))
        la, lb, lc = (np.linalg.norm(each, axis=1) for each in (a, b, c))
        triple = np.einsum("ki,ki->k", a, np.cross(b, c))
        below = (
            la * lb * lc
            + np.einsum("ki,ki->k", a, b) * lc
            + np.einsum("ki,ki->k", b, c) * la
            + np.einsum("ki,ki->k", c, a) * lb
        )
        total[i] = np.arctan2(triple, below).sum() / (2.0 * np.pi)
    return total


def box_mesh(size: Sequence[float]) -> ClosedMesh:
    """A box (3,) [m] about the origin, two triangles a face."""
    at = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * np.asarray(size)
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    faces = [corner for a, b, c, d in quads for corner in ((a, b, c), (a, c, d))]
    return ClosedMesh(at, np.array(faces, dtype=np.int64))
