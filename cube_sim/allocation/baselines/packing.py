"""A baseline and what it remembers in one array, as the loop of a flight hands it on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

HEADER = 8
PSEUDO_INVERSE, CLIPPED, CONTRACTION, COMPENSATION = range(4)
"""Which rule answers."""


def pack_baseline(
    rule: int,
    A: NDArray[np.float64],
    inverse: NDArray[np.float64],
    limits: NDArray[np.float64],
    regime: NDArray[np.float64],
    numbers: tuple[bool, int, float, float, float],
) -> NDArray[np.float64]:
    """Everything in the order of `unpack_baseline`; the last number is the direction of the regime, 1 at first.

    Args:
        rule: which.
        A: (n, m).
        inverse: A^+ (m, n).
        limits: (m, 4) [N].
        regime: (m,) [N].
        numbers: whether thrusters may rest; how many components are forces; the lever arm [m]; forces that count as
            none and as none asked for [N].
    """
    header = np.array([rule, *A.shape, *numbers], np.float64)
    return np.concatenate([header, A.ravel(), inverse.ravel(), limits.ravel(), regime, np.ones(1)])


def unpack_baseline(packed):
    """A (n, m), A^+ (m, n), limits (m, 4), regime (m,) and direction (1,), as views."""
    n, m = int(packed[1]), int(packed[2])
    a = HEADER + n * m
    b, c = a + m * n, a + m * n + 4 * m
    return (
        packed[HEADER:a].reshape(n, m),
        packed[a:b].reshape(m, n),
        packed[b:c].reshape(m, 4),
        packed[c : c + m],
        packed[c + m : c + m + 1],
    )
