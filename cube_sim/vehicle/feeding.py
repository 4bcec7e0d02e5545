"""Motions into which the numbers of a hull's water would feed energy, which water at rest never does."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.lift import HullLift

SAMPLES, STEPS = 512, 30
"""Motions that are looked at, and how often the worst of them are moved on from there (choices)."""
KEPT = 12
"""How many of the worst (a choice)."""
AHEAD = 0.27
"""Flow across and turning, of the speed ahead, up to which derivatives of hulls that fly ahead are held to: 15 deg and
0.3 rad/s at 1 m/s (a choice)."""
_ROUNDING = 1e-9

Vector = NDArray[np.float64]


class _Lift(NamedTuple):
    products: Vector
    absolute: Vector
    fins: Vector


def feeding_words(linear: Vector, quadratic: Vector, lift: HullLift | None) -> str:
    """Words for numbers that feed energy into some motion; "" where none is found.

    A search, not a proof: pairs of axes are decided when a model is loaded, three and more are looked for here. Without
    velocity products any direction of motion counts, fast enough that quadratic damping is all. With them, which are of
    hulls that fly ahead, motions ahead at 1 m/s do, linear damping counted.

    Args:
        linear: D (6,6) [N s/m, ...].
        quadratic: D_q (6,6) [N s^2/m^2, ...].
        lift: of the hull; None for none.
    """
    tables = (None, None, None) if lift is None else (lift.products, lift.absolute, lift.fins)
    of_lift = [None if each is None else np.ascontiguousarray(each).tobytes() for each in tables]
    return _words(np.ascontiguousarray(linear).tobytes(), np.ascontiguousarray(quadratic).tobytes(), *of_lift)


@lru_cache(maxsize=64)  # asked before each of many flights
def _words(
    linear_bytes: bytes, quadratic_bytes: bytes, products: bytes | None, absolute: bytes | None, fins: bytes | None
) -> str:
    linear, quadratic = (np.frombuffer(each).reshape(6, 6) for each in (linear_bytes, quadratic_bytes))
    lift = None
    if products is not None and absolute is not None and fins is not None:
        lift = _Lift(*(np.frombuffer(each).reshape(6, 6, 6) for each in (products, absolute, fins)))
    if lift is None and not np.any(quadratic - np.diag(np.diag(quadratic))):
        return ""
    if lift is not None and not lift.products.any() and not lift.absolute.any():
        return ""
    diagonal = np.diag(quadratic)
    scale = np.where(diagonal > 0.0, np.maximum(diagonal, 1e-12) ** (-1.0 / 3.0), 1.0)

    def motions(given: Vector) -> Vector:
        """Of directions (n,6): in units in which the axes are damped alike, or ahead."""
        if lift is None:
            return given / np.linalg.norm(given, axis=1, keepdims=True) * scale
        across = np.clip(given, -AHEAD, AHEAD)
        across[:, 0] = 1.0
        return across

    def fed(given: Vector) -> tuple[Vector, Vector]:
        """Power into motions (n,) [W], and the power that passes between the axes (n,) [W], for its size."""
        nu = motions(given)
        size = np.abs(nu)
        forces = -(size * nu) @ quadratic.T
        if lift is not None:
            forces -= nu @ linear.T
            forces += np.einsum("ijk,nj,nk->ni", lift.products, nu, nu)
            forces += np.einsum("ijk,nj,nk->ni", lift.absolute + lift.fins, nu, size)
        each = nu * forces
        return each.sum(axis=1), np.abs(each).sum(axis=1)

    rng = np.random.default_rng(0)
    given = rng.normal(size=(SAMPLES, 6)) * (1.0 if lift is None else AHEAD)
    power, _ = fed(given)
    worst = given[np.argsort(-power)[:KEPT]]
    for step in np.geomspace(0.3, 1e-3, STEPS):
        other = worst + step * rng.normal(size=worst.shape) * (1.0 if lift is None else AHEAD)
        better = fed(other)[0] > fed(worst)[0]
        worst[better] = other[better]
    power, passing = fed(worst)
    k = int(np.argmax(power))
    if power[k] <= _ROUNDING * passing[k]:
        return ""
    nu = motions(worst)[k]
    nu = nu if lift is not None else nu / np.linalg.norm(nu)
    what = "quadratic_damping feeds" if lift is None else "velocity_products and damping feed"
    watts = power[k] * (1.0 if lift is not None else 1.0 / float(np.linalg.norm(motions(worst)[k])) ** 3)
    moving = " ".join(f"{each:.2g}" for each in nu)
    return (
        f"its {what} energy into some motions: {watts:.2g} W at the velocity {moving} m/s and rad/s (u v w p q r), "
        "where water at rest only takes it; look at the signs off the diagonal"
    )
