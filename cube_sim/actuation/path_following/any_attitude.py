"""Whether a body can be held on any course in any attitude, or what it is short of."""

from __future__ import annotations

from itertools import product

import numpy as np

from cube_sim.actuation.attainable.attainable_set import Attainable
from cube_sim.actuation.path_following.percent import percent
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.axes import PLANAR, SPATIAL, Matrix, Vector

_GRID = np.linspace(-1.0, 1.0, 7)
_TURNS = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
_TILTS = np.radians(np.arange(0.0, 180.5, 1.0))


def shortfall(hull: Dynamics, reach: Attainable, speed_m_s: float) -> str | None:
    """What keeps a body from some course in some attitude: words, or None when nothing does.

    Asked are drag and Munk moment at the speed along any body direction (218 of them, 64 in the plane) together with
    weight and lift in any attitude, which are linear in `up`: per facet of the attainable set their worst is a norm.

    Args:
        hull: the body.
        reach: what its thrusters attain; 3 components are motion in the plane, where it stays upright.
        speed_m_s: over the course.
    """
    planar = reach.normals.shape[1] == 3
    directions = _horizontal() if planar else _everywhere()
    rows = (PLANAR if planar else SPATIAL).rows
    moving = hull.steady_wrenches(speed_m_s * directions, np.zeros_like(directions))[:, rows]
    shares = reach.share(moving)
    worst = int(np.argmin(shares))
    if shares[worst] < 1.0:
        return f"of the drag at {speed_m_s:g} m/s along {_words(directions[worst])} it holds {percent(shares[worst])}"
    if planar:
        return None
    floating = hull.steady_wrenches(np.zeros((3, 3)), np.eye(3)).T
    held = _largest_tilt(floating, reach)
    if held is not None:
        return f"weight and lift are held up to {held:.0f} deg of tilt"
    both = np.max(moving @ reach.normals.T, axis=0, initial=0.0) + np.linalg.norm(reach.normals @ floating, axis=1)
    asked = both > 0.0
    share = float(np.min(reach.reach[asked] / both[asked], initial=np.inf))
    if share < 1.0:
        together = f"of drag at {speed_m_s:g} m/s, weight and lift together"
        return f"{together} it holds {percent(share)} in the worst attitude"
    return None


def _largest_tilt(floating: Matrix, reach: Attainable) -> float | None:
    """The tilt [deg], whichever way, up to which weight and lift are held; None when in any attitude."""
    if np.all(np.linalg.norm(reach.normals @ floating, axis=1) <= reach.reach):
        return None
    held = 0.0
    for tilt in _TILTS:
        up = np.column_stack(
            [np.sin(tilt) * np.cos(_TURNS), np.sin(tilt) * np.sin(_TURNS), np.full(len(_TURNS), np.cos(tilt))]
        )
        if np.any(reach.share(up @ floating.T) < 1.0):
            break
        held = float(np.degrees(tilt))
    return held


def _horizontal() -> Matrix:
    return np.column_stack([np.cos(_TURNS), np.sin(_TURNS), np.zeros(len(_TURNS))])


def _everywhere() -> Matrix:
    """(218,3) unit vectors through a grid on a cube: axes, edges and corners of the body among them."""
    points = np.array([p for p in product(_GRID, repeat=3) if max(map(abs, p)) == 1.0])
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def _words(direction: Vector) -> str:
    x, y, z = np.round(direction, 2) + 0.0
    return f"the body's ({x:g}, {y:g}, {z:g})"
