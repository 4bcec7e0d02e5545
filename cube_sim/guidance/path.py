"""What every path offers: a point, a frame and its bending at each arc length."""

from __future__ import annotations

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
    """

    position: Vector
    rotation: Matrix
    curvature: tuple[float, float]


class Path(Protocol):
    """A curve in space, parametrised by its arc length s in [0, length]."""

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        ...

    def at(self, s: float) -> PathPoint:
        """The path at arc length s [m]; s beyond an end is taken as the end."""
        ...
