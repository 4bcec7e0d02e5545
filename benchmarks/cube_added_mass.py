"""Added mass of a cube in an ideal fluid, by panels: where the coefficients of models/cube.xml come from.

Green's third identity on the surface, with the normal into the fluid and G = 1/(4 pi r):

    phi/2 = integral of phi dG/dn - integral of G v_n        (v_n given by the motion, phi sought)
    M_A[i, j] = -rho integral of phi_i v_n,j

Rectangular panels of constant phi, finer towards the edges, where the flow is singular; both integrals over a panel in
closed form. Run it: python benchmarks/cube_added_mass.py
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def coefficients(n: int) -> tuple[float, float]:
    """(M11 / (rho L^3), M44 / (rho L^5)) of a cube of edge L with n by n panels on each face."""
    t = np.arange(n + 1) / n
    edges = t**2 / (t**2 + (1.0 - t) ** 2) - 0.5
    middle, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    a, b = (grid.ravel() for grid in np.meshgrid(middle, middle, indexing="ij"))
    area = np.outer(width, width).ravel()
    points, normals = [], []
    for axis in range(3):
        for side in (-0.5, 0.5):
            at = np.zeros((n * n, 3))
            at[:, axis], at[:, (axis + 1) % 3], at[:, (axis + 2) % 3] = side, a, b
            points.append(at)
            normals.append(np.tile(np.sign(side) * np.eye(3)[axis], (n * n, 1)))
    p, normal = np.concatenate(points), np.concatenate(normals)
    single, double = _influence(p, edges)
    v_n = np.stack([normal[:, 0], np.cross(p, normal)[:, 0]], axis=1)  # surge and roll at unit speed
    phi = np.linalg.solve(0.5 * np.eye(len(p)) - double, -single @ v_n)
    mass = -np.einsum("k,ki,ki->i", np.tile(area, 6), phi, v_n)
    return float(mass[0]), float(mass[1])


def extrapolated(n: int) -> tuple[float, float]:
    """The same for infinitely many panels, from n and n/2: their error goes with 1/n^2."""
    coarse, fine = np.array(coefficients(n // 2)), np.array(coefficients(n))
    translation, rotation = fine + (fine - coarse) / 3.0
    return float(translation), float(rotation)


def _influence(p: Array, edges: Array) -> tuple[Array, Array]:
    """Integrals of G and of dG/dn over every panel (columns) at every point (rows)."""
    single, double = [], []
    for axis in range(3):
        for side in (-0.5, 0.5):
            z = (np.sign(side) * p[:, axis] - 0.5)[:, None, None]
            x = edges[None, :, None] - p[:, (axis + 1) % 3][:, None, None]
            y = edges[None, None, :] - p[:, (axis + 2) % 3][:, None, None]
            r = np.sqrt(x**2 + y**2 + z**2)
            on_plane = np.abs(z) < 1e-12
            angle = np.where(on_plane, 0.0, np.arctan(x * y / np.where(on_plane, 1.0, z * r)))
            potential = x * np.log(y + r) + y * np.log(x + r) - z * angle
            for table, corner in ((single, potential), (double, angle)):
                over = corner[:, 1:, 1:] - corner[:, :-1, 1:] - corner[:, 1:, :-1] + corner[:, :-1, :-1]
                table.append(over.reshape(len(p), -1) / (4.0 * np.pi))
    return np.concatenate(single, axis=1), np.concatenate(double, axis=1)


def main() -> None:
    """Print the coefficients for finer and finer panels, and what they tend to."""
    print("panels  M11/(rho L^3)  M44/(rho L^5)   tending to")
    for n in (8, 12, 16, 20, 28):
        (translation, rotation), limit = coefficients(n), extrapolated(n)
        print(f"{6 * n * n:6d}  {translation:13.5f}  {rotation:13.6f}   {limit[0]:.4f}  {limit[1]:.5f}")


if __name__ == "__main__":
    main()
