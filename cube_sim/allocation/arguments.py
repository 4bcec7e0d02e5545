"""Checks of what an allocator is built from, with one clear line per mistake."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import AllocationError


def one_of(name: str, value: str, known: Sequence[str]) -> str:
    """Pass a known name on.

    Raises:
        AllocationError: it is not known; the message lists what is.
    """
    if value not in known:
        raise AllocationError(f"no {name} {value!r}; there are {', '.join(known)}")
    return value


def row(name: str, value: ArrayLike, length: int, *, positive: bool = False) -> NDArray[np.float64]:
    """A checked (length,) vector; a scalar fills it.

    Raises:
        AllocationError: another shape, not numbers, not finite, or not positive where that is asked for.
    """
    try:
        vector = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise AllocationError(f"{name} is not a vector of numbers: {error}") from None
    if vector.ndim == 0:
        vector = np.full(length, vector)
    if vector.shape != (length,):
        raise AllocationError(f"{name} has shape {vector.shape}; it needs ({length},)")
    if not np.all(np.isfinite(vector)) or (positive and not np.all(vector > 0.0)):
        raise AllocationError(
            f"{name} is {vector.tolist()}; every entry must be finite" + (" and > 0" if positive else "")
        )
    return vector


def scalar(name: str, value: float, *, positive: bool = False) -> float:
    """A checked number, >= 0, or > 0 where that is asked for.

    Raises:
        AllocationError: it is not.
    """
    number = float(row(name, value, 1, positive=positive)[0])
    if number < 0.0:
        raise AllocationError(f"{name} is {value}; it must be >= 0")
    return number


def pairs(name: str, value: ArrayLike, motors: int) -> NDArray[np.float64]:
    """A checked (motors, 2) table of one number for reverse and one for forward; one pair fills it.

    Raises:
        AllocationError: another shape, not numbers, or not finite.
    """
    try:
        table = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise AllocationError(f"{name} is not a table of numbers: {error}") from None
    if table.shape == (2,):
        table = np.tile(table, (motors, 1))
    if table.shape != (motors, 2):
        raise AllocationError(f"{name} has shape {table.shape}; it needs ({motors}, 2) or (2,)")
    if not np.all(np.isfinite(table)):
        raise AllocationError(f"{name} must be finite")
    return table
