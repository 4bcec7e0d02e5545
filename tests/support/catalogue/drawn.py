"""Layouts drawn at random: a frame of 10 to 300 kg with 3 to 8 thrusters, arranged as people do and not quite."""

from __future__ import annotations

import numpy as np

from support.catalogue.known import AHEAD, LEFT, UP, pair, vectored
from support.catalogue.mjcf import T200_MOST_N, Hull, Layout, Thruster, box_hull

LEAST, MOST = 3, 8


def drawn_layout(seed: int, m: int) -> Layout:
    """One layout of m thrusters; the same seed gives the same.

    - Mass log-uniform in 10 to 300 kg; the box floods, its volume is 2 to 3 times what it displaces.
    - Weight and lift are equal, the centre of buoyancy 1 to 5 cm above the centre of mass.
    - Thrusters of one size, so that the hull's drag ahead holds it at 0.9 to 1.8 m/s under the thrust of two.
    - Every thruster is up to 5 mm and 1 degree off its drawing; half of the layouts have propeller reaction.
    """
    rng = np.random.default_rng((2007, seed, m))
    hull = _hull(rng)
    half = 0.5 * np.asarray(hull.box)
    thrusters = _arranged(rng, half, m)
    reaction = rng.choice([0.0, rng.uniform(0.005, 0.03)])
    thrusters = [_as_built(rng, thruster, reaction * rng.choice([-1.0, 1.0])) for thruster in thrusters]
    top = rng.uniform(0.9, 1.8)
    thrust = 0.5 * (hull.linear_damping[0] * top + hull.quadratic_damping[0] * top**2)
    return Layout(hull, thrusters, max(thrust, 0.2 * T200_MOST_N), lag_s=float(rng.uniform(0.02, 0.15)))


def _hull(rng: np.random.Generator) -> Hull:
    mass = float(np.exp(rng.uniform(np.log(10.0), np.log(300.0))))
    volume = rng.uniform(2.0, 3.0) * mass / 1000.0
    shape = np.array([1.0, rng.uniform(0.5, 0.9), rng.uniform(0.35, 0.7)])
    box = shape * (volume / np.prod(shape)) ** (1.0 / 3.0)
    # Water passes the frame: it holds up less water than a plate, and what it holds is no more than what fills it.
    return box_hull(
        mass,
        box,
        float(rng.uniform(0.01, 0.05)),
        drag_coefficient=float(rng.uniform(0.7, 1.1)),
        linear_at_m_s=float(rng.uniform(0.05, 0.2)),
        added_share=float(rng.uniform(0.5, 0.9)),
    )


def _arranged(rng: np.random.Generator, half: np.ndarray, m: int) -> list[Thruster]:
    """One of the usual arrangements of m thrusters in the box of these half edges, or for six and more any."""
    x, y, z = (float(rng.uniform(0.6, 0.95)) * half[i] for i in range(3))
    height = float(rng.uniform(-0.3, 0.3)) * half[2]
    angle = float(rng.uniform(30.0, 60.0))
    astern, one_up, aside = pair(-x, y, height, AHEAD), Thruster((0, 0, z), UP), Thruster((0, 0, height), LEFT)
    abeam, in_line = pair(0, y, z, UP), [Thruster((x, 0, z), UP), Thruster((-x, 0, z), UP)]
    four, corners = vectored(x, y, height, angle), [*pair(x, y, z, UP), *pair(-x, y, z, UP)]
    usual = {
        3: [[*astern, one_up]],
        4: [[*astern, *abeam], [*astern, *in_line], [*astern, aside, one_up]],
        5: [[*four, one_up], [*astern, *abeam, aside], [*astern, *in_line, aside]],
        6: [[*four, *abeam], [*four, *in_line], [*astern, *corners]],
        7: [[*four, *abeam, Thruster((x, 0, z), UP)], [*astern, *corners, aside]],
        8: [[*four, *corners]],
    }[m]
    if m >= 6:
        usual.append(_anyhow(rng, half, m))
    return usual[int(rng.integers(len(usual)))]


def _anyhow(rng: np.random.Generator, half: np.ndarray, m: int) -> list[Thruster]:
    """Places and axes drawn, of many the draw whose costliest direction is cheapest."""
    best, best_gain = [], -1.0
    for _ in range(50):
        places = rng.uniform(-0.9, 0.9, (m, 3)) * half
        axes = rng.normal(size=(m, 3))
        axes /= np.linalg.norm(axes, axis=1)[:, None]
        A = np.vstack([axes.T, np.cross(places, axes).T / np.mean(half)])
        gain = float(np.linalg.svd(A, compute_uv=False)[-1])
        if gain > best_gain:
            best, best_gain = [Thruster(p, u) for p, u in zip(places, axes, strict=True)], gain
    return best


def _as_built(rng: np.random.Generator, thruster: Thruster, reaction_m: float) -> Thruster:
    place = np.asarray(thruster.position, float) + rng.uniform(-0.005, 0.005, 3)
    axis = np.asarray(thruster.axis, float)
    axis = axis / np.linalg.norm(axis) + np.radians(1.0) * rng.uniform(-1.0, 1.0, 3)
    return Thruster(tuple(place), tuple(axis), reaction_m, thruster.share)
