"""The `stop` list: what ends a run before its time, told apart by `kind`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import Field, model_validator

from cube_sim.scenario.statistic_keys import SignalName
from cube_sim.scenario.titled_block import TitledBlock
from cube_sim.scenario.values import Extent, Number, refuse

Stopping = Literal["pass", "fail"]
_MEANING = "pass: such an end is a proper one, the checks judge what was flown until then. fail: the run has failed."


class HeldStopBlock(TitledBlock):
    """A condition that has to hold for a time."""

    for_s: float = Field(default=0.0, ge=0, le=86400, description="How long it has to hold without a break [s].")
    from_s: float = Field(default=0.0, ge=0, le=86400, description="Before this time it is not looked at [s].")

    @property
    def lasting(self) -> str:
        """How long it has to hold, in words."""
        return f" for {self.for_s:g} s" if self.for_s else ""


class SignalStopBlock(HeldStopBlock):
    """A recorded signal is above or below a limit. One of several columns counts by its norm, or by one `component`."""

    kind: Literal["signal"]
    signal: SignalName = Field(
        description="Recorded signal as channel.field, for example pose.position; one that has a row at every tick, and"
        " is not made by `navigation`."
    )
    component: int | None = Field(
        default=None,
        ge=0,
        le=10**6,
        description="Column of a vector signal, from 0. Default: the norm of all its columns.",
    )
    above: Number | None = Field(default=None, description="It is larger than this, in the signal's unit.")
    below: Number | None = Field(default=None, description="It is smaller than this, in the signal's unit.")
    verdict: Stopping = Field(description=_MEANING)

    @model_validator(mode="after")
    def _one_limit(self) -> SignalStopBlock:
        if (self.above is None) == (self.below is None):
            both = () if self.above is None else ("below",)
            refuse("give exactly one limit: above or below", *both)
        return self

    @property
    def what(self) -> str:
        """See `TitledBlock.what`."""
        column = "" if self.component is None else f"[{self.component}]"
        limit = f"above {self.above:g}" if self.above is not None else f"below {self.below or 0.0:g}"
        return f"{self.signal}{column} {limit}{self.lasting}"


class PathEndStopBlock(HeldStopBlock):
    """The vehicle is at the end of the path: |vehicle - target| + remaining arc length is small."""

    kind: Literal["path_end"]
    reach_m: Extent = Field(description="Largest distance to the end of the path [m].")
    verdict: Stopping = Field(default="pass", description=_MEANING)

    @property
    def what(self) -> str:
        """See `TitledBlock.what`."""
        return f"end of the path reached within {self.reach_m:g} m{self.lasting}"


class GivenUpStopBlock(TitledBlock):
    """The path is given up, for whatever reason."""

    kind: Literal["given_up"]
    verdict: Stopping = Field(default="fail", description=_MEANING)

    @property
    def what(self) -> str:
        """See `TitledBlock.what`."""
        return "the path is given up"


class PhasesEndStopBlock(TitledBlock):
    """The last of the phases, or of the waypoints, is over."""

    kind: Literal["phases_end"]
    verdict: Stopping = Field(default="pass", description=_MEANING)

    @property
    def what(self) -> str:
        """See `TitledBlock.what`."""
        return "all phases are flown"


AnyStop = Annotated[
    SignalStopBlock | PathEndStopBlock | GivenUpStopBlock | PhasesEndStopBlock, Field(discriminator="kind")
]


def require_time_to_stop(stop: Sequence[AnyStop], duration_s: float | None) -> None:
    """Refuse conditions that nothing in the run can meet.

    Args:
        stop: of a scenario.
        duration_s: of the run; None where it is wrong itself.
    """
    for index, each in enumerate(stop):
        if duration_s is None or not isinstance(each, HeldStopBlock):
            continue
        if each.from_s >= duration_s:
            text = f"{each.from_s:g} s is not before the end of the run at {duration_s:g} s"
            refuse(text, index, "from_s", because=("duration_s",))
        if each.from_s + each.for_s > duration_s * (1 + 1e-12):
            text = f"from {each.from_s:g} s on it can hold for {duration_s - each.from_s:g} s, to the end of the run"
            refuse(text, index, "for_s", because=("duration_s",))
