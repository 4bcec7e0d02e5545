"""Added mass of a mesh finer than its flow: triangles gathered to patches, on each of which the potential is constant.

phi/2 = K phi - V v_n (see `cube_sim.hull_shape.added_mass`), asked for at the middle of a triangle in each patch. Every
triangle stays where it is; only phi is coarser than the mesh.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.hull_shape.influence import constant_patches
from cube_sim.hull_shape.mesh import ClosedMesh
from cube_sim.spatial import Matrix, Vector

_FACING = 0.5
"""Normals that differ by one count as so many sizes of the hull: no patch reaches round an edge (a choice)."""


def patched_added_mass(mesh: ClosedMesh, count: int) -> Matrix:
    """M_A/rho (6,6) of a surface in so many patches."""
    triangles = mesh.triangles
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    normals, areas, middles = normals / doubled[:, None], 0.5 * doubled, triangles.mean(axis=1)
    patch, own = _gathered(middles, normals, areas, count)
    v_n = np.concatenate([normals, np.cross(middles, normals)], axis=1)
    reach = ((triangles - middles[:, None]) ** 2).sum(axis=2).max(axis=1)
    double, single = np.empty((len(own), len(own))), np.empty((len(own), 6))
    constant_patches(middles[own], triangles, normals, areas, reach, patch, own, v_n, double, single)
    # A constant potential makes no flow: each row sums to -1/2, exactly on a closed surface.
    diagonal = np.arange(len(own))
    double[diagonal, diagonal] -= double.sum(axis=1) + 0.5
    phi = np.linalg.solve(0.5 * np.eye(len(own)) - double, -single)
    matrix = -(phi[patch] * areas[:, None]).T @ v_n
    return 0.5 * (matrix + matrix.T)


def _gathered(
    middles: Matrix, normals: Matrix, areas: Vector, count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Patch (k,) of each triangle, and the triangle (n,) in the middle of each patch.

    The patch that is spread most, in place and normal, is halved across that direction until there are enough.
    """
    size = float(np.linalg.norm(np.ptp(middles, axis=0)))
    place = np.concatenate([middles / size, _FACING * normals], axis=1)
    parts = [np.arange(len(middles))]
    spread = [_spread(place, areas)]
    while len(parts) < min(count, len(middles)):
        worst = int(np.argmax([value for value, _ in spread]))
        part, (_, direction) = parts.pop(worst), spread.pop(worst)
        order = np.argsort(place[part] @ direction, kind="stable")
        cut = int(np.searchsorted(np.cumsum(areas[part][order]), 0.5 * areas[part].sum()))
        cut = min(max(cut, 1), len(part) - 1)
        for half in (part[order[:cut]], part[order[cut:]]):
            parts.append(half)
            spread.append(_spread(place[half], areas[half]))
    patch, own = np.empty(len(middles), np.int64), np.empty(len(parts), np.int64)
    for number, part in enumerate(parts):
        patch[part] = number
        centre = np.average(middles[part], axis=0, weights=areas[part])
        own[number] = part[np.argmin(((middles[part] - centre) ** 2).sum(axis=1))]
    return patch, own


def _spread(place: Matrix, weight: Vector) -> tuple[float, Vector]:
    """Weighted second moment along the direction in which it is largest, and that direction; -1 for a single place."""
    away = place - np.average(place, axis=0, weights=weight)
    values, directions = np.linalg.eigh((away * weight[:, None]).T @ away)
    return float(values[-1]) if len(place) > 1 else -1.0, directions[:, -1]
