"""What every block of a scenario file shares: strictness, three-vectors, names."""

from __future__ import annotations

from typing import Annotated, NoReturn

from pydantic import BaseModel, ConfigDict, Field, StringConstraints
from pydantic.types import Strict
from pydantic_core import PydanticCustomError

# A YAML list becomes a tuple; the numbers inside stay strict (no "3" for 3, no true for 1).
Vector3 = Annotated[tuple[float, float, float], Strict(False)]
ZERO: Vector3 = (0.0, 0.0, 0.0)
# Places: beyond 100 km the last digits of a position are no longer fine beside a vehicle.
Coordinate = Annotated[float, Field(ge=-1e5, le=1e5)]
Place = Annotated[tuple[Coordinate, Coordinate, Coordinate], Strict(False)]
# What a path is made of: neither a speck nor a journey.
Extent = Annotated[float, Field(ge=0.01, le=1e6)]

# Every number has bounds, far outside what makes sense and far inside what squares and quotients of it can hold: what
# would overflow after a minute of flight is a mistake with a position instead.
Seconds = Annotated[float, Field(ge=1e-4, le=1e6)]
"""A time that is divided by."""
Rate = Annotated[float, Field(ge=1e-6, le=1e4)]
"""A gain, or how often something comes: one divided by a time, or by a length."""
Speed = Annotated[float, Field(ge=1e-4, le=100)]
"""A speed that is asked for [m/s]."""
Acceleration = Annotated[float, Field(ge=1e-6, le=1e3)]
"""A bound on one [m/s^2]."""
Deviation = Annotated[float, Field(ge=0, le=1e3)]
"""A standard deviation that may be none."""
Noise = Annotated[float, Field(ge=1e-6, le=1e3)]
"""A standard deviation that is divided by."""
Factor = Annotated[float, Field(ge=1e-3, le=1e3)]
"""What something else is multiplied by."""
Angle = Annotated[float, Field(ge=-1e6, le=1e6)]
"""In degrees, however many turns."""
Angles3 = Annotated[tuple[Angle, Angle, Angle], Strict(False)]
Rates3 = Angles3
"""Angular velocity [deg/s]."""
WaterSpeed = Annotated[float, Field(ge=-100, le=100)]
WaterVelocity = Annotated[tuple[WaterSpeed, WaterSpeed, WaterSpeed], Strict(False)]
"""Of a current [m/s]."""
HullSpeed = Annotated[float, Field(ge=-1e5, le=1e5)]
HullVelocity = Annotated[tuple[HullSpeed, HullSpeed, HullSpeed], Strict(False)]
"""Of a vehicle, at the beginning [m/s]."""
Newtons = Annotated[float, Field(ge=-1e6, le=1e6)]
Newtons3 = Annotated[tuple[Newtons, Newtons, Newtons], Strict(False)]
"""A force [N], or a torque [N m]."""
Newtons2 = Annotated[tuple[Newtons, Newtons], Strict(False)]
Volts = Annotated[float, Field(ge=-1e5, le=1e5)]
Volts2 = Annotated[tuple[Volts, Volts], Strict(False)]
Component = Annotated[float, Field(ge=-1e6, le=1e6)]
Direction = Annotated[tuple[Component, Component, Component], Strict(False)]
"""A vector of any length but none, see `require_direction`."""
SHORTEST_DIRECTION = 1e-6
LARGEST_NUMBER = 1e12
Number = Annotated[float, Field(ge=-LARGEST_NUMBER, le=LARGEST_NUMBER)]
Numbers = Annotated[tuple[Number, ...], Strict(False)]

# Names become folder names and test ids, so they hold nothing a shell or a file system would mind.
Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", max_length=100)]
# Titles are shown in one line of a table.
Title = Annotated[str, StringConstraints(pattern=r"^\S(.*\S)?$", max_length=100)]


def _title(block: type) -> str:
    """What an editor shows of a block: its class name without the suffix."""
    return block.__name__.removesuffix("Block")


class Block(BaseModel):
    """A frozen group of keys: unknown keys, wrong types, NaN and infinities are mistakes.

    Every class of this package that is a group of keys is called after it, with the suffix Block; only the whole file
    is a `Scenario`. What a key may hold one of several blocks for is called Any..., as `AnyPath`.
    """

    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        validate_default=True,
        model_title_generator=_title,
    )


def refuse(message: str, *below: str | int, because: tuple[str | int, ...] = ()) -> NoReturn:
    """Report a mistake from inside a validator.

    Args:
        message: what is wrong and what would be right, starting in lower case.
        below: where the mistake sits, relative to the validated value: keys and list indices.
        because: from the top of the file, another value which this one does not fit.
    """
    # The text travels as a value: a template would stumble over braces in it.
    raise PydanticCustomError("refused", "{text}", {"text": message, "below": below, "because": because})


def require_direction(vector: Vector3, what: str) -> Vector3:
    """A vector that points somewhere: whose square is no zero.

    Args:
        vector: in any unit.
        what: it is, for the message.
    """
    if max(map(abs, vector)) < SHORTEST_DIRECTION:
        refuse(f"{what} needs a direction")
    return vector
