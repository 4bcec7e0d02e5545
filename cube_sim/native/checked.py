"""A function of the user's own, compiled like cube_sim's, but for its indices, which are looked at."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cube_sim.native.function import CompiledFunction


def checked(function: Callable[..., Any]) -> CompiledFunction:
    """As `cube_sim.native.compiled.compiled`; an index out of bounds is an IndexError, as in Python."""
    return CompiledFunction(
        function, {"fastmath": False, "error_model": "numpy", "no_cfunc_wrapper": True, "boundscheck": True}
    )
