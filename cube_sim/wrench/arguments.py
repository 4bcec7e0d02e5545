"""Checks of what an allocator or an analysis is built from, with one clear line per mistake."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import WrenchError
from cube_sim.wrench.tolerances import LARGEST


def numbers(name: str, value: ArrayLike, kind: str, order: Literal["C", "K"] = "C") -> NDArray[np.float64]:
    """A new array of real numbers, of any shape.

    Args:
        name: what the message calls it.
        value: the numbers.
        kind: what it should have been: a vector, a table.
        order: how it lies in memory: row by row, or as the value does.

    Raises:
        WrenchError: it holds something else, rows of different lengths, or a number beyond double precision.
    """
    try:
        if np.iscomplexobj(value):
            raise TypeError("its entries must be real")
        return np.array(value, dtype=np.float64, order=order)
    except (TypeError, ValueError, OverflowError) as error:
        raise WrenchError(f"{name} is not a {kind} of numbers: {error}") from None


def bounded(name: str, values: NDArray[np.float64]) -> None:
    """Refuse finite numbers of absurd size.

    Raises:
        WrenchError: one is.
    """
    size = float(np.max(np.abs(values), initial=0.0))
    if LARGEST < size < np.inf:
        raise WrenchError(f"{name} holds {size:g}; numbers beyond {LARGEST:g} leave double precision")


def flag(name: str, value: bool) -> bool:
    """A checked yes or no.

    Raises:
        WrenchError: it is neither True nor False.
    """
    if not isinstance(value, bool | np.bool_):
        raise WrenchError(f"{name} is {value!r}; it must be True or False")
    return bool(value)


def comparable(name: str, weights: NDArray[np.float64], most: float) -> None:
    """Refuse positive weights that double precision cannot hold beside each other, or beside penalties and roundings.

    Raises:
        WrenchError: one is not within ``1 / most`` to ``most``, or two are in a larger ratio than that.
    """
    least, largest = float(np.min(weights)), float(np.max(weights))
    if largest > most * min(least, 1.0) or least < 1.0 / most:
        raise WrenchError(
            f"{name} spans {least:g} to {largest:g}; give weights within {1.0 / most:g} to {most:g}, "
            f"in a ratio of {most:g} at most"
        )


def one_of(name: str, value: str, known: Sequence[str]) -> str:
    """Pass a known name on.

    Raises:
        WrenchError: it is not known; the message lists what is.
    """
    if not isinstance(value, str) or value not in known:
        raise WrenchError(f"no {name} {value!r}; there are {', '.join(known)}")
    return value


def row(name: str, value: ArrayLike, length: int, *, positive: bool = False) -> NDArray[np.float64]:
    """A checked (length,) vector; a scalar fills it.

    Raises:
        WrenchError: another shape, not numbers, not finite, or not positive where that is asked for.
    """
    vector = numbers(name, value, "vector")
    if vector.ndim == 0:
        vector = np.full(length, vector)
    if vector.shape != (length,):
        raise WrenchError(f"{name} has shape {vector.shape}; it needs ({length},)")
    if not np.all(np.isfinite(vector)) or (positive and not np.all(vector > 0.0)):
        raise WrenchError(f"{name} is {vector.tolist()}; every entry must be finite" + (" and > 0" if positive else ""))
    bounded(name, vector)
    return vector


def scalar(name: str, value: float, *, positive: bool = False) -> float:
    """A checked number, >= 0, or > 0 where that is asked for.

    Raises:
        WrenchError: it is not.
    """
    number = float(row(name, value, 1, positive=positive)[0])
    if number < 0.0:
        raise WrenchError(f"{name} is {value}; it must be >= 0")
    return number


def pairs(name: str, value: ArrayLike, m: int) -> NDArray[np.float64]:
    """A checked (m, 2) table of one number for reverse and one for forward; one pair fills it.

    Raises:
        WrenchError: another shape, not numbers, or not finite.
    """
    table = numbers(name, value, "table")
    if table.shape == (2,):
        table = np.tile(table, (m, 1))
    if table.shape != (m, 2):
        raise WrenchError(f"{name} has shape {table.shape}; it needs ({m}, 2) or (2,)")
    if not np.all(np.isfinite(table)):
        raise WrenchError(f"{name} must be finite")
    bounded(name, table)
    return table
