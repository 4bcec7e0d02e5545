"""The `checks` list: what a run must show to pass, told apart by `kind`.

These blocks only say what is asked; `cube_sim.checks` answers it from the recorded signals.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator
from pydantic.types import Strict

from cube_sim.scenario.file_names import RecordFile
from cube_sim.scenario.statistic_keys import (
    Band,
    Bound,
    Combine,
    Component,
    Level,
    LimitKeys,
    NamedSignal,
    Percent,
    SignalKeys,
    SignalName,
    SparingBlock,
    StatisticKeys,
    StatisticName,
    named_signals_of,
    require_number,
    require_possible_limit,
    require_statistic,
    signal_in_words,
    statistic_in_words,
)
from cube_sim.scenario.values import Title, refuse
from cube_sim.scenario.windows import EventName, WindowKeys


class CheckBlock(SparingBlock):
    """What every check has; each also has a `title` and a `bound`."""

    name: Title | None = Field(
        default=None,
        description="Shown in results; must differ between checks. Default: made from what is asked.",
    )

    @property
    def named_signals(self) -> tuple[NamedSignal, ...]:
        """The signals that the scenario names; none where the check itself knows what to look at."""
        return ()


class SignalCheckBlock(WindowKeys, LimitKeys, StatisticKeys, SignalKeys, CheckBlock):
    """One statistic of one recorded signal against one limit.

    A signal with several columns is judged by its Euclidean norm at each sample, by the sum of its columns, or by one
    `component`. What is recorded on change is judged as held until the next change. Formulas: docs/checks.md.
    """

    kind: Literal["signal"]

    @model_validator(mode="after")
    def _possible_limit(self) -> Self:
        require_possible_limit(self.statistic, self)
        return self

    @property
    def title(self) -> str:
        """Name shown in results."""
        return self.name or f"{statistic_in_words(self)}{self.in_phase}"

    @property
    def named_signals(self) -> tuple[NamedSignal, ...]:
        """See `CheckBlock.named_signals`."""
        return named_signals_of(self)


class ComparisonBlock(LimitKeys, SignalKeys):
    """A signal against a limit, at each instant."""

    sparing: ClassVar[frozenset[str]] = frozenset(("scale",))

    scale: float | None = Field(
        default=None,
        ge=1e-9,
        le=1e12,
        description="So much of the signal's unit counts as 1 in the margin; needed where the units of several differ.",
    )

    @model_validator(mode="before")
    @classmethod
    def _without_others_inside(cls, data: Any) -> Any:
        for key in ("all", "any"):
            if isinstance(data, Mapping) and key in data:
                text = (
                    "a condition within a condition: several of `all` are checks of their own, and `while X, Y` is any:"
                )
                refuse(f"{text} [the opposite of X, Y]", key)
        return data

    @property
    def words(self) -> str:
        """For readers: "pose.position[2] <= -1"."""
        relation, limit = self.bound
        return f"{signal_in_words(self)} {relation} {limit:g}"


Comparisons = Annotated[tuple[ComparisonBlock, ...], Strict(False)]


class ComparisonsKeys(SparingBlock):
    """Comparisons that hold together, or of which one holds."""

    all: Comparisons = Field(default=(), description="Comparisons of which every one holds; give all or any.")
    any: Comparisons = Field(default=(), description="Comparisons of which at least one holds.")

    @model_validator(mode="after")
    def _one_list(self) -> Self:
        if bool(self.all) == bool(self.any):
            refuse("give exactly one list of comparisons: all or any", *(("any",) if self.any else ()))
        key = "all" if self.all else "any"
        for index, each in enumerate(self.comparisons):
            if (each.scale is None) == self.scaled:
                refuse("give every comparison a scale, or none", key, index)
        return self

    @property
    def comparisons(self) -> tuple[ComparisonBlock, ...]:
        """Those of `all`, or those of `any`."""
        return self.all or self.any

    @property
    def condition(self) -> str:
        """For readers."""
        return (" and " if self.all else " or ").join(each.words for each in self.comparisons)

    @property
    def scaled(self) -> bool:
        """Whether margins are pure numbers."""
        return self.comparisons[0].scale is not None

    @property
    def bound(self) -> Bound:
        """The limit of the only comparison; of several, their margin is held against 0."""
        alone = len(self.comparisons) == 1 and not self.scaled
        return self.comparisons[0].bound if alone else Bound(">=", 0.0)


class ConditionCheckBlock(WindowKeys, ComparisonsKeys, CheckBlock):
    """What checks of a condition have: comparisons, and a window."""

    @property
    def named_signals(self) -> tuple[NamedSignal, ...]:
        """See `CheckBlock.named_signals`."""
        key = "all" if self.all else "any"
        each = (named_signals_of(one, f"{key}.{index}") for index, one in enumerate(self.comparisons))
        return tuple(chain.from_iterable(each))


class AlwaysCheckBlock(ConditionCheckBlock):
    """A condition on signals holds at every instant of the window.

    The value is that of the worst instant: the signal's own where there is one comparison, else the smallest margin.
    """

    kind: Literal["always"]

    @property
    def title(self) -> str:
        """Name shown in results."""
        return self.name or f"always {self.condition}{self.in_phase}"


class EventuallyCheckBlock(ConditionCheckBlock):
    """A condition on signals holds at one instant of the window at least.

    The value is that of the best instant: the signal's own where there is one comparison, else the largest margin.
    """

    sparing: ClassVar[frozenset[str]] = frozenset(("within_s",))

    kind: Literal["eventually"]
    within_s: float | None = Field(
        default=None,
        gt=0,
        le=86400,
        description="Latest time after the start of the window [s]. Default: its end.",
    )

    @model_validator(mode="after")
    def _one_end(self) -> EventuallyCheckBlock:
        if self.within_s is not None and (self.to_s is not None or self.to_event is not None):
            refuse("the window ends within_s after its start: leave out to_s and to_event", "within_s")
        return self

    @property
    def title(self) -> str:
        """Name shown in results."""
        within = "" if self.within_s is None else f" within {self.within_s:g} s"
        return self.name or f"eventually{within} {self.condition}{self.in_phase}"


class StatisticBlock(WindowKeys, StatisticKeys, SignalKeys):
    """One statistic of one recorded signal, over a window of its own."""


class RatioCheckBlock(LimitKeys, CheckBlock):
    """One statistic divided by another, against one limit: energy by distance, one error by another."""

    sparing: ClassVar[frozenset[str]] = frozenset(("least_denominator",))

    kind: Literal["ratio"]
    numerator: StatisticBlock
    denominator: StatisticBlock
    least_denominator: float | None = Field(
        default=None,
        gt=0,
        description="A denominator that is smaller counts as so much, in its unit: below it only the numerator counts.",
    )

    @property
    def title(self) -> str:
        """Name shown in results."""
        above, below = (f"{statistic_in_words(each)}{each.in_phase}" for each in (self.numerator, self.denominator))
        return self.name or f"{above} / {below}"

    @property
    def named_signals(self) -> tuple[NamedSignal, ...]:
        """See `CheckBlock.named_signals`."""
        return named_signals_of(self.numerator, "numerator") + named_signals_of(self.denominator, "denominator")


class BeforeAfterCheckBlock(LimitKeys, StatisticKeys, SignalKeys, CheckBlock):
    """By how much one statistic of one signal is another after an event than before it.

    The value is the one after less the one before, or the one after over the one before.
    """

    kind: Literal["before_after"]
    event: EventName = Field(description="The event, by its name or by its number in the list of events, from 0.")
    before_s: float = Field(gt=0, le=86400, description="Length of the window that ends at the event [s].")
    after_s: float = Field(gt=0, le=86400, description="Length of the window after the event [s].")
    delay_s: float = Field(default=0.0, ge=0, le=86400, description="Time from the event until that window begins [s].")
    compare: Literal["difference", "ratio"] = Field(
        default="difference", description="difference: after less before. ratio: after over before."
    )

    @property
    def title(self) -> str:
        """Name shown in results."""
        sign = "-" if self.compare == "difference" else "/"
        return self.name or f"{statistic_in_words(self)}, after {sign} before event {self.event}"

    @property
    def named_signals(self) -> tuple[NamedSignal, ...]:
        """See `CheckBlock.named_signals`."""
        return named_signals_of(self)


class BaselineCheckBlock(WindowKeys, CheckBlock):
    """A run differs little from an earlier one: in one statistic, or in a whole signal, instant by instant.

    The value is the size of the difference. Of a whole signal it is the largest over time of |x - x of the baseline|, a
    norm over all columns of a vector.
    """

    sparing: ClassVar[frozenset[str]] = frozenset(("combine", "statistic", "level", "band", "percent"))

    kind: Literal["baseline"]
    record: RecordFile = Field(
        description="The run it is compared with, relative to the scenario file: its folder, its MCAP file, or a .npy"
        " table of the signal with the time in column 0."
    )
    signal: SignalName
    component: Component = None
    combine: Combine = "norm"
    statistic: StatisticName | None = Field(default=None, description="What is compared. Default: the whole signal.")
    level: Level = None
    band: Band = None
    percent: Percent = None
    tolerance: float = Field(ge=0, description="Largest difference that passes, in the unit of what is compared.")

    @model_validator(mode="after")
    def _statistic_or_whole(self) -> Self:
        if self.asked is None:
            for key in ("level", "band", "percent"):
                if getattr(self, key) is not None:
                    refuse(f"a whole signal takes no {key}: give a statistic", key)
        asked = self.asked or self.whole
        require_statistic(asked)
        require_number(asked)
        return self

    @property
    def asked(self) -> StatisticBlock | None:
        """The statistic; None for the whole signal."""
        if self.statistic is None:
            return None
        keys = {key: getattr(self, key) for key in ("signal", "component", "combine", "level", "band", "percent")}
        return StatisticBlock.model_construct(statistic=self.statistic, **keys)

    @property
    def whole(self) -> StatisticBlock:
        """The signal, by its largest number."""
        keys = {key: getattr(self, key) for key in ("signal", "component", "combine")}
        return StatisticBlock.model_construct(statistic="max", **keys)

    @property
    def title(self) -> str:
        """Name shown in results."""
        if self.asked is not None:
            return self.name or f"{statistic_in_words(self.asked)}{self.in_phase} against the baseline"
        return self.name or f"{signal_in_words(self.whole)}{self.in_phase} against the baseline"

    @property
    def bound(self) -> Bound:
        """The largest difference."""
        return Bound("<=", self.tolerance)

    @property
    def named_signals(self) -> tuple[NamedSignal, ...]:
        """See `CheckBlock.named_signals`."""
        return (NamedSignal(self.signal, self.component),)


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


class ProgressCheckBlock(WindowKeys, CheckBlock):
    """The virtual target, which waits for a vehicle that does not come, moves on along the path.

    Judged by its mean speed in the window: what it has gone along the path, laps of a closed one counted, over the time
    until it is at the end.
    """

    kind: Literal["progress"]
    at_least_m_s: float = Field(gt=0, description="Smallest mean speed of the target that passes [m/s].")

    @property
    def title(self) -> str:
        """Name shown in results."""
        return self.name or f"progress along the path{self.in_phase}"

    @property
    def unit(self) -> str:
        """Of the limit."""
        return "m/s"

    @property
    def bound(self) -> Bound:
        """The smallest speed [m/s]."""
        return Bound(">=", self.at_least_m_s)


class FalseAlarmsCheckBlock(CheckBlock):
    """No thruster is doubted that is whole: judged by how many ever are."""

    kind: Literal["false_alarms"]
    at_most: int = Field(default=0, ge=0, description="So many thrusters may be.")
    recovery_s: float = Field(
        default=6.0, ge=0, description="So long after thrusters have recovered nothing counts as a false alarm [s]."
    )

    @property
    def title(self) -> str:
        """Name shown in results."""
        return self.name or "thrusters doubted without cause"

    @property
    def unit(self) -> str:
        """Of the limit."""
        return "1"

    @property
    def bound(self) -> Bound:
        """The largest number."""
        return Bound("<=", float(self.at_most))


AnyCheck = Annotated[
    SignalCheckBlock
    | AlwaysCheckBlock
    | EventuallyCheckBlock
    | RatioCheckBlock
    | BeforeAfterCheckBlock
    | BaselineCheckBlock
    | AllowedForcesCheckBlock
    | ExactWrenchCheckBlock
    | PathEndCheckBlock
    | ProgressCheckBlock
    | FalseAlarmsCheckBlock,
    Field(discriminator="kind"),
]
