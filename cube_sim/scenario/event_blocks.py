"""The `events` list: what happens to the vehicle and the water during a run, told apart by `kind`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic.types import Strict

from cube_sim.scenario.current_block import CurrentProfileBlock
from cube_sim.scenario.event_block import EventBlock
from cube_sim.scenario.fin_event_block import FinEventBlock
from cube_sim.scenario.sensor_event_block import SensorEventBlock
from cube_sim.scenario.values import (
    ZERO,
    Newtons,
    Newtons3,
    Number,
    Place,
    Seconds,
    WaterVelocity,
    refuse,
)

ThrusterState = Literal["dead", "weak", "stuck", "recovered"]


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
    force_N: Newtons | None = Field(  # noqa: N815 - N is the newton
        default=None, description="Force a stuck thruster holds [N]."
    )

    @model_validator(mode="after")
    def _what_the_state_needs(self) -> ThrusterEventBlock:
        if not self.thrusters:
            refuse("name at least one thruster", "thrusters")
        for index, name in enumerate(self.thrusters):
            if name in self.thrusters[:index]:
                refuse(f"{name} is named twice", "thrusters", index)
        for key, state in (("efficiency", "weak"), ("force_N", "stuck")):
            given = getattr(self, key) is not None
            if given != (self.state == state):
                refuse(f"{key} and state {state} go together: give both or neither", key if given else "state")
        return self

    @property
    def what(self) -> str:
        """See `TitledBlock.what`."""
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
    current_m_s: WaterVelocity | None = Field(
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
        """See `TitledBlock.what`."""
        return f"current becomes {self._becomes}" + (f" within {self.over_s:g} s" if self.over_s else "")

    @property
    def message(self) -> str:
        """See `EventBlock.message`."""
        if self.name is not None or self.over_s or self.current_m_s is None:
            return self.title
        return f"the current is now {list(self.current_m_s)} m/s"


class ForceEventBlock(EventBlock):
    """Something pushes the vehicle: a force, a torque, or both; several add up.

    They act inside each step of the physics: one in body axes turns with the vehicle. The controller does not know of
    them. The record has the wrench of all of them as the channel `disturbance`.
    """

    kind: Literal["force"]
    force_N: Newtons3 = Field(default=ZERO, description="Force [N].")  # noqa: N815 - N is the newton
    torque_N_m: Newtons3 = Field(default=ZERO, description="Torque, besides that of the force [N m].")  # noqa: N815
    axes: Literal["world", "body"] = Field(
        default="world", description="Axes of both: fixed in the world, or turning with the vehicle."
    )
    point_m: Place | None = Field(
        default=None,
        description="Where the force acts, from the body origin in body axes [m]. Default: the centre of mass.",
    )
    site: str | None = Field(
        default=None, min_length=1, description="The same as a site of the model that is fixed to the vehicle's hull."
    )
    for_s: Seconds | None = Field(
        default=None, description="How long it acts, over_s at both ends included [s]. Default: to the end."
    )
    over_s: float = Field(default=0.0, ge=0, le=86400, description="Time in which it grows, and fades again [s].")

    @model_validator(mode="after")
    def _makes_sense(self) -> ForceEventBlock:
        if not any((*self.force_N, *self.torque_N_m)):
            refuse("give force_N, torque_N_m or both", "force_N")
        if self.point_m is not None and self.site is not None:
            refuse("give either point_m or site", "site")
        if self.for_s is not None and 2.0 * self.over_s > self.for_s:
            refuse(f"must be at most half of for_s, {self.for_s:g} s: it grows and fades within it", "over_s")
        return self

    @property
    def what(self) -> str:
        """See `TitledBlock.what`."""
        given = [(self.force_N, "N"), (self.torque_N_m, "N m")]
        told = " and ".join(f"[{x:g}, {y:g}, {z:g}] {unit}" for (x, y, z), unit in given if any((x, y, z)))
        where = "" if self.site is None else f" at {self.site}"
        where += "" if self.point_m is None else " at [{:g}, {:g}, {:g}] m".format(*self.point_m)
        return f"pushed by {told}{where}, {self.axes} axes" + ("" if self.for_s is None else f", for {self.for_s:g} s")

    @property
    def ends(self) -> tuple[float, str] | None:
        """See `EventBlock.ends`."""
        return None if self.for_s is None else (self.at_s + self.for_s, f"{self.name or 'the push'}: over")


class SetpointEventBlock(EventBlock):
    """An actuator of `setpoints`, or any other that is no thruster and no fin, is told something else from then on."""

    kind: Literal["setpoint"]
    actuator: str = Field(min_length=1, description="Its name in the model.")
    value: Number = Field(description="The command from then on, in the actuator's own unit.")
    over_s: float = Field(
        default=0.0, ge=0, le=86400, description="Time in which it changes evenly from what it was [s]. 0: at once."
    )

    @property
    def what(self) -> str:
        """See `EventBlock.what`."""
        return f"{self.actuator}: to {self.value:g}" + (f" within {self.over_s:g} s" if self.over_s else "")


AnyEvent = Annotated[
    ThrusterEventBlock | FinEventBlock | CurrentEventBlock | ForceEventBlock | SensorEventBlock | SetpointEventBlock,
    Field(discriminator="kind"),
]
