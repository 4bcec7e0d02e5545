"""The `knowledge` block: what the controller believes of its vehicle."""

from __future__ import annotations

from pydantic import Field

from cube_sim.scenario.file_names import ModelFile
from cube_sim.scenario.values import Block, Factor, WaterVelocity


class KnowledgeBlock(Block):
    """The vehicle the controller reckons with: a model, and factors on what stands in it."""

    model: ModelFile | None = Field(
        default=None,
        description="MJCF file of the vehicle as the controller knows it, with the same thrusters, relative to the"
        " scenario file. Default: the one that flies.",
    )
    mass: Factor = Field(
        default=1.0,
        description="Factor on mass and inertia, and with them on the displaced mass: a vehicle is trimmed whatever it"
        " weighs.",
    )
    added_mass: float = Field(default=1.0, ge=0, le=1e3, description="Factor on the added mass.")
    drag: float = Field(
        default=1.0,
        ge=0,
        le=1e3,
        description="Factor on linear and quadratic damping, and on what the flow lifts of the hull but for its fins.",
    )
    thrust: Factor = Field(
        default=1.0, description="Factor on the actuation matrix: on what a newton of a thruster does."
    )
    fins: Factor = Field(
        default=1.0, description="Factor on the area of the fins: on what an angle of attack makes of the flow."
    )
    current_m_s: WaterVelocity = Field(
        default=(0.0, 0.0, 0.0),
        description="Velocity of the water as the planar law knows it beforehand, world axes [m/s]: its estimate starts"
        " from it, and with control.current_time_s: null it stays.",
    )
