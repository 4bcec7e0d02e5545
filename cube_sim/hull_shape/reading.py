"""Triangles of a hull from OBJ and STL files.

    OBJ         `v x y z` and `f a b c ...` (also a/b/c, negative indices, polygons); all else is left alone
    STL, text   `vertex x y z`, three a facet
    STL, binary 80 bytes, the number of triangles, 50 bytes each

Neither says its unit, nor which way is forward. Both are for the user to tell.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ShapeError
from cube_sim.hull_shape.mesh import ClosedMesh, closed_mesh
from cube_sim.hull_shape.polygons import triangulated
from cube_sim.spatial import LARGEST

UNITS: Mapping[str, float] = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Metres in a unit of a file."""
FRAMES: Mapping[str, NDArray[np.float64]] = {
    "FLU": np.diag([1.0, 1.0, 1.0]),
    "FRD": np.diag([1.0, -1.0, -1.0]),
}
"""Rotation of a file's axes to body axes: x forward, y left, z up."""
MOST_FACES = 200_000
"""More triangles show a hull no better, and take minutes (a choice)."""
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

Triangles = tuple[NDArray[np.float64], NDArray[np.int64] | None]


def read_mesh(file: Path, unit: str = "m", frame: str = "FLU") -> ClosedMesh:
    """The closed surface in a file, in body axes.

    Args:
        file: its name ends in .obj or .stl.
        unit: one of `UNITS`.
        frame: one of `FRAMES`, of the file.

    Raises:
        ShapeError: one line, `file:line: what is wrong`.
    """
    reader: Mapping[str, Callable[[Path, bytes], Triangles]] = {".obj": _obj, ".stl": _stl}
    suffix = file.suffix.lower()
    if suffix not in reader:
        raise ShapeError(f"{file}: is no mesh that can be read; .obj and .stl are")
    try:
        content = file.read_bytes()
    except OSError as error:
        raise ShapeError(f"{file}: cannot be read: {error.strerror}") from error
    corners, lines = reader[suffix](file, content)
    if len(corners) > MOST_FACES:
        raise ShapeError(
            f"{file}: has {len(corners)} triangles; {MOST_FACES} at most: let your CAD program export it coarser"
        )
    return closed_mesh(file, UNITS[unit] * corners @ FRAMES[frame].T, lines)


def _obj(file: Path, content: bytes) -> Triangles:
    vertices: list[list[float]] = []
    corners: list[tuple[int, int, int]] = []
    lines: list[int] = []
    for number, line in enumerate(content.decode("utf-8", errors="replace").splitlines(), 1):
        kind, *words = line.partition("#")[0].split() or [""]
        if kind == "v":
            vertices.append(_point(file, number, words[:3]))
        elif kind == "f":
            if len(words) < 3:
                raise ShapeError(f"{file}:{number}: a face of {len(words)} corners; three at least make one")
            at = [_index(file, number, word, len(vertices)) for word in words]
            cut = [(0, 1, 2)] if len(at) == 3 else triangulated(np.array([vertices[i] for i in at]))
            corners += [(at[i], at[j], at[k]) for i, j, k in cut]
            lines += [number] * (len(at) - 2)
    if not corners:
        raise ShapeError(f"{file}: has no faces (lines that begin with f)")
    return np.array(vertices)[np.array(corners)], np.array(lines)


def _index(file: Path, number: int, word: str, count: int) -> int:
    """Of a vertex, from 0, as `7`, `7/1/3` or `-1` name it."""
    try:
        index = int(word.partition("/")[0])
    except ValueError:
        raise ShapeError(f"{file}:{number}: '{word}' names no vertex; a number does") from None
    if not (1 <= index <= count or -count <= index <= -1):
        raise ShapeError(f"{file}:{number}: vertex {index} is not there; {count} vertices stand before this line")
    return index - 1 if index > 0 else count + index


def _point(file: Path, number: int, words: list[str]) -> list[float]:
    try:
        point = [float(word) for word in words]
    except ValueError:
        point = []
    if len(point) != 3 or not all(abs(x) <= LARGEST for x in point):
        raise ShapeError(f"{file}:{number}: '{' '.join(words)[:60]}' is no point; three numbers are")
    return point


def _stl(file: Path, content: bytes) -> Triangles:
    count = int.from_bytes(content[80:84], "little")
    if len(content) == 84 + 50 * count and count:  # text that begins with `solid` may be binary too: the size tells
        return np.frombuffer(content, _RECORD, count, 84)["corners"].astype(np.float64), None
    if not content.lstrip()[:5].lower() == b"solid":
        raise ShapeError(
            f"{file}: is no STL: {len(content)} bytes, and {84 + 50 * count} would be right for the {count} triangles "
            "it tells of"
        )
    points: list[list[float]] = []
    lines: list[int] = []
    begun = 0
    for number, line in enumerate(content.decode("utf-8", errors="replace").splitlines(), 1):
        kind, *words = line.split() or [""]
        if kind == "facet":
            begun = len(points)
            lines.append(number)
        elif kind == "vertex":
            points.append(_point(file, number, words))
        elif kind == "endfacet" and len(points) - begun != 3:
            raise ShapeError(f"{file}:{number}: a facet of {len(points) - begun} vertices; three are right")
    if not lines or len(points) != 3 * len(lines):
        raise ShapeError(f"{file}: ends within a facet, or has none")
    return np.array(points).reshape(-1, 3, 3), np.array(lines)
