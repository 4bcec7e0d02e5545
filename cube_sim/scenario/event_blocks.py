"""The `events` list: what happens to the vehicle and the water during a run, told apart by `kind`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic.types import Strict

from cube_sim.scenario.current_block import CurrentProfileBlock
from cube_sim.scenario.values import Block, Title, Vector3, refuse

ThrusterState = Literal["dead", "weak", "stuck", "recovered"]


class EventBlock(Block):
    """What every event has; each also has a `what`: what happens, in words."""

    name: Title | None = Field(default=None, description="Shown where the event is told. Default: what happens.")
    at_s: float = Field(ge=0, description="When it happens [s].")

    @property
    def what(self) -> str:
        """What happens, for readers."""
        raise NotImplementedError

    @property
    def title(self) -> str:
        """What happens, for readers, after the name that the scenario gives it."""
        return self.what if self.name is None else f"{self.name}: {self.what}"

    @property
    def message(self) -> str:
        """What the log of a flight says of it."""
        return self.title


class ThrusterEventBlock(EventBlock):
    """Thrusters fail, or come back."""

    kind: Literal["thrusters"]
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
    def what(self) -> str:
        """See `EventBlock.what`."""
        how = "" if self.efficiency is None else f", {100 * self.efficiency:g} % of its force"
        how += "" if self.force_N is None else f", {self.force_N:g} N"
        return f"{', '.join(self.thrusters)}: {self.state}{how}"

    @property
    def message(self) -> str:
        """See `EventBlock.message`."""
        return self.title if self.name is not None else f"{', '.join(self.thrusters)}: {self.state}"


class CurrentEventBlock(EventBlock):
    """The current changes, at once or within a time; what it was before does not count any more then."""

    kind: Literal["current"]
    current_m_s: Vector3 | None = Field(
        default=None, description="Velocity of the water from then on, world axes [m/s]. This or `profile`."
    )
    profile: CurrentProfileBlock | None = Field(
        default=None, description="The same by depth. A block, see `current_profile`."
    )
    over_s: float = Field(
        default=0.0,
        ge=0,
        le=86400,
        description="Time in which it changes evenly from what it was [s]. Water that changes its velocity so pushes"
        " the hull by its acceleration, too. 0: at once, without a push.",
    )

    @model_validator(mode="after")
    def _one_current(self) -> CurrentEventBlock:
        if (self.current_m_s is None) == (self.profile is None):
            refuse("give either current_m_s or profile", "current_m_s")
        return self

    @property
    def _becomes(self) -> str:
        if self.current_m_s is None:
            return "a profile"
        x, y, z = self.current_m_s
        return f"[{x:g}, {y:g}, {z:g}] m/s"

    @property
    def what(self) -> str:
        """See `EventBlock.what`."""
        return f"current becomes {self._becomes}" + (f" within {self.over_s:g} s" if self.over_s else "")

    @property
    def message(self) -> str:
        """See `EventBlock.message`."""
        if self.name is not None or self.over_s or self.current_m_s is None:
            return self.title
        return f"the current is now {list(self.current_m_s)} m/s"


AnyEvent = Annotated[ThrusterEventBlock | CurrentEventBlock, Field(discriminator="kind")]
