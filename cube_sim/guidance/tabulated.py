"""A path held as a table of polynomials in its own arc length."""

from __future__ import annotations

from math import atan2, cos, floor, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.guidance.path import PathPoint, point_of_row
from cube_sim.native.compiled import compiled
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
        self._cells = cells
        self.closed = closed
        self.edges: list[float] = cells.edges.tolist()
        self.length = self.edges[-1]
        _, N1, N2 = cells.frame[0].T
        self._holonomy = atan2(end_frame[:, 1] @ N2, end_frame[:, 1] @ N1) if closed else 0.0

    def at(self, s: float) -> PathPoint:
        """The path at arc length s [m]."""
        turned = 0.0
        if self.closed:
            lap = floor(s / self.length)
            s, turned = s - lap * self.length, lap * self._holonomy
        return point_of_row(look_up(*self._cells, s, cos(turned), sin(turned)))


@compiled
def look_up(edges, position, angle, frame, s, cos_lap, sin_lap):
    """The path at s: (16,) = p, R_WF row by row, k1, k2, dk1/ds, dk2/ds.

    With c = T0.T the smallest rotation from T0 to T takes a normal n of T0 to n - (T.n)/(1 + c) (T0 + T). Along the
    curve that frame spins about T at -T0.(T x T')/(1 + c), which the tabulated angle takes back.

    Args:
        edges: as in `Cells`, like the next three.
        position: see there.
        angle: see there.
        frame: see there.
        s: arc length [m]; beyond an end it is taken as the end.
        cos_lap: of the angle by which both normals are turned about T because of laps already run.
        sin_lap: of the same.
    """
    out = np.empty(16)
    s = min(max(s, edges[0]), edges[-1])
    i = min(max(np.searchsorted(edges, s, side="right") - 1, 0), len(edges) - 2)
    half = 0.5 * (edges[i + 1] - edges[i])
    x = (s - edges[i]) / half - 1.0
    T, dT, ddT = np.zeros(3), np.zeros(3), np.zeros(3)
    for axis in range(3):
        p0, p1, p2, p3 = 0.0, 0.0, 0.0, 0.0
        for power in range(position.shape[1] - 1, -1, -1):
            p3 = p3 * x + p2
            p2 = p2 * x + p1
            p1 = p1 * x + p0
            p0 = p0 * x + position[i, power, axis]
        out[axis] = p0
        T[axis], dT[axis], ddT[axis] = p1 / half, 2.0 * p2 / half**2, 6.0 * p3 / half**3
    T /= np.sqrt(T[0] ** 2 + T[1] ** 2 + T[2] ** 2)
    theta = 0.0
    for power in range(angle.shape[1] - 1, -1, -1):
        theta = theta * x + angle[i, power]

    first = frame[i]
    c = first[0, 0] * T[0] + first[1, 0] * T[1] + first[2, 0] * T[2]
    along_1 = (first[0, 1] * T[0] + first[1, 1] * T[1] + first[2, 1] * T[2]) / (1.0 + c)
    along_2 = (first[0, 2] * T[0] + first[1, 2] * T[1] + first[2, 2] * T[2]) / (1.0 + c)
    turn_c = np.cos(theta) * cos_lap - np.sin(theta) * sin_lap
    turn_s = np.sin(theta) * cos_lap + np.cos(theta) * sin_lap
    out[12:] = 0.0
    for axis in range(3):
        U1 = first[axis, 1] - along_1 * (first[axis, 0] + T[axis])
        U2 = first[axis, 2] - along_2 * (first[axis, 0] + T[axis])
        N1, N2 = turn_c * U1 + turn_s * U2, turn_c * U2 - turn_s * U1
        out[3 + 3 * axis], out[4 + 3 * axis], out[5 + 3 * axis] = T[axis], N1, N2
        out[12] += dT[axis] * N1
        out[13] += dT[axis] * N2
        # (T'.N)' = T''.N, as N' is along T and T' square to it
        out[14] += ddT[axis] * N1
        out[15] += ddT[axis] * N2
    return out
