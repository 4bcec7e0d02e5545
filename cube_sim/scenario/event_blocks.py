"""The `events` list: what happens to the vehicle and the water during a run, told apart by `kind`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic.types import Strict

from cube_sim.scenario.values import Block, Vector3, refuse

ThrusterState = Literal["dead", "weak", "stuck", "recovered"]


class ThrusterEventBlock(Block):
    """Thrusters fail, or come back."""

    kind: Literal["thrusters"]
    at_s: float = Field(ge=0, description="When it happens [s].")
    thrusters: Annotated[tuple[str, ...], Strict(False)] = Field(
        description="Names of the thrusters, for example [T1, T4].", json_schema_extra={"minItems": 1}
    )
    state: ThrusterState = Field(
        description="dead: no force; weak: a share of it; stuck: one force whatever is commanded; recovered: whole."
    )
    efficiency: float | None = Field(default=None, gt=0, lt=1, description="Share of its force a weak thruster gives.")
    force_N: float | None = Field(  # noqa: N815 - N is the newton
        default=None, description="Force a stuck thruster holds [N]."
    )

    @model_validator(mode="after")
    def _what_the_state_needs(self) -> ThrusterEventBlock:
        if not self.thrusters:
            refuse("name at least one thruster", "thrusters")
        for key, state in (("efficiency", "weak"), ("force_N", "stuck")):
            given = getattr(self, key) is not None
            if given != (self.state == state):
                refuse(f"{key} and state {state} go together: give both or neither", "state")
        return self

    @property
    def title(self) -> str:
        """What happens, for readers."""
        how = "" if self.efficiency is None else f", {100 * self.efficiency:g} % of its force"
        how += "" if self.force_N is None else f", {self.force_N:g} N"
        return self.message + how

    @property
    def message(self) -> str:
        """What the log of a flight says of it."""
        return f"{', '.join(self.thrusters)}: {self.state}"


class CurrentEventBlock(Block):
    """The current changes."""

    kind: Literal["current"]
    at_s: float = Field(ge=0, description="When it happens [s].")
    current_m_s: Vector3 = Field(description="Velocity of the water from then on, world axes [m/s].")

    @property
    def title(self) -> str:
        """What happens, for readers."""
        x, y, z = self.current_m_s
        return f"current becomes [{x:g}, {y:g}, {z:g}] m/s"

    @property
    def message(self) -> str:
        """What the log of a flight says of it."""
        return f"the current is now {list(self.current_m_s)} m/s"


AnyEvent = Annotated[ThrusterEventBlock | CurrentEventBlock, Field(discriminator="kind")]
