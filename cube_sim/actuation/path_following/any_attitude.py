"""Whether a body can be held on any course in any attitude, or what it is short of."""

from __future__ import annotations

from itertools import product

import numpy as np

from cube_sim.actuation.attainable.attainable_set import AttainableSet
from cube_sim.actuation.path_following.reasons import along, percent
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.axes import PLANAR, SPATIAL, Matrix

_GRID = np.linspace(-1.0, 1.0, 7)
_TURNS = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
_TILTS = np.radians(np.arange(0.0, 180.5, 1.0))


def shortfall(hull: Dynamics, attainable: AttainableSet, speed_m_s: float) -> str | None:
    """What keeps a body from some course in some attitude: words, or None when nothing does.

    The thrusters are asked for drag and Munk moment at the speed along any body direction (218 of them, 64 in the
    plane), together with weight and lift in any attitude. Weight and lift are linear in `up`: for each facet of the
    attainable set their worst is a norm.

    Args:
        hull: the body.
        attainable: the wrenches its thrusters attain; 3 components are motion in the plane, where it stays upright.
        speed_m_s: over the course.
    """
    planar = attainable.normals.shape[1] == 3
    directions = _horizontal() if planar else _everywhere()
    rows = (PLANAR if planar else SPATIAL).rows
    moving = hull.steady_wrenches(speed_m_s * directions, np.zeros_like(directions))[:, rows]
    shares = attainable.share(moving)
    worst = int(np.argmin(shares))
    if shares[worst] < 1.0:
        return f"of the drag at {speed_m_s:g} m/s along {along(directions[worst])} it holds {percent(shares[worst])}"
    if planar:
        return None
    hydrostatic = hull.steady_wrenches(np.zeros((3, 3)), np.eye(3)).T
    held = _largest_tilt(hydrostatic, attainable)
    if held is not None:
        return f"weight and lift are held up to {held:.0f} deg of tilt"
    normals, offsets = attainable.normals, attainable.offsets
    both = np.max(moving @ normals.T, axis=0, initial=0.0) + np.linalg.norm(normals @ hydrostatic, axis=1)
    asked = both > 0.0
    share = float(np.min(offsets[asked] / both[asked], initial=np.inf))
    if share < 1.0:
        together = f"of drag at {speed_m_s:g} m/s, weight and lift together"
        return f"{together} it holds {percent(share)} in the worst attitude"
    return None


def _largest_tilt(hydrostatic: Matrix, attainable: AttainableSet) -> float | None:
    """The tilt [deg], whichever way, up to which weight and lift are held; None where they are in any attitude."""
    if np.all(np.linalg.norm(attainable.normals @ hydrostatic, axis=1) <= attainable.offsets):
        return None
    held = 0.0
    for tilt in _TILTS:
        up = np.column_stack(
            [np.sin(tilt) * np.cos(_TURNS), np.sin(tilt) * np.sin(_TURNS), np.full(len(_TURNS), np.cos(tilt))]
        )
        if np.any(attainable.share(up @ hydrostatic.T) < 1.0):
            break
        held = float(np.degrees(tilt))
    return held


def _horizontal() -> Matrix:
    """(64,3) unit vectors in the body's xy plane."""
    return np.column_stack([np.cos(_TURNS), np.sin(_TURNS), np.zeros(len(_TURNS))])


def _everywhere() -> Matrix:
    """(218,3) unit vectors through a grid on a cube: axes, edges and corners of the body among them."""
    points = np.array([p for p in product(_GRID, repeat=3) if max(map(abs, p)) == 1.0])
    return points / np.linalg.norm(points, axis=1, keepdims=True)
