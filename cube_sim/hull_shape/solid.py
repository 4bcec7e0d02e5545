"""Volume, centre and inertia of what a closed surface encloses, at uniform density."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.hull_shape.mesh import ClosedMesh
from cube_sim.spatial import Matrix, Vector


@dataclass(frozen=True)
class Solid:
    """What a surface encloses.

    Attributes:
        volume: V [m^3].
        centre: (3,) of the volume, the centre of buoyancy [m], body axes.
        inertia_per_mass: (3,3) of a uniform body about its centre, divided by its mass [m^2], body axes.
        low: (3,) least coordinates [m].
        high: (3,) largest.
    """

    volume: float
    centre: Vector
    inertia_per_mass: Matrix
    low: Vector
    high: Vector

    @property
    def size(self) -> Vector:
        """(3,) extent along each axis [m]."""
        return self.high - self.low


def solid_of(mesh: ClosedMesh) -> Solid:
    """Integrals over tetrahedra from one point to each triangle; signed, so that they add up for any shape.

    For a tetrahedron with one corner at the origin and the others a, b, c, the integral of x x' is
    (det/120) (s s' + a a' + b b' + c c'), s = a + b + c.
    """
    triangles = mesh.triangles
    middle = 0.5 * (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0))
    a, b, c = (triangles[:, i] - middle for i in range(3))
    six = np.einsum("ki,ki->k", a, np.cross(b, c))
    volume = float(six.sum()) / 6.0
    total = a + b + c
    centre = six @ total / (24.0 * volume)
    second = sum(np.einsum("k,ki,kj->ij", six, each, each) for each in (total, a, b, c)) / 120.0
    second = second / volume - np.outer(centre, centre)
    inertia = np.trace(second) * np.eye(3) - second
    return Solid(volume, centre + middle, inertia, mesh.vertices.min(axis=0), mesh.vertices.max(axis=0))
