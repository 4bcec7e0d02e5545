"""The `samples` block: what of a scenario is drawn anew for each of many flights, and from where."""

from __future__ import annotations

from math import prod
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator
from pydantic.types import Strict

from cube_sim.scenario.distribution_blocks import MOST_SAMPLES, AnyDistribution, GridBlock, Whole, at_least_one
from cube_sim.scenario.file_names import CodeName
from cube_sim.scenario.python_block import OPTIONS, Options
from cube_sim.scenario.values import Block, refuse

LOST_THRUSTERS = "lost_thrusters"
"""By which name a sample has the thrusters it loses."""


class LostThrustersBlock(Block):
    """Thrusters that die: in every combination, or in one that is drawn."""

    losses: Annotated[
        Whole,
        Field(min_length=1),
        BeforeValidator(at_least_one),
        WithJsonSchema(
            {
                "anyOf": [
                    {"type": "integer", "minimum": 0},
                    {"type": "array", "items": {"type": "integer", "minimum": 0}, "minItems": 1},
                ]
            }
        ),
    ] = Field(description="How many die in a sample: a number, or several: [1, 2] is every one and every two.")
    choose: Literal["all", "random"] = Field(
        default="all",
        description="all: each combination in turn, as of a grid; random: one of them for each sample, each as likely.",
    )
    thrusters: Annotated[tuple[str, ...], Strict(False)] | None = Field(
        default=None, min_length=1, description="Names of those that may die. Default: all that the vehicle has."
    )
    at_s: float = Field(default=0.0, ge=0, description="When they die [s].")
    until_s: float | None = Field(
        default=None, gt=0, description="They die at a moment drawn between at_s and this [s]. Default: at at_s."
    )

    @model_validator(mode="after")
    def _possible(self) -> LostThrustersBlock:
        if min(self.losses) < 0 or len(set(self.losses)) < len(self.losses):
            refuse("must be different whole numbers, each at least 0", "losses")
        if self.thrusters is not None and len(set(self.thrusters)) < len(self.thrusters):
            refuse("names a thruster twice", "thrusters")
        if self.thrusters is not None and max(self.losses) > len(self.thrusters):
            refuse(f"must be at most {len(self.thrusters)}, the number of thrusters named", "losses")
        if self.until_s is not None and self.until_s <= self.at_s:
            refuse(f"must be after at_s: {self.until_s:g} s against {self.at_s:g} s", "until_s")
        return self


class GeneratorBlock(Block):
    """A function of your own that says what sample k flies: `function(k, rng, **options)`.

    It gets the number of the sample and a numpy Generator of that sample's own, and returns a mapping of dotted paths
    to values, as `--set` takes them, or a pair: that mapping, and one of notes for the row. Without notes each value is
    a column of the row; with notes these are, `note.NAME`. What `vary` and `lost_thrusters` say comes on top.
    """

    python: CodeName = Field(
        description="The function: file.py:name, relative to the scenario file, or package.module:name."
    )
    options: Options = Field(default={}, description=OPTIONS)


class RequiredBlock(Block):
    """What share of all possible samples has to pass, and how sure the count of those flown must make one of it.

    Notes that a generator gives may say which samples count, and what each is held against.
    """

    pass_rate: float | None = Field(
        default=None, gt=0, lt=1, description="Least share of samples that pass. Default: every one flown has to."
    )
    confidence: float = Field(
        default=0.95,
        gt=0,
        lt=1,
        description="Of the one-sided Clopper-Pearson bound: 59 samples that all pass show 0.95 at 0.95, 299 show"
        " 0.99.",
    )
    where: dict[str, Any] = Field(
        default={}, description="Notes of the samples that count: {forecast: true}. Default: all count."
    )
    forecast: str | None = Field(
        default=None,
        description="Name of a note that is true or false: whether the sample should pass. What comes out as it says"
        " has passed, all else has failed. Default: every sample should pass.",
    )
    each: str | None = Field(
        default=None,
        description="Name of a note: samples with the same value of it count as one, which passes where all of them do,"
        " and should where all of them should. Default: each counts by itself.",
    )

    @model_validator(mode="after")
    def _plain(self) -> RequiredBlock:
        for name, value in self.where.items():
            if not isinstance(value, str | bool | int | float):
                refuse(f"must be a word, a number, true or false; got {value!r:.60}", "where", name)
        return self

    @property
    def foretelling(self) -> str | None:
        """Name of the note that says which samples should pass, whether the others count or not."""
        alone = list(self.where.values()) == [True]
        return self.forecast or (next(iter(self.where)) if alone else None)


class SamplesBlock(Block):
    """Many flights of this scenario, each with values of its own.

    `cube-sim sweep` flies all of them, `cube-sim run --sample k` one. What sample k flies depends on `seed`, on k and
    on the key that is varied: neither on the count nor on what else is varied.
    """

    count: int | None = Field(
        default=None,
        ge=1,
        le=MOST_SAMPLES,
        description="How many samples there are. Default: once through the grid and the combinations.",
    )
    seed: int = Field(default=0, ge=0, lt=2**63, description="Root of what is drawn here.")
    vary_seed: bool = Field(
        default=True,
        description="Whether each sample has a seed of its own for noise, drawn; false: all have the scenario's.",
    )
    vary: dict[str, AnyDistribution] = Field(
        default={},
        description="Dotted path of a key, as for --set, or parameters.NAME of anything that the model has -> where"
        " its values come from.",
    )
    lost_thrusters: LostThrustersBlock | None = Field(
        default=None, description="Thrusters that die, beside the events of the scenario. Default: none."
    )
    generator: GeneratorBlock | None = Field(
        default=None, description="Code of your own that says what a sample flies. Default: none."
    )
    required: RequiredBlock | None = Field(
        default=None, description="Pass rate that the samples must show. Default: every sample flown has to pass."
    )

    @property
    def counted(self) -> bool:
        """Whether it is their number that is judged: then one that fails is no failure."""
        required = self.required
        return required is not None and (required.pass_rate is not None or required.forecast is not None)

    @model_validator(mode="after")
    def _counted(self) -> SamplesBlock:
        grids = any(isinstance(each, GridBlock) for each in self.vary.values())
        combined = self.lost_thrusters is not None and self.lost_thrusters.choose == "all"
        if self.count is None and not grids and not combined:
            refuse("say how many samples there are: no grid and no combination does", "count")
        required = self.required
        if required is not None and self.generator is None:
            for key in ("where", "forecast", "each"):
                if getattr(required, key):
                    refuse("is about notes, which a generator gives: there is none", "required", key)
        sizes = [each.size for each in self.vary.values() if isinstance(each, GridBlock)]
        if self.count is None and prod(sizes) > MOST_SAMPLES:
            text = f"the grids have {prod(sizes)} points together, more than {MOST_SAMPLES} samples: give a count"
            refuse(text, "vary")
        for path in self.vary:
            outer = next((other for other in self.vary if path.startswith(f"{other}.")), None)
            if outer is not None:
                refuse(f"lies in {outer}, which is varied too: one of the two would be lost", "vary", path)
            if path.partition(".")[0] in ("samples", "schema_version"):
                refuse("is what the samples are made of, and not varied", "vary", path)
        return self
