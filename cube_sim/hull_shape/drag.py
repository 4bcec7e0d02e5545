"""Drag of a hull as its shadow and section suggest: an estimate, to be replaced by what is measured.

    D_q[i, i] = rho/2 C_i A_i                                                    (along an axis)
    D_q[i, i] = rho/2 (C_j integral of |r_k|^3 dA_j + C_k integral of |r_j|^3 dA_k)   (about it: strips, each met alone)

C is that of a body of simple shape and the same proportions (S. F. Hoerner, Fluid-Dynamic Drag, 1965, chapter 3; the
numbers as F. M. White, Fluid Mechanics, 7th ed. 2011, table 7.3 has them). Hulls of open frames, with thrusters, cables
and gaps, have more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.hull_shape.silhouette import Silhouettes
from cube_sim.spatial import Vector

FLAT_FACED = ((0.0, 1.18), (0.5, 1.15), (1.0, 1.05), (2.0, 0.85), (4.0, 0.87), (8.0, 0.99))
"""(length along the flow over width, C): a plate, flat-faced cylinders, a cube (1.05)."""
ELLIPSOID = ((0.75, 0.50), (1.0, 0.47), (2.0, 0.27), (4.0, 0.25), (8.0, 0.20))
"""(length along the flow over width, C), laminar: the higher."""
CYLINDER = ((1.0, 0.64), (2.0, 0.68), (3.0, 0.74), (5.0, 0.74), (10.0, 0.82), (20.0, 0.91))
"""(length over diameter, C) of one across the flow, laminar."""
BOXY = 0.7
"""Where this share of the shadow is met flat, a hull counts as flat-faced (a choice)."""
SLOW_M_S = 0.1
"""Linear drag is the quadratic one at this speed: what identified tables of small vehicles have, 0.10 to 0.17 m/s in
von Benzon et al. 2022, table A1 (a choice)."""


@dataclass(frozen=True)
class Drag:
    """An estimate, about the body origin, body axes.

    Attributes:
        quadratic: (6,) diagonal of D_q [N s^2/m^2, N m s^2].
        linear: (6,) diagonal of D [N s/m, N m s].
        coefficients: (3,) C along each axis.
        likened: (3,) to what, in words.
    """

    quadratic: Vector
    linear: Vector
    coefficients: Vector
    likened: tuple[str, str, str]


def drag_of(shown: Silhouettes, size: Vector, density: float) -> Drag:
    """Drag of a hull.

    Args:
        shown: its shadows.
        size: (3,) its extent along each axis [m].
        density: of the water [kg/m^3].
    """
    coefficients, likened = np.zeros(3), []
    for i in range(3):
        coefficients[i], what = _coefficient(i, shown, size)
        likened.append(what)
    quadratic = np.zeros(6)
    quadratic[:3] = 0.5 * density * coefficients * shown.areas
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        strips = coefficients[j] * shown.third_moments[j, k] + coefficients[k] * shown.third_moments[k, j]
        quadratic[3 + i] = 0.5 * density * strips
    slow = np.repeat([SLOW_M_S, 4.0 * SLOW_M_S / float(size.max())], 3)  # of the hull's quarters, in rotation
    return Drag(quadratic, slow * quadratic, coefficients, (likened[0], likened[1], likened[2]))


def _coefficient(i: int, shown: Silhouettes, size: Vector) -> tuple[float, str]:
    across = sorted(float(size[k]) for k in range(3) if k != i)
    slender = float(size[i]) / np.sqrt(across[0] * across[1])
    if shown.flat[i] > BOXY:
        return _at(FLAT_FACED, slender), f"a flat-faced block {slender:.2g} times as long as wide"
    if slender >= 1.0 or across[1] < 1.5 * across[0]:
        return _at(ELLIPSOID, slender), f"an ellipsoid {slender:.2g} times as long as wide"
    long = across[1] / across[0]
    return _at(CYLINDER, long), f"a cylinder across the flow, {long:.2g} times as long as thick"


def _at(table: tuple[tuple[float, float], ...], ratio: float) -> float:
    ratios, values = zip(*table, strict=True)
    return float(np.interp(ratio, ratios, values))
