"""A value drawn from a distribution, by a generator of its own."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from cube_sim.scenario.distribution_blocks import (
    AnyDistribution,
    BellBlock,
    ChoiceBlock,
    DirectionBlock,
    GridBlock,
    IntegersBlock,
    LogNormalBlock,
    NormalBlock,
    SobolBlock,
    UniformBlock,
)


def drawn(distribution: AnyDistribution, rng: np.random.Generator) -> Any:
    """A number, a list of them, or whatever stands to choice.

    Args:
        distribution: one whose draws know nothing of each other.
        rng: of this draw alone.

    Raises:
        TypeError: a grid or a Sobol sequence, which are gone through and not drawn from.
    """
    match distribution:
        case UniformBlock():
            return one_or_list(rng.uniform(distribution.low, distribution.high))
        case NormalBlock():
            return one_or_list(_normal(distribution, np.array(distribution.mean), np.array(distribution.std), rng))
        case LogNormalBlock():
            logs = np.log(distribution.median)
            numbers = np.exp(_normal(distribution, logs, np.array(distribution.log_std), rng, logarithms=True))
            return one_or_list(np.clip(numbers, distribution.at_least, distribution.at_most))
        case IntegersBlock():
            return one_or_list(rng.integers(distribution.low, distribution.high, endpoint=True))
        case ChoiceBlock():
            return distribution.values[_chosen(distribution, rng)]
        case DirectionBlock():
            return _direction(distribution, rng)
        case GridBlock() | SobolBlock():
            raise TypeError(f"a {distribution.distribution} is gone through, not drawn from")


def one_or_list(numbers: NDArray[Any]) -> Any:
    """Plain Python: one number, or a list of several."""
    return numbers[0].item() if numbers.size == 1 else numbers.tolist()


def _normal(
    bell: BellBlock,
    mean: NDArray[np.float64],
    std: NDArray[np.float64],
    rng: np.random.Generator,
    *,
    logarithms: bool = False,
) -> NDArray[np.float64]:
    """Normal numbers (n,) within the bounds, by the inverse of the distribution function cut off at them."""
    if bell.at_least is None and bell.at_most is None:
        return mean + std * rng.standard_normal(mean.shape)
    low, high = (_bound(bound, logarithms) for bound in (bell.at_least, bell.at_most))
    with np.errstate(divide="ignore", invalid="ignore"):
        below = np.full(mean.shape, -np.inf) if low is None else (low - mean) / std
        above = np.full(mean.shape, np.inf) if high is None else (high - mean) / std
    u = rng.random(mean.shape)
    # In the upper half there are no digits left between a distribution function and 1: it is turned over.
    turned = below > 0.0
    a, b = np.where(turned, -above, below), np.where(turned, -below, above)
    z = ndtri(ndtr(a) + u * (ndtr(b) - ndtr(a)))
    numbers = np.where(std > 0.0, mean + std * np.where(turned, -z, z), mean)
    return np.clip(numbers, low, high) if low is not None or high is not None else numbers


def _bound(bound: float | None, logarithms: bool) -> float | None:
    if bound is None or not logarithms:
        return bound
    return None if bound <= 0.0 else float(np.log(bound))


def _chosen(choice: ChoiceBlock, rng: np.random.Generator) -> int:
    if choice.weights is None:
        return int(rng.integers(len(choice.values)))
    shares = np.cumsum(choice.weights)
    return int(np.searchsorted(shares, rng.random() * shares[-1], side="right"))


def _direction(direction: DirectionBlock, rng: np.random.Generator) -> list[float]:
    length, angle, up = rng.uniform((direction.low, 0.0, -1.0), (direction.high, 2.0 * np.pi, 1.0)).tolist()
    level = 1.0 if direction.plane == "horizontal" else float(np.sqrt(1.0 - up * up))
    vector = [level * np.cos(angle), level * np.sin(angle), 0.0 if direction.plane == "horizontal" else up]
    return [float(length * part) for part in vector]
