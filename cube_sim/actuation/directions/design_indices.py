"""Figures of merit of a thruster layout, for comparing designs.

The families are those of the literature on configuration matrices (H. T. Dang, L. Lapierre, R. Zapata, B. Ropars,
Over-Actuated Underwater Robots: Configuration Matrix Design and Perspectives, Sensors 21(22):7729, 2021:
manipulability, energy, reactivity, robustness). The formulas are given here, in full, on W A, torques divided by a
length: another length ranks layouts differently, so it belongs to the figures.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, islice

import numpy as np

from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.actuation.directions.threshold import Threshold
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.axes import Matrix, Vector
from cube_sim.wrench.zonotope import inscribed_radius, volume

_AT_ONCE = 10_000


@dataclass(frozen=True)
class Indices:
    """One layout's figures.

    Attributes:
        manipulability: sqrt det (W A)(W A)^T, the product of the singular values: volume of wrenches per volume of
            thruster forces (T. Yoshikawa, Manipulability of Robotic Mechanisms, 1985); 0 when a component is lost.
        isotropy: smallest over largest singular value, 1 when every direction is equally easy.
        energy: mean of |F_m|^2 over all wrenches with |W F_B| = 1, which is |(W A)^+|_F^2 / n [N^2/N^2]. Less is
            better; infinite when a component is lost. It is a sum of squares, not electrical power.
        worst_energy: the same for the most costly wrench, 1 / sigma_min^2.
        reactivity: largest change [N] of any one thruster for a change of one newton of the wrench in its worst
            direction: the largest row norm of (W A)^+. Times the wrench rate it is the force rate the thrusters
            need. Less is better; infinite when a component is lost.
        robustness: sigma_min after the worst single loss over sigma_min with all thrusters. It is 0 when a loss costs
            a direction, and when one is missing already.
        tolerated_losses: how many thrusters may fail, whichever they are, with all n components kept.
        weakest: largest r such that every wrench with |W F_B| <= r [N] is attainable, dead zones left out; None
            without limits.
        volume: of the attainable wrenches W F_B [N^n], dead zones left out; None without limits.
    """

    manipulability: float
    isotropy: float
    energy: float
    worst_energy: float
    reactivity: float
    robustness: float
    tolerated_losses: int
    weakest: float | None
    volume: float | None


def indices(actuation: Subspaces, allowed: AllowedForces | None = None) -> Indices:
    """Compute the figures.

    Args:
        actuation: the layout.
        allowed: its thrusters' forces.
    """
    n, m = actuation.matrix.shape
    scaled = actuation.axes.scale(actuation.length_m)[:, None] * actuation.matrix
    sigma = _singular_values(scaled)
    complete = actuation.rank == n
    energy = worst = reactivity = float("inf")
    robustness = 0.0
    if complete:
        inverse = np.linalg.pinv(scaled)
        energy, worst = float(np.mean(1.0 / sigma**2)), float(1.0 / sigma[-1] ** 2)
        reactivity = float(np.max(np.linalg.norm(inverse, axis=1)))
        left = _singular_values(np.stack([np.delete(scaled, i, axis=1) for i in range(m)]))
        robustness = float(np.min(np.where(actuation.threshold.all_count(left), left[:, -1] / sigma[-1], 0.0)))
    weakest = volume_ = None
    if allowed is not None:
        low, high = allowed.minimum, allowed.maximum
        weakest = inscribed_radius(scaled, low, high) if complete else 0.0
        volume_ = volume(scaled, low, high) if complete else 0.0
    return Indices(
        manipulability=float(np.prod(sigma)) if complete else 0.0,
        isotropy=float(sigma[-1] / sigma[0]) if complete else 0.0,
        energy=energy,
        worst_energy=worst,
        reactivity=reactivity,
        robustness=robustness,
        tolerated_losses=_tolerated_losses(scaled, actuation.threshold) if complete else 0,
        weakest=weakest,
        volume=volume_,
    )


def _tolerated_losses(scaled: Matrix, threshold: Threshold) -> int:
    n, m = scaled.shape
    for lost in range(1, m - n + 1):
        choices = combinations(range(m), m - lost)
        while len(left := np.array(list(islice(choices, _AT_ONCE)))):
            if not np.all(threshold.all_count(_singular_values(np.transpose(scaled[:, left], (1, 0, 2))))):
                return lost - 1
    return m - n


def _singular_values(scaled: Matrix) -> Vector:
    """(.., n) singular values of matrices (.., n, m), zeros included when there are fewer columns than rows."""
    n, m = scaled.shape[-2:]
    sigma = np.linalg.svd(scaled, compute_uv=False)
    return np.concatenate([sigma, np.zeros((*sigma.shape[:-1], max(0, n - m)))], axis=-1).astype(np.float64)
