"""The `knowledge` block: what the controller believes of its vehicle."""

from __future__ import annotations

from pydantic import Field, field_validator
from pydantic_core.core_schema import ValidationInfo

from cube_sim.scenario.values import Block, existing_model


class Knowledge(Block):
    """The vehicle the controller reckons with: a model, and factors on what stands in it."""

    model: str | None = Field(
        default=None,
        min_length=1,
        description="MJCF file of the vehicle as the controller knows it, with the same thrusters, relative to the"
        " scenario file. Default: the one that flies.",
    )
    mass: float = Field(
        default=1.0,
        gt=0,
        description="Factor on mass and inertia, and with them on the displaced mass: a vehicle is trimmed whatever it"
        " weighs.",
    )
    added_mass: float = Field(default=1.0, ge=0, description="Factor on the added mass.")
    drag: float = Field(default=1.0, ge=0, description="Factor on linear and quadratic damping.")
    thrust: float = Field(
        default=1.0, gt=0, description="Factor on the actuation matrix: on what a newton of a motor does."
    )

    @field_validator("model")
    @classmethod
    def _existing_file(cls, model: str | None, info: ValidationInfo) -> str | None:
        return None if model is None else existing_model(model, info)
