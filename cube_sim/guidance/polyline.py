"""Straight legs between waypoints, with rounded corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.guidance.corner import round_corners
from cube_sim.guidance.tabulated import TabulatedPath
from cube_sim.guidance.tabulation import Piece, tabulate
from cube_sim.guidance.waypoints import as_waypoints


def polyline(points: ArrayLike, radius: float, closed: bool = False) -> TabulatedPath:
    """The path along straight legs that rounds each corner as `cube_sim.guidance.corner` says.

    A closed one starts where the first leg becomes straight, just after the corner at the first point.

    Args:
        points: (n, 3) [m], world axes.
        radius: smallest radius of curvature of the corners [m].
        closed: whether the last point leads back to the first.

    Raises:
        PathError: points coincide or the corners do not fit.
    """
    corners_at = as_waypoints(points, closed)
    corners = round_corners(corners_at, radius, closed)
    n = len(corners_at)
    legs = np.diff(corners_at, axis=0, append=corners_at[:1]) if closed else np.diff(corners_at, axis=0)
    lengths = np.linalg.norm(legs, axis=1)
    ahead = legs / lengths[:, None]
    # the corner at the start and at the end of each leg, None at the ends of an open path
    before = corners if closed else [None, *corners]
    after = [*corners[1:], corners[0]] if closed else [*corners, None]

    pieces: list[Piece] = []
    for i, (first, last) in enumerate(zip(before, after, strict=True)):
        cut = (first.trim if first else 0.0, last.trim if last else 0.0)
        straight = lengths[i] - sum(cut)
        if straight > 1e-9 * lengths[i]:
            pieces.append(Piece(lambda u, T=ahead[i]: np.tile(T, (len(u), 1)), straight, (i,)))
        if last is not None and last.turn > 0.0:
            pieces.append(Piece(last.direction, last.length, ((i + 1) % n,)))
    start = corners_at[0] + ahead[0] * (corners[0].trim if closed else 0.0)
    return tabulate(start, pieces, closed)
