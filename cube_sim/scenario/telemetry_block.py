"""The `telemetry` block: what the motors report of the thrusters' forces."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, field_validator
from pydantic.types import Strict
from pydantic_core.core_schema import ValidationInfo

from cube_sim.scenario.values import Block, refuse

Gain = Annotated[float, Field(gt=0, le=10)]


class TelemetryBlock(Block):
    """What the fault diagnosis sees of the thrusters' forces, and how far it trusts that. Default: exact forces."""

    gain_tolerance: float = Field(
        default=0.1,
        ge=0,
        le=0.5,
        description="How far from 1 the diagnosis reckons a gain may be; it learns them while thrusters are whole.",
    )
    gain: Gain = Field(default=1.0, description="What every thruster's reading is per newton it gives.")
    thruster_gains: Annotated[tuple[Gain, ...], Strict(False)] | None = Field(
        default=None, description="The same for each thruster, in the model's order, in place of `gain`."
    )
    noise_N: float = Field(  # noqa: N815 - N is the newton
        default=0.0,
        ge=0,
        le=1e6,
        description="Standard deviation of a reading, one per control period [N]; the diagnosis knows it.",
    )

    @field_validator("thruster_gains")
    @classmethod
    def _in_place_of_one(cls, gains: tuple[float, ...] | None, info: ValidationInfo) -> object:
        if gains is not None and info.data.get("gain", 1.0) != 1.0:
            refuse("stands in place of gain: leave one of the two out")
        return gains
