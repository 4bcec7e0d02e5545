"""What every path offers: a point, a frame and its bending at each arc length."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from cube_sim.spatial import Matrix, Vector


class PathPoint(NamedTuple):
    """A path at one arc length.

    The frame {F} = [T, N1, N2] is a parallel-transport frame (R. L. Bishop, There is more than one way to frame a
    curve, 1975): T' = k1 N1 + k2 N2, N1' = -k1 T, N2' = -k2 T along the arc length. Unlike Frenet's it exists on
    straight stretches and does not flip at inflections.

    Attributes:
        position: p_d (3,) [m], world axes.
        rotation: R_WF (3,3), its columns T, N1, N2.
        curvature: (k1, k2) [1/m].
        curvature_rate: (dk1/ds, dk2/ds) [1/m^2].
    """

    position: Vector
    rotation: Matrix
    curvature: tuple[float, float]
    curvature_rate: tuple[float, float]


def point_of_row(row: Vector) -> PathPoint:
    """The point whose numbers a compiled law has put in a row (16,): p, R_WF row by row, k1, k2, dk1/ds, dk2/ds."""
    k1, k2, dk1, dk2 = row[12:].tolist()
    return PathPoint(row[:3], row[3:12].reshape(3, 3), (k1, k2), (dk1, dk2))


class Path(Protocol):
    """A curve in space, parametrised by its arc length s."""

    @property
    def length(self) -> float:
        """Length of the path, once round if it is closed [m]."""
        ...

    @property
    def closed(self) -> bool:
        """Whether the path ends where it starts, in the same direction and with the same curvature."""
        ...

    @property
    def edges(self) -> Sequence[float]:
        """Arc lengths (n+1,) from 0 to the length [m] between which the path is simple.

        From one to the next it turns by less than a radian with a smooth curvature, or keeps its curvature.
        """
        ...

    def at(self, s: float) -> PathPoint:
        """The path at arc length s [m].

        On an open path s beyond an end is taken as the end. On a closed one s counts on over the laps, also backwards;
        the frame goes on being parallel-transported, so after a lap it is turned about the tangent by the curve's
        holonomy (nothing for a curve in a plane).
        """
        ...
