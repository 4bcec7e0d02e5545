"""The `checks` list: what a run must show to pass, told apart by `kind`.

These blocks only say what is asked; `cube_sim.checks` answers it from the recorded signals.
"""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

from pydantic import Field, StringConstraints, model_validator

from cube_sim.scenario.values import Block, Title, refuse

Statistic = Literal["rms", "mean", "max", "min", "max_abs", "final"]
SignalName = Annotated[str, StringConstraints(pattern=r"^[a-z0-9_]+\.[a-z0-9_]+$")]


class Bound(NamedTuple):
    """What the value of a check is compared with.

    Attributes:
        relation: how the value must compare with the limit.
        limit: in the value's unit.
    """

    relation: Literal["<=", ">="]
    limit: float


class CheckBlock(Block):
    """What every check has; each also has a `title` and a `bound`."""

    name: Title | None = Field(
        default=None,
        description="Shown in results; must differ between checks. Default: made from what is asked.",
    )

    @property
    def named_signal(self) -> tuple[str, int | None] | None:
        """The signal that the scenario names, and the column; None where the check itself knows what to look at."""
        return None


class SignalCheckBlock(CheckBlock):
    """One statistic of one recorded signal against one limit.

    A signal with several columns is judged by its Euclidean norm at each sample, or by one `component`.
    """

    kind: Literal["signal"]
    signal: SignalName = Field(description="Recorded signal as channel.field, for example path_error.cross_track.")
    component: int | None = Field(
        default=None,
        ge=0,
        description="Column of a vector signal, from 0. Default: the norm of all its columns.",
    )
    statistic: Statistic = Field(description="What is compared with the limit, over the samples of the window.")
    at_most: float | None = Field(default=None, description="Largest value that passes, in the signal's unit.")
    at_least: float | None = Field(default=None, description="Smallest value that passes, in the signal's unit.")
    from_s: float | None = Field(default=None, ge=0, description="Start of the window [s]. Default: start of the run.")
    to_s: float | None = Field(default=None, gt=0, description="End of the window [s]. Default: end of the run.")

    @model_validator(mode="after")
    def _one_limit_and_a_window(self) -> SignalCheckBlock:
        if (self.at_most is None) == (self.at_least is None):
            refuse("give exactly one limit: at_most or at_least")
        if self.from_s is not None and self.to_s is not None and not self.from_s < self.to_s:
            refuse(f"the window is empty: from_s {self.from_s:g} is not before to_s {self.to_s:g}", "to_s")
        return self

    @property
    def title(self) -> str:
        """Name shown in results."""
        column = "" if self.component is None else f"[{self.component}]"
        return self.name or f"{self.statistic} of {self.signal}{column}"

    @property
    def bound(self) -> Bound:
        """The one limit that is given."""
        if self.at_most is not None:
            return Bound("<=", self.at_most)
        if self.at_least is not None:
            return Bound(">=", self.at_least)
        raise ValueError("a signal check holds at_most or at_least")

    @property
    def named_signal(self) -> tuple[str, int | None]:
        """See `CheckBlock.named_signal`."""
        return self.signal, self.component


class AllowedForcesCheckBlock(CheckBlock):
    """Every demanded thruster force lies in its allowed set at every tick.

    The set is [F_max-, F_DZ-] u [F_DZ+, F_max+], and 0 where a thruster may be off.
    """

    kind: Literal["allowed_forces"]
    tolerance_N: float = Field(  # noqa: N815 - N is the newton
        default=1e-6, ge=0, description="Largest distance to the allowed set that passes [N]."
    )
    allow_off: bool | None = Field(
        default=None, description="Whether 0 N belongs to the set. Default: as in the allocation block."
    )

    @property
    def title(self) -> str:
        """Name shown in results."""
        return self.name or "thruster forces inside their allowed sets"

    @property
    def unit(self) -> str:
        """Of the limit."""
        return "N"

    @property
    def bound(self) -> Bound:
        """The largest distance [N]."""
        return Bound("<=", self.tolerance_N)


class ExactWrenchCheckBlock(CheckBlock):
    """|A f - F| stays small at every tick whose wrench the allocation calls attainable."""

    kind: Literal["exact_wrench"]
    at_most: float = Field(
        default=1e-3,
        ge=0,
        description="Largest Euclidean norm of A f - F that passes; forces in N and torques in N m together.",
    )

    @property
    def title(self) -> str:
        """Name shown in results."""
        return self.name or "|A f - F| wherever attainable"

    @property
    def unit(self) -> str:
        """Of the limit: forces and torques together."""
        return "N, N m"

    @property
    def bound(self) -> Bound:
        """The largest norm."""
        return Bound("<=", self.at_most)


class PathEndCheckBlock(CheckBlock):
    """The vehicle arrives at the end of the path, having followed the virtual target there.

    Judged by the smallest value over the run of |vehicle - target| + remaining arc length, which the distance
    to the path's end never exceeds. A closed path is therefore not "reached" at its start.
    """

    kind: Literal["path_end"]
    reach_m: float = Field(gt=0, description="Largest distance to the end of the path that passes [m].")

    @property
    def title(self) -> str:
        """Name shown in results."""
        return self.name or "end of the path reached"

    @property
    def unit(self) -> str:
        """Of the limit."""
        return "m"

    @property
    def bound(self) -> Bound:
        """The largest distance [m]."""
        return Bound("<=", self.reach_m)


AnyCheck = Annotated[
    SignalCheckBlock | AllowedForcesCheckBlock | ExactWrenchCheckBlock | PathEndCheckBlock,
    Field(discriminator="kind"),
]
