"""Hulls that are bodies of revolution, and their added mass by sources on rings: shares nothing with cube_sim.

A source of density sigma cos(m theta) lies on each cone between two stations, and the flow through the middle of each
is that of the hull's motion: m = 0 ahead, m = 1 across and about a diameter. What a ring does is known by complete
elliptic integrals.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipkm1

FOOT_M = 0.3048
SUBOFF_LENGTH_M = 14.291667 * FOOT_M
SUBOFF_CAP_FT = 13.979167


def suboff_radius(x: np.ndarray) -> np.ndarray:
    """Radius [m] of the bare hull of DARPA SUBOFF at x [m] from its bow.

    N. Groves, T. Huang and M. Chang, Geometric characteristics of DARPA SUBOFF models, DTRC/SHD-1298-01, 1989:
    forebody, cylinder, afterbody and cap, in feet.
    """
    ft = np.asarray(x) / FOOT_M
    bow = 0.3 * ft - 1.0
    fore = 1.126395101 * ft * bow**4 + 0.442874707 * ft**2 * bow**3 + 1.0 - bow**4 * (1.2 * ft + 1.0)
    end, k0, k1 = 0.1175, 10.0, 44.6244
    xi, square = (SUBOFF_CAP_FT - ft) / 3.333333, end**2
    aft = square + end * k0 * xi**2
    aft += (20.0 - 20.0 * square - 4.0 * end * k0 - k1 / 3.0) * xi**3
    aft += (-45.0 + 45.0 * square + 6.0 * end * k0 + k1) * xi**4
    aft += (36.0 - 36.0 * square - 4.0 * end * k0 - k1) * xi**5
    aft += (-10.0 + 10.0 * square + end * k0 + k1 / 3.0) * xi**6
    cap = square * (1.0 - (3.2 * ft - 44.733333) ** 2)
    parts = np.maximum(fore, 0.0) ** (1.0 / 2.1), np.ones_like(ft), np.sqrt(np.maximum(aft, 0.0))
    at = ft <= 3.333333, ft <= 10.645833, ft <= SUBOFF_CAP_FT
    return 5.0 / 6.0 * FOOT_M * np.select(at, parts, np.sqrt(np.maximum(cap, 0.0)))


@dataclass(frozen=True)
class RankineOvoid:
    """A source and a sink of equal strength m at a distance 2 a in a stream of speed 1; closed where m/r sums to it.

    Attributes:
        a: half the distance.
        m: strength over 4 pi.
    """

    a: float
    m: float

    @property
    def half_length(self) -> float:
        """Where the stream stands still on the axis: 4 m a x = (x^2 - a^2)^2."""
        return float(brentq(lambda x: (x * x - self.a**2) ** 2 - 4.0 * self.m * self.a * x, self.a, 10.0 * self.a))

    def radius(self, x: np.ndarray) -> np.ndarray:
        """Of the hull at x from its middle: r^2/2 = m (cos at the source - cos at the sink)."""
        return np.array([self._radius(abs(each)) for each in np.asarray(x).tolist()])

    def _radius(self, x: float) -> float:
        def stream(r: float) -> float:
            """Less what the stream itself does, by r^2, and without the difference of two numbers near 1."""
            source, sink = np.hypot(x + self.a, r), np.hypot(x - self.a, r)
            behind = 1.0 / (source * (source + x + self.a))
            if x < self.a:
                return 0.5 - self.m * ((1.0 - (x - self.a) / sink) / r**2 - behind)
            return 0.5 - self.m * (1.0 / (sink * (sink + x - self.a)) - behind)

        return 0.0 if x >= self.half_length else float(brentq(stream, 1e-9, 10.0 * self.a))

    def mass_ahead(self, volume: float) -> float:
        """Added mass ahead in a fluid of density 1: 4 pi sum of m x, less the volume.

        G. I. Taylor 1928, The energy of a body moving in an infinite fluid, Proc. R. Soc. A 120.
        """
        return 8.0 * np.pi * self.m * self.a - volume


def stations(begin: float, end: float, count: int, also: tuple[float, ...] = ()) -> np.ndarray:
    """Places along a hull, closer towards its ends, and some besides."""
    share = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, count + 1)))
    return np.unique(np.concatenate([begin + (end - begin) * share, also]))


def revolved(x: np.ndarray, radius: Callable[[np.ndarray], np.ndarray], around: int) -> np.ndarray:
    """Triangles (k,3,3) of a hull along x, which comes to a point at both ends; each section has the circle's area."""
    step = 2.0 * np.pi / around
    angles = step * np.arange(around)
    circle = np.stack([np.zeros(around), np.cos(angles), np.sin(angles)], axis=1)
    r = np.sqrt(step / np.sin(step)) * radius(x)
    r[[0, -1]] = 0.0
    rings = [np.array([at, 0.0, 0.0]) + each * circle for at, each in zip(x, r, strict=True)]
    faces = []
    for k, (a, b) in enumerate(pairwise(rings)):
        beside_a, beside_b = np.roll(a, -1, axis=0), np.roll(b, -1, axis=0)
        if k > 0:
            faces.append(np.stack([a, b, beside_a], axis=1))
        if k < len(rings) - 2:
            faces.append(np.stack([b, beside_b, beside_a], axis=1))
    return np.concatenate(faces)


