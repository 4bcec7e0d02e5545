"""The normals with which a parallel-transport frame starts."""

from __future__ import annotations

import numpy as np

from cube_sim.spatial import Matrix, Vector, cross

UP = np.array([0.0, 0.0, 1.0])
STEEP = 1e-3
"""Sine of the angle to the vertical below which left and up are not told apart by the tangent."""


def starting_frame(tangent: Vector) -> Matrix:
    """R_WF (3,3) with N1 level and to the left, N2 upwards; on a vertical tangent N1 is world y.

    In a horizontal plane N1 stays to the left and N2 upright, and k1 is the signed curvature of plane geometry,
    positive to the left.
    """
    level = cross(UP, tangent)
    if level @ level < STEEP**2:
        level = np.array([0.0, 1.0, 0.0]) - tangent * tangent[1]
    N1 = level / np.linalg.norm(level)
    return np.column_stack([tangent, N1, cross(tangent, N1)])
