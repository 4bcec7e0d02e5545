"""`events` of the kind `fins`: a fin's servo fails, or comes back."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic.types import Strict

from cube_sim.scenario.event_block import EventBlock
from cube_sim.scenario.values import refuse

FinState = Literal["jammed", "loose", "slow", "short", "recovered"]
FinAngle = Annotated[float, Field(ge=-180, le=180)]


class FinEventBlock(EventBlock):
    """Fins that servos turn fail, or come back; what a fin had before is over."""

    kind: Literal["fins"]
    fins: Annotated[tuple[str, ...], Strict(False)] = Field(
        description="Names of the servos that turn them, for example [rudder].", json_schema_extra={"minItems": 1}
    )
    state: FinState = Field(
        description="jammed: stands still whatever it is told; loose: follows the flow, without lift; slow: turns no"
        " faster than rate_deg_s; short: turns within travel_deg only; recovered: whole."
    )
    angle_deg: FinAngle | None = Field(
        default=None,
        description="Angle a jammed fin goes to, at its servo's rate, and stays at [deg]. Default: where it is.",
    )
    rate_deg_s: float | None = Field(default=None, gt=0, le=1e4, description="Fastest rate of a slow fin [deg/s].")
    travel_deg: Annotated[tuple[FinAngle, FinAngle], Strict(False)] | None = Field(
        default=None, description="Least and largest deflection of one that is short of travel [deg]."
    )

    @model_validator(mode="after")
    def _what_the_state_needs(self) -> FinEventBlock:
        if not self.fins:
            refuse("name at least one fin", "fins")
        for index, name in enumerate(self.fins):
            if name in self.fins[:index]:
                refuse(f"{name} is named twice", "fins", index)
        for key, state in (("rate_deg_s", "slow"), ("travel_deg", "short")):
            given = getattr(self, key) is not None
            if given != (self.state == state):
                refuse(f"{key} and state {state} go together: give both or neither", key if given else "state")
        if self.angle_deg is not None and self.state != "jammed":
            refuse(f"is that of a jammed fin, not of one that is {self.state}", "angle_deg")
        if self.travel_deg is not None and not self.travel_deg[0] < self.travel_deg[1]:
            refuse(f"must increase: least and largest, got {list(self.travel_deg)}", "travel_deg")
        return self

    @property
    def what(self) -> str:
        """See `EventBlock.what`."""
        how = "" if self.angle_deg is None else f" at {self.angle_deg:g} deg"
        how += "" if self.rate_deg_s is None else f", {self.rate_deg_s:g} deg/s"
        how += "" if self.travel_deg is None else ", {:g} to {:g} deg".format(*self.travel_deg)
        return f"{', '.join(self.fins)}: {self.state}{how}"
