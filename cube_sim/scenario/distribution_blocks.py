"""Distributions that the values of a key are drawn from, told apart by `distribution`."""

from __future__ import annotations

from math import exp
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator
from pydantic.types import Strict

from cube_sim.scenario.values import LARGEST_NUMBER, Block, Numbers, refuse

MOST_SAMPLES = 10_000_000
"""Of a scenario, at most."""
Gives = Literal["value", "factor", "percent", "offset"]
Whole = Annotated[tuple[int, ...], Strict(False)]


def at_least_one(value: Any) -> Any:
    """One number as a list of one."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        if not abs(value) <= LARGEST_NUMBER:
            refuse(f"must be a number of at most {LARGEST_NUMBER:g} either way, got {value:g}")
        return (value,)
    if not isinstance(value, list | tuple):
        refuse(f"must be a number, or a list of them, got {value!r:.60}")
    return value


_NUMBER_OR_NUMBERS = {"anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}, "minItems": 1}]}
_WHOLE_OR_WHOLES = {"anyOf": [{"type": "integer"}, {"type": "array", "items": {"type": "integer"}, "minItems": 1}]}
NumberOrNumbers = Annotated[
    Numbers, Field(min_length=1), BeforeValidator(at_least_one), WithJsonSchema(_NUMBER_OR_NUMBERS)
]
"""One number, or one for each entry of the list that the key holds."""
WholeOrWholes = Annotated[Whole, Field(min_length=1), BeforeValidator(at_least_one), WithJsonSchema(_WHOLE_OR_WHOLES)]

_GIVES = (
    "What a number drawn is: the key's value, in its unit; a factor on what the scenario, or the model, has there;"
    " a change of that in percent; or an offset, added to it."
)


class DistributionBlock(Block):
    """Where the values of a key come from; each also has its `ends`."""

    gives: Gives = Field(default="value", description=_GIVES)

    @property
    def ends(self) -> tuple[Any, ...]:
        """Values as far out as it gives: what the key takes of these, it takes of all between."""
        raise NotImplementedError


def _require_as_many(block: DistributionBlock, *keys: str) -> None:
    first = keys[0]
    for key in keys[1:]:
        given = getattr(block, key)
        if given is not None and len(given) != len(getattr(block, first)):
            refuse(f"must have as many numbers as {first}: {len(given)} against {len(getattr(block, first))}", key)


def _one_or_list(numbers: tuple[float, ...]) -> Any:
    return numbers[0] if len(numbers) == 1 else list(numbers)


BETWEEN = 0.38196601125
"""Share of a range, no simple fraction of it."""


class RangeBlock(DistributionBlock):
    """Numbers from `low` to `high`."""

    low: NumberOrNumbers = Field(description="Lower end; of a list, one for all entries or one for each.")
    high: NumberOrNumbers = Field(description="Upper end, likewise.")

    @model_validator(mode="after")
    def _in_order(self) -> RangeBlock:
        _require_as_many(self, "low", "high")
        for low, high in zip(self.low, self.high, strict=True):
            if low > high:
                refuse(f"must not be below low: {high:g} against {low:g}", "high")
        return self

    @property
    def ends(self) -> tuple[Any, ...]:
        """Both, and a number between, which a key of steps does not take."""
        between = tuple(low + BETWEEN * (high - low) for low, high in zip(self.low, self.high, strict=True))
        return _one_or_list(self.low), _one_or_list(self.high), _one_or_list(between)


class UniformBlock(RangeBlock):
    """Any number of a range is as likely as any other; entries of a list are independent."""

    distribution: Literal["uniform"]


class SobolBlock(RangeBlock):
    """A range filled evenly, together with all other keys of this kind: a scrambled Sobol sequence.

    Sample k takes the k-th point. A count that is a power of two fills the ranges best.
    """

    distribution: Literal["sobol"]


FARTHEST = 6.0
"""Standard deviations as far as a bell that is not cut off is checked: one draw in 5e8 lies farther out."""


class BellBlock(DistributionBlock):
    """What the two bell-shaped distributions share: ends beyond which they are cut off."""

    at_least: float | None = Field(default=None, description="Nothing below is drawn. Default: no bound.")
    at_most: float | None = Field(default=None, description="Nothing above is drawn. Default: no bound.")

    def _far_out(self) -> tuple[list[float], list[float]]:
        """Lowest and highest numbers, six standard deviations out, of each entry."""
        raise NotImplementedError

    @property
    def ends(self) -> tuple[Any, ...]:
        """Its bounds, or six standard deviations from the middle: of the logarithm where that is drawn."""
        low, high = self._far_out()
        lowest = tuple(each if self.at_least is None else self.at_least for each in low)
        highest = tuple(each if self.at_most is None else self.at_most for each in high)
        return _one_or_list(lowest), _one_or_list(highest)

    def _require_something_between(self) -> None:
        """Refuse bounds that are out of order, or beyond all that is drawn."""
        low, high = self._far_out()
        if self.at_least is not None and self.at_most is not None and self.at_least >= self.at_most:
            refuse(f"must be above at_least: {self.at_most:g} against {self.at_least:g}", "at_most")
        if self.at_least is not None and self.at_least > min(high):
            refuse(f"lies more than {FARTHEST:g} standard deviations out: nothing is left to draw", "at_least")
        if self.at_most is not None and self.at_most < max(low):
            refuse(f"lies more than {FARTHEST:g} standard deviations out: nothing is left to draw", "at_most")


class NormalBlock(BellBlock):
    """A normal distribution, cut off at its bounds where it has some; entries of a list are independent."""

    distribution: Literal["normal"]
    mean: NumberOrNumbers = Field(description="Of the distribution before it is cut off; one, or one for each entry.")
    std: NumberOrNumbers = Field(description="Standard deviation, likewise.")

    @model_validator(mode="after")
    def _positive(self) -> NormalBlock:
        _require_as_many(self, "mean", "std")
        if min(self.std) < 0.0:
            refuse(f"must be at least 0, got {min(self.std):g}", "std")
        self._require_something_between()
        return self

    def _far_out(self) -> tuple[list[float], list[float]]:
        pairs = list(zip(self.mean, self.std, strict=True))
        return [m - FARTHEST * s for m, s in pairs], [m + FARTHEST * s for m, s in pairs]


class LogNormalBlock(BellBlock):
    """A number whose logarithm is normal, cut off at its bounds where it has some."""

    distribution: Literal["log_normal"]
    median: NumberOrNumbers = Field(description="Half of the draws are below; one, or one for each entry.")
    log_std: NumberOrNumbers = Field(description="Standard deviation of the natural logarithm: 0.1 is about 10 %.")

    @model_validator(mode="after")
    def _positive(self) -> LogNormalBlock:
        _require_as_many(self, "median", "log_std")
        if min(self.median) <= 0.0:
            refuse(f"must be greater than 0, got {min(self.median):g}", "median")
        if not 0.0 <= min(self.log_std) <= max(self.log_std) <= 10.0:
            refuse(f"is of the logarithm: from 0 to 10, got {list(self.log_std)}", "log_std")
        self._require_something_between()
        return self

    def _far_out(self) -> tuple[list[float], list[float]]:
        pairs = list(zip(self.median, self.log_std, strict=True))
        return [m * exp(-FARTHEST * s) for m, s in pairs], [m * exp(FARTHEST * s) for m, s in pairs]


class IntegersBlock(DistributionBlock):
    """Whole numbers, each from `low` to `high` as likely as any other."""

    distribution: Literal["integers"]
    low: WholeOrWholes = Field(description="Lowest; of a list, one for all entries or one for each.")
    high: WholeOrWholes = Field(description="Highest, likewise.")

    @model_validator(mode="after")
    def _in_order(self) -> IntegersBlock:
        _require_as_many(self, "low", "high")
        for low, high in zip(self.low, self.high, strict=True):
            if low > high:
                refuse(f"must not be below low: {high} against {low}", "high")
            if not -(2**63) <= low <= high < 2**63 - 1:
                refuse("must be within 64 bits", "high")
        return self

    @property
    def ends(self) -> tuple[Any, ...]:
        """Both."""
        return _one_or_list(self.low), _one_or_list(self.high)


class ChoiceBlock(DistributionBlock):
    """One of some values, of whatever kind the key takes."""

    distribution: Literal["choice"]
    values: Annotated[tuple[Any, ...], Strict(False)] = Field(
        min_length=1, description="What is drawn from; a block or a list too, where the key takes one."
    )
    weights: Numbers | None = Field(
        default=None, description="How likely each is, beside the others. Default: one as the other."
    )

    @model_validator(mode="after")
    def _a_weight_for_each(self) -> ChoiceBlock:
        if self.weights is not None:
            if len(self.weights) != len(self.values):
                refuse(f"must have one for each of the {len(self.values)} values, has {len(self.weights)}", "weights")
            if min(self.weights) < 0.0 or sum(self.weights) <= 0.0:
                refuse("must be at least 0 each, and not all 0", "weights")
        return self

    @property
    def ends(self) -> tuple[Any, ...]:
        """All values."""
        return self.values


class GridBlock(DistributionBlock):
    """Each of some values in turn, with each of all other keys of this kind.

    Either `values`, or `points` numbers from `low` to `high`. Samples go through the grid in order, the key that comes
    first in the alphabet changing last; a count above the size of the grid goes through it again.
    """

    distribution: Literal["grid"]
    values: Annotated[tuple[Any, ...], Strict(False)] | None = Field(
        default=None, description="In this order; of whatever kind the key takes. Default: low, high and points say."
    )
    low: float | None = Field(default=None, description="The first number.")
    high: float | None = Field(default=None, description="The last number.")
    points: int | None = Field(default=None, ge=2, le=MOST_SAMPLES, description="How many, evenly spaced.")

    @model_validator(mode="after")
    def _one_way(self) -> GridBlock:
        numbers = [key for key in ("low", "high", "points") if getattr(self, key) is not None]
        if (self.values is None) == (not numbers) or len(numbers) not in (0, 3):
            refuse("give values, or low, high and points")
        if self.values is not None and not self.values:
            refuse("must have 1 or more entries, has 0", "values")
        return self

    @property
    def size(self) -> int:
        """How many values there are."""
        return len(self.values) if self.values is not None else self.points or 0

    def value(self, index: int) -> Any:
        """One of them."""
        if self.values is not None:
            return self.values[index]
        low, high, points = self.low, self.high, self.points
        if low is None or high is None or points is None:
            raise ValueError("a grid holds values, or low, high and points")
        return high if index == points - 1 else low + (high - low) * (index / (points - 1))

    @property
    def ends(self) -> tuple[Any, ...]:
        """All values, or the first number and the last."""
        return self.values if self.values is not None else (self.value(0), self.value(self.size - 1))


class DirectionBlock(DistributionBlock):
    """A vector of three numbers whose direction is drawn evenly, and its length from a range: a current, a force."""

    distribution: Literal["direction"]
    low: float = Field(default=0.0, ge=0, description="Least length.")
    high: float = Field(ge=0, description="Greatest length.")
    plane: Literal["horizontal", "any"] = Field(
        default="horizontal", description="horizontal: the third number is 0; any: a direction in space."
    )

    @model_validator(mode="after")
    def _in_order(self) -> DirectionBlock:
        if self.low > self.high:
            refuse(f"must not be below low: {self.high:g} against {self.low:g}", "high")
        if self.gives in ("factor", "percent"):
            refuse("a vector is a value or an offset", "gives")
        return self

    @property
    def ends(self) -> tuple[Any, ...]:
        """Along the axes."""
        x = self.high
        up = ([0.0, 0.0, x], [0.0, 0.0, -x]) if self.plane == "any" else ()
        return ([x, 0.0, 0.0], [-x, 0.0, 0.0], [0.0, x, 0.0], [0.0, -x, 0.0], *up)


AnyDistribution = Annotated[
    UniformBlock | NormalBlock | LogNormalBlock | IntegersBlock | ChoiceBlock | GridBlock | SobolBlock | DirectionBlock,
    Field(discriminator="distribution"),
]
