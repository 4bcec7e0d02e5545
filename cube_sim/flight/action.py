"""What one who steps a flight may say in place of its own loop."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import FlightError
from cube_sim.spatial import LARGEST, Vector, real_numbers


class Action(NamedTuple):
    """One of the three, or none for the loop's own answer.

    Attributes:
        wrench: (6,) [N, N m], body axes, to be allocated.
        forces: (m,) [N] to ask of the thrusters; the characteristics say what comes of it.
        commands: (m,) normalised commands.
    """

    wrench: Vector | None = None
    forces: Vector | None = None
    commands: Vector | None = None


OWN = Action()
"""The loop's own answer."""


def action_of(thrusters: int, wrench: ArrayLike | None, forces: ArrayLike | None, commands: ArrayLike | None) -> Action:
    """The checked action.

    Raises:
        FlightError: more than one is given, or one of another shape, or one that is not finite.
    """
    given = [name for name, value in zip(Action._fields, (wrench, forces, commands), strict=True) if value is not None]
    if len(given) > 1:
        raise FlightError(f"give one of wrench, forces and commands, not {' and '.join(given)}")
    return Action(
        _numbers("wrench", wrench, 6), _numbers("forces", forces, thrusters), _numbers("commands", commands, thrusters)
    )


def _numbers(name: str, value: ArrayLike | None, count: int) -> Vector | None:
    if value is None:
        return None
    numbers = real_numbers(value)
    if numbers is None:
        raise FlightError(f"{name} takes {count} numbers, not {value!r}")
    if numbers.shape != (count,):
        raise FlightError(f"{name} has shape {numbers.shape}; it takes {count} numbers")
    if not np.isfinite(numbers).all():
        raise FlightError(f"{name} is {numbers.tolist()}; every number must be finite")
    if np.abs(numbers).max() > LARGEST:
        raise FlightError(f"{name} is {numbers.tolist()}; no number may be larger than {LARGEST:g}")
    return numbers
