"""A path held as a table of polynomials in its own arc length."""

from __future__ import annotations

from math import atan2
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.guidance.path import PathPoint, point_of_row
from cube_sim.guidance.path_record import PATH, TABLE, Parts, path_row
from cube_sim.spatial import Matrix

Table = NDArray[np.float64]


class Cells(NamedTuple):
    """Consecutive stretches of a path, each with polynomials in x = (s - middle) / half, from -1 to 1.

    Attributes:
        edges: arc lengths between which cells lie (n+1,) [m].
        position: coefficients of p (n, d+1, 3) [m], lowest power first.
        angle: coefficients (n, d+1) [rad] of the angle by which parallel transport turns the normals about the tangent,
            beyond what the smallest rotation from the cell's first tangent to the present one does.
        frame: R_WF at the start of each cell (n, 3, 3).
    """

    edges: Table
    position: Table
    angle: Table
    frame: Table


class TabulatedPath:
    """A path read from a table; see `cube_sim.guidance.tabulation` for how one is made and how accurate it is.

    Args:
        cells: the table.
        end_frame: R_WF at the path's end (3,3).
        closed: whether it ends where it starts.
    """

    def __init__(self, cells: Cells, end_frame: Matrix, closed: bool = False) -> None:
        self.closed = closed
        self.edges: list[float] = cells.edges.tolist()
        self.length = self.edges[-1]
        _, N1, N2 = cells.frame[0].T
        record = np.zeros(1, PATH)
        record["kind"], record["closed"], record["length"] = TABLE, closed, self.length
        record["holonomy"] = atan2(end_frame[:, 1] @ N2, end_frame[:, 1] @ N1) if closed else 0.0
        edges, position, angle, frame = (np.ascontiguousarray(part) for part in cells)
        self.parts: Parts = (record, edges, position, angle, frame)

    def at(self, s: float) -> PathPoint:
        """The path at arc length s [m]."""
        return point_of_row(path_row(*self.parts, s))
