"""Which part of a line is in a box, given across normals: the one cut that every search along a line of wrenches makes.

The wrenches w of a box of forces are ``lower <= normals @ w <= upper`` across the facets of {A F_m}, so the part of a
line ``base + t slope`` that the box attains is an interval of t in closed form.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled, inlined


@inlined
def narrowed(first: float, last: float, bottom: float, top: float, slope: float) -> tuple[float, float]:
    """The part of [first, last] in which ``bottom <= slope * t <= top``; its first end lies above its last for none.

    Args:
        first: end of the interval of t so far.
        last: other end of it.
        bottom: least value along a normal.
        top: largest value along it.
        slope: of the value along it, per unit of t; 0 for a line along the facet, which is inside it or is not.
    """
    if slope == 0.0:
        if bottom > 0.0 or top < 0.0:
            first, last = 1.0, 0.0
    elif slope > 0.0:
        first, last = max(first, bottom / slope), min(last, top / slope)
    else:
        first, last = max(first, top / slope), min(last, bottom / slope)
    return first, last


@compiled
def interval_in_box(
    along: NDArray[np.float64],
    lower: NDArray[np.float64],
    upper: NDArray[np.float64],
    farthest: float,
    tolerance: float,
) -> tuple[float, float]:
    """Ends of the t in [-farthest, farthest] at which t times a wrench is in a box; the first above the last for none.

    Args:
        along: (h,) the wrench along each normal.
        lower: (h,) least of the box along it.
        upper: (h,) largest.
        farthest: largest |t|.
        tolerance: along a normal, that counts as rounding.
    """
    first, last = -farthest, farthest
    for a in range(along.shape[0]):
        first, last = narrowed(first, last, lower[a] - tolerance, upper[a] + tolerance, along[a])
        if first > last:
            return 1.0, 0.0
    return first, last
