"""The `control.attitude` block: which attitude the vehicle takes, told apart by `mode`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from cube_sim.scenario.python_block import PythonBlock
from cube_sim.scenario.values import Angles3, Block, Direction, Extent, Place, Vector3, require_direction


class AlongPathBlock(Block):
    """The body x axis follows the path's tangent."""

    mode: Literal["along_path"]


class FixedAttitudeBlock(Block):
    """The vehicle keeps one attitude in the world."""

    mode: Literal["fixed"]
    attitude_deg: Angles3 = Field(description="[roll, pitch, yaw], as in initial.attitude_deg [deg].")


class FreeAttitudeBlock(Block):
    """The vehicle turns to where its thrusters have least to do."""

    mode: Literal["free"]


class LookAtBlock(Block):
    """A body axis points at a fixed point of the world; about it, the vehicle stays level."""

    mode: Literal["look_at"]
    point_m: Place = Field(description="What to look at, world axes [m].")
    axis: Direction = Field(default=(1.0, 0.0, 0.0), description="Which way it looks, body axes, of any length.")
    near_m: Extent = Field(
        default=0.3,
        description="Distance of the point within which its direction counts for less and less [m].",
    )

    @field_validator("axis")
    @classmethod
    def _has_a_direction(cls, axis: Vector3) -> Vector3:
        return require_direction(axis, "an axis to look along")


class PythonAttitudeBlock(PythonBlock):
    """A rule of one's own; see docs/extending.md."""

    mode: Literal["python"]


NamedAttitude = AlongPathBlock | FixedAttitudeBlock | FreeAttitudeBlock | LookAtBlock
AnyAttitude = Annotated[NamedAttitude | PythonAttitudeBlock, Field(discriminator="mode")]
