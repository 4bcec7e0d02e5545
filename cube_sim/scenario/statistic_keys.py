"""The keys that say which statistic of which signal is meant."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Protocol, Self

from pydantic import (
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    StringConstraints,
    model_serializer,
    model_validator,
)
from pydantic.types import Strict

from cube_sim.scenario.values import Block, Number, refuse

Statistic = Literal[
    "rms",
    "mean",
    "max",
    "min",
    "max_abs",
    "final",
    "min_abs",
    "std",
    "percentile",
    "share_above",
    "share_below",
    "share_within",
    "crossings",
    "changes",
    "settling",
    "integral",
    "increase",
]
NEEDS: Mapping[str, str] = {
    "percentile": "percent",
    "share_above": "level",
    "share_below": "level",
    "crossings": "level",
    "share_within": "band",
    "settling": "band",
}
"""The key without which a statistic says nothing."""
SHARES = "share_above", "share_below", "share_within"
COUNTS = "crossings", "changes"
FIRST = "name", "kind"
"""Keys with which a block begins where it is written out."""
AMONG_SAMPLES = "rms", "mean", "max", "min", "max_abs", "min_abs", "final", "percentile"
"""Those whose value can be drawn beside the samples they are of."""
NEVER_NEGATIVE = "rms", "max_abs", "min_abs", "std", *SHARES, *COUNTS, "settling"

SIGNAL = r"^([a-z0-9_]+/)?[a-z0-9_]+\.[a-z0-9_]+$"
"""What a signal is called: channel.field, among several vehicles vehicle/channel.field."""

_COLUMN = re.compile(r"(?P<signal>([a-z0-9_]+/)?[a-z0-9_]+\.[a-z0-9_]+)(\.(?P<after>\w+)|\[(?P<number>[0-9]+)\])")
_LETTERS = {"quaternion": "wxyz"}
"""Columns of a field by their letters, where they are others than x, y, z."""


def _without_column(name: object) -> object:
    """Refuse `pose.position.z` with the component that it means; whatever else is wrong is left to others."""
    if isinstance(name, str) and (found := _COLUMN.fullmatch(name)) is not None:
        signal, column = found["signal"], found["number"] or found["after"]
        letters = _LETTERS.get(signal.rpartition(".")[2], "xyz")
        if not column.isdecimal():
            column = str(letters.index(column)) if len(column) == 1 and column in letters else "<column, from 0>"
        refuse(
            f"must be channel.field, got '{name}'; for one of its columns write signal: {signal}, component: {column}"
        )
    return name


SignalName = Annotated[
    str,
    StringConstraints(pattern=SIGNAL),
    BeforeValidator(_without_column),
    Field(description="Recorded signal as channel.field, for example path_error.cross_track."),
]
Minus = Annotated[
    str | None,
    StringConstraints(pattern=SIGNAL),
    BeforeValidator(_without_column),
    Field(description="Signal that is taken away from it at each instant, of the same columns, unit and times."),
]
Component = Annotated[
    int | None,
    Field(ge=0, description="Column of a vector signal, from 0. Default: all its columns, as `combine` says."),
]
Combining = Literal["norm", "sum", "horizontal"]
Combine = Annotated[
    Combining,
    Field(
        description="How the columns of a vector signal become one number: their Euclidean norm, their sum, or the norm"
        " of the first two, x and y."
    ),
]
StatisticName = Annotated[Statistic, Field(description="What is compared with the limit, over the window.")]
Level = Annotated[
    Number | None,
    Field(description="In the signal's unit: above or below it time is counted, and across it crossings."),
]
Band = Annotated[
    Annotated[tuple[Number, Number], Strict(False)] | None,
    Field(description="[lowest, highest] in the signal's unit: share_within it; settling in it, for good."),
]
Percent = Annotated[
    float | None,
    Field(gt=0, le=100, description="percentile: so much of the time the signal is no larger than the value, in %."),
]
AtMost = Annotated[float | None, Field(description="Largest value that passes, in the unit of what is judged.")]
AtLeast = Annotated[float | None, Field(description="Smallest value that passes, in the unit of what is judged.")]


class NamedSignal(NamedTuple):
    """A signal that a check names.

    Attributes:
        signal: channel.field.
        component: the column; None for all.
        place: dotted path, within the check, of the block that names it; "" for the check itself.
        key: of the signal, in that block.
        beside: the signal from which it is taken away; "" for none.
    """

    signal: str
    component: int | None = None
    place: str = ""
    key: str = "signal"
    beside: str = ""


class Bound(NamedTuple):
    """What the value of a check is compared with.

    Attributes:
        relation: how the value must compare with the limit.
        limit: in the value's unit.
    """

    relation: Literal["<=", ">="]
    limit: float


class NamesSignal(Protocol):
    """What says which number of which signal is meant."""

    @property
    def signal(self) -> str: ...  # noqa: D102
    @property
    def minus(self) -> str | None: ...  # noqa: D102
    @property
    def component(self) -> int | None: ...  # noqa: D102
    @property
    def combine(self) -> Combining: ...  # noqa: D102


class NamesStatistic(Protocol):
    """What says which statistic is meant."""

    @property
    def statistic(self) -> Statistic: ...  # noqa: D102
    @property
    def level(self) -> float | None: ...  # noqa: D102
    @property
    def band(self) -> tuple[float, float] | None: ...  # noqa: D102
    @property
    def percent(self) -> float | None: ...  # noqa: D102


class AsksStatistic(NamesSignal, NamesStatistic, Protocol):
    """What says which statistic of which signal is meant."""


class HasLimit(Protocol):
    """What has the keys of a limit."""

    @property
    def at_most(self) -> float | None: ...  # noqa: D102
    @property
    def at_least(self) -> float | None: ...  # noqa: D102


class SparingBlock(Block):
    """A block that is written out without some keys that nobody has given a value: `sparing`, of every class it is."""

    sparing: ClassVar[frozenset[str]] = frozenset()

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        super().__pydantic_init_subclass__(**options)
        cls.sparing = cls.sparing.union(*(vars(base).get("sparing", ()) for base in cls.__mro__))

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields, written = type(self).model_fields, write(self)
        first = {key: written[key] for key in FIRST if key in written}
        return first | {
            key: value
            for key, value in written.items()
            if key not in self.sparing or getattr(self, key) != fields[key].default
        }


class SignalKeys(SparingBlock):
    """Which number of which signal is meant."""

    sparing: ClassVar[frozenset[str]] = frozenset(("minus", "combine"))

    signal: SignalName
    minus: Minus = None
    component: Component = None
    combine: Combine = "norm"

    @model_validator(mode="after")
    def _one_number(self) -> Self:
        require_number(self)
        return self


class StatisticKeys(SparingBlock):
    """Which statistic is meant, of whatever signal."""

    sparing: ClassVar[frozenset[str]] = frozenset(("level", "band", "percent"))

    statistic: StatisticName
    level: Level = None
    band: Band = None
    percent: Percent = None

    @model_validator(mode="after")
    def _what_it_needs(self) -> Self:
        require_statistic(self)
        return self


class LimitKeys(SparingBlock):
    """What the value is compared with: one of two limits."""

    at_most: AtMost = None
    at_least: AtLeast = None

    @model_validator(mode="after")
    def _one_limit(self) -> Self:
        if (self.at_most is None) == (self.at_least is None):
            both = () if self.at_most is None else ("at_least",)
            refuse("give exactly one limit: at_most or at_least", *both)
        return self

    @property
    def bound(self) -> Bound:
        """The one limit that is given."""
        if self.at_most is not None:
            return Bound("<=", self.at_most)
        if self.at_least is not None:
            return Bound(">=", self.at_least)
        raise ValueError("a check holds at_most or at_least")


def statistic_in_words(asked: AsksStatistic) -> str:
    """The statistic with what it needs, and the signal: "percentile 95 of path_error.cross_track"."""
    return f"{statistic_alone(asked)} of {signal_in_words(asked)}"


def signal_in_words(asked: NamesSignal) -> str:
    """The signal, what is taken away from it, and which part of that is meant: "pose.position[2]"."""
    name = asked.signal if asked.minus is None else f"{asked.signal} - {asked.minus}"
    if asked.component is not None:
        return f"{name}[{asked.component}]" if asked.minus is None else f"({name})[{asked.component}]"
    return {"norm": name, "sum": f"the sum of {name}", "horizontal": f"the horizontal part of {name}"}[asked.combine]


def named_signals_of(asked: NamesSignal, place: str = "") -> tuple[NamedSignal, ...]:
    """The signals that a block names.

    Args:
        asked: the block.
        place: dotted path of it, within its check.
    """
    named = NamedSignal(asked.signal, asked.component, place)
    if asked.minus is None:
        return (named,)
    return named, NamedSignal(asked.minus, None, place, "minus", asked.signal)


def statistic_alone(asked: NamesStatistic) -> str:
    """The statistic with what it needs: "share above 0.5"."""
    name = asked.statistic.replace("_", " ") if asked.statistic in SHARES else asked.statistic
    if asked.statistic == "percentile":
        return f"{name} {asked.percent:g}"
    if asked.statistic in ("share_above", "share_below"):
        return f"{name} {asked.level:g}"
    if asked.statistic == "crossings":
        return f"{name} of {asked.level:g}" if asked.level is not None else name
    if asked.band is not None:
        inside = f"[{asked.band[0]:g}, {asked.band[1]:g}]"
        return f"{name} {inside}" if asked.statistic == "share_within" else f"{name} in {inside}"
    return name


def require_statistic(asked: NamesStatistic) -> None:
    """Refuse keys that do not go with the statistic, and a statistic without what it needs."""
    needed = NEEDS.get(asked.statistic)
    for key in dict.fromkeys(NEEDS.values()):
        given = getattr(asked, key) is not None
        if given and key != needed:
            users = ", ".join(name for name, key_needed in NEEDS.items() if key_needed == key)
            refuse(f"{asked.statistic} takes no {key}; {users} {'do' if ',' in users else 'does'}", key)
        if key == needed and not given:
            refuse(f"{asked.statistic} needs the key {key}", "statistic")
    if asked.band is not None and not asked.band[0] < asked.band[1]:
        refuse(f"must be [lowest, highest], got {list(asked.band)}", "band")


def require_number(asked: NamesSignal) -> None:
    """Refuse keys of a signal that do not go together."""
    if asked.component is not None and asked.combine != "norm":
        refuse("one component has nothing to combine: leave out one of the two", "combine")
    if asked.minus == asked.signal:
        refuse("a signal less itself is 0 at every instant: name another", "minus")


def require_possible_limit(statistic: Statistic, asked: HasLimit) -> None:
    """Refuse a limit that no value of the statistic can meet, and one that every share of the time meets."""
    if statistic in NEVER_NEGATIVE and asked.at_most is not None and asked.at_most < 0:
        refuse(f"{statistic} is never negative: must be at least 0, got {asked.at_most:g}", "at_most")
    if statistic in SHARES and asked.at_least is not None and asked.at_least > 1:
        refuse(f"{statistic} is 1 at most, all of the time; got {asked.at_least:g}", "at_least")
    if statistic in SHARES and asked.at_most is not None and asked.at_most >= 1:
        refuse(f"{statistic} is 1 at most, all of the time: {asked.at_most:g} lets every run pass", "at_most")
    if statistic in SHARES and asked.at_least is not None and asked.at_least <= 0:
        refuse(f"{statistic} is never negative: {asked.at_least:g} lets every run pass", "at_least")