def ring_added_mass(x: np.ndarray, r: np.ndarray, middle: float) -> tuple[float, float, float, float]:
    """Ahead, across, coupling of across and turning, and turning about a diameter at `middle`, in a fluid of density 1.

    Args:
        x: stations (n,) [m], increasing.
        r: radius at each (n,) [m].
        middle: along x [m].
    """
    cones = _Cones.of(x, r)
    surge = cones.n_x
    sway, turn = cones.n_r, (cones.x - middle) * cones.n_r - cones.r * cones.n_x
    ahead = -2.0 * np.pi * np.sum(cones.potential(0, surge) * surge * cones.r * cones.length)
    across, turning = cones.potential(1, sway), cones.potential(1, turn)
    weight = -np.pi * cones.r * cones.length
    return float(ahead), *(float(np.sum(weight * p * v)) for p, v in ((across, sway), (across, turn), (turning, turn)))


@dataclass(frozen=True)
class _Cones:
    """Middles, lengths and outward normals of the cones; where their sources are put (n,k) and with which weights."""

    x: np.ndarray
    r: np.ndarray
    length: np.ndarray
    n_x: np.ndarray
    n_r: np.ndarray
    at_x: np.ndarray
    at_r: np.ndarray
    weight: np.ndarray

    @staticmethod
    def of(x: np.ndarray, r: np.ndarray) -> _Cones:
        dx, dr = np.diff(x), np.diff(r)
        length = np.hypot(dx, dr)
        share, weight = _graded()
        at_x, at_r = x[:-1, None] + dx[:, None] * share, r[:-1, None] + dr[:, None] * share
        half = 0.5 * (x[1:] + x[:-1]), 0.5 * (r[1:] + r[:-1])
        return _Cones(*half, length, -dr / length, dx / length, at_x, at_r, length[:, None] * weight)

    def potential(self, m: int, flow: np.ndarray) -> np.ndarray:
        """At each middle, of the sources that make the flow (n,) through it."""
        potential, through = np.empty((len(self.x),) * 2), np.empty((len(self.x),) * 2)
        for i in range(len(self.x)):
            phi, ahead, outward = _rings(m, self.x[i], self.r[i], self.at_x, self.at_r)
            strength = self.at_r * self.weight / (4.0 * np.pi)
            potential[i] = (phi * strength).sum(axis=1)
            through[i] = ((self.n_x[i] * ahead + self.n_r[i] * outward) * strength).sum(axis=1)
        return potential @ np.linalg.solve(through - 0.5 * np.eye(len(self.x)), flow)


def _rings(m: int, x: float, r: float, at_x: np.ndarray, at_r: np.ndarray) -> tuple[np.ndarray, ...]:
    """Integrals over a ring of cos(m theta) by 1/distance to (x, r), and their slopes in x and r there."""
    along = x - at_x
    A, B = r * r + at_r**2 + along**2, 2.0 * r * at_r  # distance^2 = A - B cos(theta)
    near2, far = (r - at_r) ** 2 + along**2, np.sqrt(A + B)
    first, second = ellipkm1(near2 / far**2), ellipe(1.0 - near2 / far**2)
    one = 4.0 * first / far
    cos = (A * one - 4.0 * far * second) / B
    one3 = 4.0 * second / (near2 * far)
    cos3 = (A * one3 - one) / B
    square3 = (A * cos3 - cos) / B
    if m == 0:
        return one, -along * one3, -(r * one3 - at_r * cos3)
    return cos, -along * cos3, -(r * cos3 - at_r * square3)


def _graded() -> tuple[np.ndarray, np.ndarray]:
    """Shares along a cone and their weights: Gauss's points, closer towards its middle, where the own source is."""
    points, weights = np.polynomial.legendre.leggauss(12)
    t, w = 0.5 * (points + 1.0), 0.5 * weights
    away, weight = 0.5 * t**3, 1.5 * t**2 * w
    return np.concatenate([0.5 - away, 0.5 + away]), np.concatenate([weight, weight])
