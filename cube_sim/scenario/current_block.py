"""`current_profile`: water whose velocity changes with depth."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

from pydantic import Field, model_validator
from pydantic.types import Strict

from cube_sim.scenario.values import Block, Coordinate, WaterVelocity, refuse

MOST_DEPTHS = 100


class CurrentProfileBlock(Block):
    """The current by depth: linear between the depths given, and beyond them as at the nearest."""

    depths_m: Annotated[tuple[Coordinate, ...], Strict(False)] = Field(
        description="Depths below z = 0, increasing [m].", json_schema_extra={"minItems": 1}, max_length=MOST_DEPTHS
    )
    velocities_m_s: Annotated[tuple[WaterVelocity, ...], Strict(False)] = Field(
        description="Velocity of the water at each of them, world axes [m/s].", json_schema_extra={"minItems": 1}
    )

    @model_validator(mode="after")
    def _one_velocity_for_each_depth(self) -> CurrentProfileBlock:
        depths, velocities = self.depths_m, self.velocities_m_s
        if not depths:
            refuse("name at least one depth", "depths_m")
        for i, (above, below) in enumerate(pairwise(depths), 1):
            if not above < below:
                refuse(f"depths must increase: {below:g} m comes after {above:g} m", "depths_m", i)
        if len(depths) != len(velocities):
            refuse(f"{len(velocities)} velocities for {len(depths)} depths", "velocities_m_s")
        return self
