"""The `path` block: which curve the vehicle follows, told apart by `type`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator
from pydantic_core.core_schema import ValidationInfo

from .values import Block, Vector3, refuse


class Line(Block):
    """A straight segment."""

    type: Literal["line"]
    start_m: Vector3 = Field(description="First point, world axes [m].")
    end_m: Vector3 = Field(description="Last point, world axes [m]; differs from start_m.")

    @field_validator("end_m")
    @classmethod
    def _has_length(cls, end_m: Vector3, info: ValidationInfo) -> Vector3:
        if end_m == info.data.get("start_m"):
            refuse(f"a line needs two different points, start_m and end_m are both {list(end_m)}")
        return end_m


class Helix(Block):
    """A circular helix about a vertical axis; with pitch_m 0 it is a horizontal circle."""

    type: Literal["helix"]
    centre_m: Vector3 = Field(
        description="Centre of the circle on which the helix starts: a point of the axis, world axes [m]."
    )
    radius_m: float = Field(gt=0, description="Distance of the path from its axis [m].")
    pitch_m: float = Field(description="Rise along world z in one turn [m]; negative descends.")
    turns: float = Field(gt=0, description="Number of turns; fractions are welcome.")
    start_angle_deg: float = Field(
        default=0.0, description="Where on the circle the path starts, from world x towards world y [deg]."
    )
    direction: Literal["left", "right"] = Field(
        default="left", description="Seen from above: left turns counter-clockwise, right clockwise."
    )


Path = Annotated[Line | Helix, Field(discriminator="type")]
