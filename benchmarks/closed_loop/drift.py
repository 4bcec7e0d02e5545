"""What the thrusters do while a force carries the hull away: they fight it, from the first moment to the last."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from closed_loop.linear_loop import LinearLoop

LONGEST_S = 20.0
"""In which the hull turns back, or stays."""


class Drift(NamedTuple):
    """The answer to a unit force that begins at once and stays, while the hull goes with it.

    Attributes:
        helped: largest force of the thrusters along it, as a share of it; 0 where they never help.
        work: work of the thrusters along the drift [J], per [N^2] of the force: negative.
        carried_m: how far the hull goes with it [m/N].
    """

    helped: float
    work: float
    carried_m: float


def drift(loop: LinearLoop, axis: int) -> Drift:
    """Push the hull along an axis of the body, 0 to 2, until its velocity turns round."""
    at = np.zeros(len(loop.closed))
    helped, work, carried = 0.0, 0.0, 0.0
    for _ in range(round(LONGEST_S / loop.period)):
        force = float(loop.demand[axis] @ at)
        at = loop.closed @ at + loop.drag[:, axis]
        speed = float(at[3 + axis])
        if speed <= 0.0:
            break
        helped = max(helped, force)
        work += loop.period * force * speed
        carried += loop.period * speed
    return Drift(helped, work, carried)
