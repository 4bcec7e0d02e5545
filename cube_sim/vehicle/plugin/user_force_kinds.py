"""What an own force takes beside the motion of its hull, by the names of its parameters."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from cube_sim.errors import ModelError

UserForce = Callable[..., Any]

_SEEN = ["command", "activation"]
_STATE = "state"
_MOTION = 5  # time, position, rotation, velocity, through_water, whatever their names


@dataclass(frozen=True)
class ForceKind:
    """What a force sees and keeps.

    Attributes:
        sees: whether it gets commands and activations.
        states: how many numbers it keeps; 0 for none, and it returns the wrench alone then.
    """

    sees: bool
    states: int

    @property
    def split(self) -> bool:
        """Whether it returns a pair, the wrench and the rates of its state."""
        return self.states > 0


def kind_of(function: UserForce, name: str) -> ForceKind:
    """The kind of a force.

    Args:
        function: as in `cube_sim.vehicle.plugin.user_forces`.
        name: element to name in errors.

    Raises:
        ModelError: its sixth parameter is `command`, but what follows is not as it should be.
    """
    try:
        parameters = list(inspect.signature(getattr(function, "py_func", function)).parameters.values())[_MOTION:]
    except (TypeError, ValueError):  # a callable that tells nothing of its parameters
        return ForceKind(False, 0)
    names = [parameter.name for parameter in parameters]
    if names[:1] != _SEEN[:1]:
        return ForceKind(False, 0)
    if names[:2] != _SEEN or names[2:] not in ([], [_STATE]):
        told = ", ".join(names)
        raise ModelError(name, f"takes {told} after the motion; command, activation, and state=(0.0, ...) are right")
    if not names[2:]:
        return ForceKind(True, 0)
    start = parameters[2].default
    if not isinstance(start, tuple) or not start or any(not isinstance(x, float) or x != 0.0 for x in start):
        raise ModelError(
            name, "has a state without a length; state=(0.0, 0.0) says that it keeps two numbers, which begin at 0"
        )
    return ForceKind(True, len(start))
