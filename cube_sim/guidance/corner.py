"""The rounding of a polyline's corners.

Between its two legs a corner turns by theta. Its heading is the quintic phi = theta (10 x^3 - 15 x^4 + 6 x^5) of x, the
share of its arc length. The curvature rate is continuous, and zero at both ends. A clothoid pair is continuous in
curvature too, but its curvature rate jumps three times per corner, and with it the yaw moment of a dynamic law. The
heading is given by arc length itself, so nothing needs to be reparametrised. The corner is shorter, too: 1.875 theta R
for a smallest radius of curvature R, against 2 theta R.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import PathError

Array = NDArray[np.float64]

STRAIGHT = 1e-9
"""Turn below which a corner needs no rounding [rad]."""
SHARPEST = np.radians(175.0)
"""Turn above which a path doubles back on itself and no rounding of a useful length exists [rad]."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(32)
_SHARE = 0.5 * (1.0 + _NODES)


class Corner(NamedTuple):
    """One rounded corner.

    Attributes:
        turn: theta [rad].
        length: of the rounded part [m].
        trim: how much of each leg it replaces [m].
        ahead: direction of the leg that leads in (3,).
        inward: unit vector square to it, towards the leg that leads out (3,); zero where nothing turns.
    """

    turn: float
    length: float
    trim: float
    ahead: Array
    inward: Array

    def direction(self, along: Array) -> Array:
        """Unit tangents (k, 3) at arc lengths (k,) from the corner's start [m]."""
        phi = (self.turn * heading_share(along / self.length))[:, None]
        return np.cos(phi) * self.ahead + np.sin(phi) * self.inward


def heading_share(x: Array) -> Array:
    """phi / theta at the share x of the corner's length."""
    return x**3 * (10.0 + x * (-15.0 + 6.0 * x))


def round_corners(points: Array, radius: float, closed: bool, names: Sequence[str] = ()) -> list[Corner]:
    """A corner per inner point of a polyline, or per point of a closed one.

    Args:
        points: (n, 3) [m], checked as by `cube_sim.guidance.waypoints.as_waypoints`.
        radius: smallest radius of curvature R of the corners [m].
        closed: whether the last point leads back to the first.
        names: what to call the points in messages; default "point 0", "point 1"...

    Raises:
        PathError: the path doubles back, or two corners do not fit on the leg between them; it points at the point at
            fault and says which radius would fit.
    """
    require_no_reversal(points, closed, names)
    legs = np.diff(points, axis=0, append=points[:1]) if closed else np.diff(points, axis=0)
    lengths = np.linalg.norm(legs, axis=1)
    ahead = legs / lengths[:, None]
    n = len(points)
    names = names or [f"point {i}" for i in range(n)]
    inner = range(n) if closed else range(1, n - 1)
    corners = [_corner(ahead[i - 1], ahead[i], radius) for i in inner]

    trims = np.zeros(n)
    trims[inner.start : inner.stop] = [corner.trim for corner in corners]
    after = np.roll(trims, -1)[: len(lengths)]
    needed = trims[: len(lengths)] + after
    i = int(np.argmax(needed / lengths))
    if needed[i] > lengths[i] * (1.0 + 1e-12):
        j = (i + 1) % n
        raise PathError(
            f"corners of {radius:g} m radius need {needed[i]:.3g} m of the leg from {names[i]} to {names[j]}, which is"
            f" {lengths[i]:.3g} m long: the largest radius that fits is {radius * lengths[i] / needed[i]:.3g} m",
            i if trims[i] > trims[j] else j,
        )
    return corners


def require_no_reversal(points: Array, closed: bool, names: Sequence[str] = ()) -> None:
    """Refuse points at which a path turns by more than `SHARPEST`.

    Args:
        points: (n, 3) [m], checked as by `cube_sim.guidance.waypoints.as_waypoints`.
        closed: whether the last point leads back to the first.
        names: what to call the points in messages; default "point 0", "point 1"...

    Raises:
        PathError: the path doubles back; it points at the point where.
    """
    legs = np.diff(points, axis=0, append=points[:1])
    ahead = legs / np.maximum(np.linalg.norm(legs, axis=1, keepdims=True), 1e-300)
    before = np.roll(ahead, 1, axis=0)
    turn = 2.0 * np.arctan2(np.linalg.norm(ahead - before, axis=1), np.linalg.norm(ahead + before, axis=1))
    if not closed:
        turn[[0, -1]] = 0.0
    sharp = turn > SHARPEST
    if sharp.any():
        i = int(np.argmax(sharp))
        raise PathError(f"the path doubles back at {names[i] if names else f'point {i}'}", i)


def _corner(ahead: Array, out: Array, radius: float) -> Corner:
    """The corner between two legs' directions."""
    side = out - ahead * (ahead @ out)
    size = float(np.linalg.norm(side))
    turn = float(np.arctan2(size, ahead @ out))
    if turn < STRAIGHT:
        return Corner(0.0, 0.0, 0.0, ahead, np.zeros(3))
    length = 1.875 * turn * radius
    # its chord lies at half the turn to both legs
    chord = length * 0.5 * float(_WEIGHTS @ np.cos(turn * (heading_share(_SHARE) - 0.5)))
    return Corner(turn, length, chord / (2.0 * cos(0.5 * turn)), ahead, side / size)
