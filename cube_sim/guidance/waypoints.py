"""Lists of points a path runs through, checked before anything is built from them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import PathError

CLOSEST = 1e-6
"""Distance between neighbours below which they are the same point [m]."""
MOST = 10_000
FARTHEST = 1e5
"""Largest coordinate [m]: beyond it the last digits of a position are no longer fine beside a vehicle."""
SHORTEST = 0.01
"""Length of the shortest path [m]."""


def as_waypoints(points: ArrayLike, closed: bool, names: Sequence[str] = ()) -> NDArray[np.float64]:
    """The points as an array (n, 3) [m].

    Args:
        points: (n, 3) [m], world axes.
        closed: whether the path returns from the last point to the first, which is then not repeated.
        names: what to call the points in messages; default "point 0", "point 1"...

    Raises:
        PathError: too few, too many, not finite, too far away, or two neighbours coincide; it points at the later one.
    """
    array = np.asarray(points, dtype=float)
    least = 3 if closed else 2
    if len(array) < least:
        raise PathError(f"{'a closed' if closed else 'an open'} path needs {least} or more points, got {len(array)}")
    if len(array) > MOST:
        raise PathError(f"at most {MOST} points make a path, got {len(array)}")
    if array.ndim != 2 or array.shape[1] != 3:
        raise PathError(f"points have three coordinates, got an array of shape {array.shape}")

    def name(i: int) -> str:
        return names[i] if names else f"point {i}"

    bad = ~np.isfinite(array).all(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        raise PathError(f"{name(i)} is not finite", i)
    far = np.abs(array).max(axis=1) > FARTHEST
    if far.any():
        i = int(np.argmax(far))
        largest = np.abs(array[i]).max()
        raise PathError(f"{name(i)} has a coordinate of {largest:g} m; {FARTHEST:g} m at most make sense", i)
    steps = np.linalg.norm(np.diff(array, axis=0, append=array[:1]), axis=1)
    if not closed:
        steps = steps[:-1]
    near = steps < CLOSEST
    if near.any():
        i = int(np.argmax(near))
        if i == len(array) - 1:
            raise PathError(f"{name(i)} repeats {name(0)}: a closed path returns to its first point by itself", i)
        raise PathError(f"{name(i + 1)} coincides with {name(i)}", i + 1)
    if steps.sum() < SHORTEST:
        raise PathError(f"the points make a path of {steps.sum():g} m; the shortest is {SHORTEST:g} m")
    return array
