"""One way to compile a hot law: numba, cached on disk, with the plain function kept as `.py_func`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba


def compiled(function: Callable[..., Any]) -> Any:
    """Compile `function` at its first call; the uncompiled one stays reachable as `.py_func`, the reference in tests.

    No fast-math: results are the same bits on every run, and equal to the reference's up to rounding.
    """
    return numba.njit(cache=True, fastmath=False, error_model="numpy")(function)
