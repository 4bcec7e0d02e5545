"""Numbers of a named length out of the custom numerics of a model."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import counted

Numerics = Mapping[str, NDArray[np.float64]]


def scalar(numerics: Numerics, name: str) -> float:
    """The one number of that name; 0 where there is none.

    Raises:
        ModelError: it is not one finite number.
    """
    return float(vector(numerics, name, 1)[0])


def vector(numerics: Numerics, name: str, size: int) -> NDArray[np.float64]:
    """(size,) the numbers of that name; zeros where there are none.

    Raises:
        ModelError: there are not as many, or one is not finite.
    """
    values = numerics.get(name, np.zeros(size))
    if values.size != size:
        raise ModelError(name, f"has {counted(values.size, 'value')}; it takes {size}")
    if not np.all(np.isfinite(values)):
        raise ModelError(name, "holds a value that is not finite")
    return values.copy()


def rows(numerics: Numerics, name: str, width: int, meaning: str) -> NDArray[np.float64]:
    """(n, width) the numbers of that name; no rows where there are none.

    Args:
        numerics: name -> values (n,).
        name: of the numeric.
        width: of a row.
        meaning: what stands in a row, for the error.

    Raises:
        ModelError: they make no whole rows, or one is not finite.
    """
    values = numerics.get(name, np.zeros(0))
    if values.size % width:
        raise ModelError(name, f"has {counted(values.size, 'value')}; it takes rows of {width}: {meaning}")
    if not np.all(np.isfinite(values)):
        raise ModelError(name, "holds a value that is not finite")
    return values.reshape(-1, width).copy()


def either(numerics: Numerics, owner: str, body: str, parameter: str) -> str | None:
    """The owner's own numeric, or its hull's, or None."""
    return next((name for each in (owner, body) if (name := f"{each}:{parameter}") in numerics), None)
