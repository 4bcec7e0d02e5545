"""Added mass of a deeply submerged hull in an ideal fluid, by panels.

Green's third identity on the surface, with the normal n into the fluid and G = 1/(4 pi r), and its derivative along n:

    phi/2 = K phi - V v_n          K phi = integral of phi dG/dn,  V v_n = integral of G v_n
    D phi = -(v_n/2 + K' v_n)      <D phi, psi> = integral of integral of G (n x grad phi) . (n x grad psi)

v_n is given by each of the six motions, phi sought; M_A[i, j] = -rho <phi_i, v_j> (H. Lamb, Hydrodynamics, 6th ed.
1932, arts. 57, 58 and 118). With both,

    M_A[i, j] = rho ( <v_i, V v_j> + <b_i, D^-1 b_j> ),   b = v_n/2 + K' v_n

which is symmetric and positive definite however coarse the panels are (for the operators: O. Steinbach, Numerical
Approximation Methods for Elliptic Boundary Value Problems, 2008, chapter 6). phi is linear on each triangle and
continuous, by Galerkin's method; v_n is exact. The error of M_A goes with the square of that of phi.

At a sharp edge the flow is singular, and panels converge slowly. They are made finer there, and two sets of panels are
carried on to infinitely many: what is left is of the order of `AddedMass.error`. A mesh that is finer than the flow
needs is simplified first (`cube_sim.hull_shape.simplification`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from cube_sim.errors import ShapeError
from cube_sim.hull_shape.division import divided
from cube_sim.hull_shape.influence import QUARTERED, SEVEN, THREE, linear_panels
from cube_sim.hull_shape.mesh import ClosedMesh
from cube_sim.hull_shape.simplification import simplified
from cube_sim.hull_shape.slivers import without_slivers
from cube_sim.spatial import Matrix, Vector, skew

COARSE, FINE = 900, 2400
"""So many panels the two sets have at most (a choice: some seconds)."""
MOST_PANELS, SIMPLIFIED = 1600, 700
"""Meshes of more triangles are simplified first, to so many (a choice)."""


@dataclass(frozen=True)
class AddedMass:
    """Added mass, as panels give it.

    Attributes:
        matrix: M_A (6,6) about the origin, body axes, symmetric positive definite [kg, kg m, kg m^2].
        error: of its diagonal, relative: what the last step of refinement still changed, twice what is left by theory.
        panels: how many the finer set had.
    """

    matrix: Matrix
    error: float
    panels: int


def added_mass(mesh: ClosedMesh, density: float) -> AddedMass:
    """Added mass of a hull.

    Args:
        mesh: its surface, body axes.
        density: of the water [kg/m^3].

    Raises:
        ShapeError: it has so many bodies that it cannot be simplified.
    """
    # Lengths of one, about the middle: nothing then depends on units, or on where the origin is.
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    middle, length = 0.5 * (low + high), float(np.linalg.norm(high - low))
    unit = without_slivers(ClosedMesh((mesh.vertices - middle) / length, mesh.faces))
    if len(unit.faces) > MOST_PANELS:
        unit = without_slivers(simplified(unit, SIMPLIFIED))
    if len(unit.faces) > MOST_PANELS:
        raise ShapeError(
            f"the hull cannot be drawn in less than {len(unit.faces)} triangles, {MOST_PANELS} at most: leave out "
            "screws and other small bodies"
        )
    coarse = divided(unit, max(COARSE, len(unit.faces)))
    fine = divided(coarse, max(FINE, 3 * len(coarse.faces)))
    worse, best = linear_added_mass(coarse), linear_added_mass(fine)
    few, many = len(coarse.faces), len(fine.faces)
    # Beside a singular edge, with panels that are finer there, the error goes with 1 / their number.
    change = (best - worse) / (many / few - 1.0)
    limit = best + change
    scale = np.sqrt(np.diag(best))
    if np.linalg.eigvalsh(limit / np.outer(scale, scale))[0] <= 0.0:
        limit = best
    slight = np.repeat([1e-2 * best.diagonal()[:3].max(), 1e-3 * best.diagonal()[:3].max()], 3)  # a sphere's rotation
    error = float((np.abs(change.diagonal()) / np.maximum(best.diagonal(), slight)).max())
    units = np.repeat([1.0, length], 3)
    return AddedMass(about(density * length**3 * limit * np.outer(units, units), -middle), error, many)


def about(matrix: Matrix, point: Vector) -> Matrix:
    """M (6,6) about a point (3,) of a mass matrix about the origin; the axes stay.

    The velocity of the origin is that of the point plus w x (0 - point).
    """
    carried = np.eye(6)
    carried[:3, 3:] = skew(point)
    return carried.T @ matrix @ carried


def linear_added_mass(mesh: ClosedMesh) -> Matrix:
    """M_A/rho (6,6) of a surface of which every triangle is a panel."""
    triangles, faces = mesh.triangles, mesh.faces
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    normals, areas = normals / doubled[:, None], 0.5 * doubled
    k, n = len(faces), len(mesh.vertices)
    V, W, flux = np.empty((k, k)), np.empty((6, 6)), np.empty((k, 3, 6))
    linear_panels(triangles, normals, areas, THREE, SEVEN, QUARTERED, V, W, flux)
    V = 0.5 * (V + V.T)
    b = np.zeros((n, 6))
    for corner in range(3):
        at = 0.25 * (triangles[:, corner] + triangles.sum(axis=1))  # mean of y, weighted by the corner's function
        v_n = np.concatenate([normals, np.cross(at, normals)], axis=1)
        np.add.at(b, faces[:, corner], flux[:, corner] + areas[:, None] / 6.0 * v_n)
    # n x grad of a corner's linear function: the side across from it over twice the area.
    across = np.stack([triangles[:, (c + 2) % 3] - triangles[:, (c + 1) % 3] for c in range(3)]) / doubled[:, None]
    D = np.zeros((n, n))
    for axis in range(3):
        entries = (across[:, :, axis].ravel(), (faces.T.ravel(), np.tile(np.arange(k), 3)))
        curl = coo_array(entries, shape=(n, k)).tocsr()
        D += curl @ (curl @ V).T
    # A constant potential on a body makes no flow: it is fixed, and none is asked for.
    weight = np.bincount(faces.ravel(), np.repeat(areas / 3.0, 3), n)
    stiffness = np.trace(D) / n
    sides = coo_array((np.ones(3 * k), (faces.ravel(), faces[:, [1, 2, 0]].ravel())), shape=(n, n))
    count, body = connected_components(sides, directed=False)
    for each in range(count):
        of = np.where(body == each, weight, 0.0)
        b -= np.outer(of, b[body == each].sum(axis=0) / of.sum())
        D += np.outer(of, of) * (stiffness / (of @ of))
    matrix = W + b.T @ np.linalg.solve(D, b)
    return 0.5 * (matrix + matrix.T)
