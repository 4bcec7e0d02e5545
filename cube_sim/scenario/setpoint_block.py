"""`setpoints`: what an actuator is told that is neither a thruster nor the servo of a fin."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic.types import Strict

from cube_sim.nearest import counted
from cube_sim.scenario.values import Block, Number, refuse

MOST_POINTS = 10_000
Time = Annotated[float, Field(ge=0, le=86400)]


class SetpointsBlock(Block):
    """The commands of one actuator over time; before the first time and after the last those given there."""

    times_s: Annotated[tuple[Time, ...], Strict(False)] = Field(
        description="Times, increasing [s].", json_schema_extra={"minItems": 1}, max_length=MOST_POINTS
    )
    values: Annotated[tuple[Number, ...], Strict(False)] = Field(
        description="Command at each of them, in the actuator's own unit: rad or m for a position servo of a joint, m^3"
        " for ballast.",
        json_schema_extra={"minItems": 1},
    )
    between: Literal["linear", "held"] = Field(
        default="linear", description="From one value to the next: evenly, or at once when its time has come."
    )

    @model_validator(mode="after")
    def _one_value_for_each_time(self) -> SetpointsBlock:
        times, values = self.times_s, self.values
        if not times:
            refuse("name at least one time", "times_s")
        for i, (before, after) in enumerate(pairwise(times), 1):
            if not before < after:
                refuse(f"times must increase: {after:g} s comes after {before:g} s", "times_s", i)
        if len(times) != len(values):
            refuse(f"{counted(len(values), 'value')} for {counted(len(times), 'time')}", "values")
        return self
