"""A level sine wave."""

from __future__ import annotations

from math import ceil, pi

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.guidance.tabulated import TabulatedPath
from cube_sim.guidance.tabulation import Piece, tabulate


def sinusoid(
    start: ArrayLike, amplitude: float, wavelength: float, periods: float, heading: float = 0.0
) -> TabulatedPath:
    """The curve amplitude sin(2 pi x / wavelength) to the left of a level axis, x along it.

    Its smallest radius of curvature, at the crests, is wavelength^2 / (4 pi^2 amplitude).

    Args:
        start: (3,) [m], world axes, on the axis.
        amplitude: [m]; negative begins to the right.
        wavelength: [m].
        periods: how many wavelengths of it.
        heading: of the axis, from world x towards world y [rad].
    """
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    left = np.array([-np.sin(heading), np.cos(heading), 0.0])
    k, quarter, length = 2.0 * pi / wavelength, wavelength / 4.0, periods * wavelength

    def piece(i: int) -> Piece:
        # each quarter wave counts from its own start: the phase of the thousandth wave is as exact as the first's
        slope = (np.cos, lambda x: -np.sin(x), lambda x: -np.cos(x), np.sin)[i % 4]
        return Piece(lambda u: ahead + np.outer(amplitude * k * slope(k * u), left), min(quarter, length - i * quarter))

    return tabulate(start, [piece(i) for i in range(max(1, ceil(4.0 * periods - 1e-9)))])
