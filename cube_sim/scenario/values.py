"""What every block of a scenario file shares: strictness, three-vectors, names."""

from __future__ import annotations

from typing import Annotated, NoReturn

from pydantic import BaseModel, ConfigDict, Field, StringConstraints
from pydantic.types import Strict
from pydantic_core import PydanticCustomError

# A YAML list becomes a tuple; the numbers inside stay strict (no "3" for 3, no true for 1).
Vector3 = Annotated[tuple[float, float, float], Strict(False)]
# Places: beyond 100 km the last digits of a position are no longer fine beside a vehicle.
Coordinate = Annotated[float, Field(ge=-1e5, le=1e5)]
Place = Annotated[tuple[Coordinate, Coordinate, Coordinate], Strict(False)]
# What a path is made of: neither a speck nor a journey.
Extent = Annotated[float, Field(ge=0.01, le=1e6)]
Pair = Annotated[tuple[float, float], Strict(False)]
Numbers = Annotated[tuple[float, ...], Strict(False)]

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
