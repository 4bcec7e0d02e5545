"""How a wrench becomes thruster forces: the `allocation` block of a scenario file."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field, field_validator
from pydantic.types import Strict
from pydantic_core.core_schema import ValidationInfo

from cube_sim.allocation.options import WEIGHTS_SPAN, BaselineMethod, Method, Objective, Unattainable
from cube_sim.scenario.python_block import NAME, NAMED_OR_OWN, OwnPython, PythonBlock
from cube_sim.scenario.values import Block, refuse

Force = Annotated[float, Field(ge=-1e6, le=1e6)]
Weight = Annotated[float, Field(ge=1 / WEIGHTS_SPAN, le=WEIGHTS_SPAN)]
Penalty = Annotated[float, Field(ge=0, le=1e12)]


MethodName = Literal[Method, BaselineMethod]
AnyMethod = Annotated[Annotated[MethodName, NAME] | OwnPython, NAMED_OR_OWN]


class AllocationBlock(Block):
    """How a wrench becomes thruster forces."""

    method: AnyMethod = Field(
        default="search+proxqp",
        description="Exact: search+proxqp (a search picks the subset, one ProxQP solves it), search, enumerate (one "
        f"ProxQP per subset), enumerate_parallel. To compare with: {', '.join(get_args(BaselineMethod))}; these do not "
        "know whether a wrench is attainable, refuse an objective but energy, and leave weights, penalties, the change "
        "limit and `unattainable` aside: a scenario compares them by this key. So does code of your own.",
    )
    allow_off: bool = Field(default=True, description="Whether a thruster may rest at 0 N, inside its dead zone.")
    objective: Objective = Field(
        default="energy",
        description="What decides among exact allocations. energy: |f|^2. target: closeness to "
        "target_N. reactivity: closeness to the steepest point "
        "of the characteristic, all thrusters forward or all reverse. reactivity_by_side: each on its own side.",
    )
    target_N: Annotated[tuple[Force, ...], Strict(False)] | None = Field(  # noqa: N815 - N is the newton
        default=None,
        description="Preferred force of each thruster [N], in the model's order; for the objective target only.",
    )
    thruster_weights: Annotated[tuple[Weight, ...], Strict(False)] | None = Field(
        default=None,
        description="Weight of each thruster's squared force in the objective, in the model's order. Default: all 1.",
    )
    torque_weight: float = Field(
        default=30.0,
        ge=1e-6,
        le=1e6,
        description="Weight of torque against force errors when the wrench is unattainable.",
    )
    unattainable: Unattainable = Field(
        default="closest",
        description="What is made of an unattainable wrench. closest: the closest attainable one. scaled: the largest "
        "attainable part of it in its own direction, and the closest one where dead zones leave nothing of it.",
    )
    dead_zone_margin: float = Field(
        default=0.1,
        ge=0,
        le=1,
        description="Share of F_DZ by which allocated forces stay clear of the dead zone: a lagging motor commanded "
        "onto its very edge would never start.",
    )
    reversal_penalty_N2: Penalty = Field(  # noqa: N815 - N is the newton
        default=0.0,
        description="Cost of one thruster changing side [N^2], divided by the seconds for which it has kept its side, "
        "one at least. A change that saves s N^2 of the objective for good is so made after penalty / s seconds, and "
        "at once where s is more than the penalty.",
    )
    switching_penalty_N2: Penalty = Field(  # noqa: N815 - N is the newton
        default=0.0,
        description="Cost of one thruster starting from rest or coming to rest [N^2], divided likewise.",
    )
    change_limit_N: float | None = Field(  # noqa: N815 - N is the newton
        default=None,
        gt=0,
        le=1e12,
        description="Most a thruster's force may change in one control period, its dead zone not counted [N]. A wrench"
        " that takes several periods is approached so that it takes the fewest. Default: no limit.",
    )

    @field_validator("objective")
    @classmethod
    def _known_to_method(cls, objective: str, info: ValidationInfo) -> str:
        method = info.data.get("method", "search")
        if objective != "energy" and isinstance(method, PythonBlock):
            refuse("code of your own is told of no objective: leave it out")
        if objective != "energy" and method in get_args(BaselineMethod):
            refuse(f"{method} knows no objective but energy")
        return objective

    @field_validator("target_N")
    @classmethod
    def _goes_with_its_objective(cls, target_N: tuple[float, ...] | None, info: ValidationInfo) -> object:
        objective = info.data.get("objective")
        if objective == "target" and target_N is None:
            refuse("the objective target needs a preferred force per thruster, for example [5, 5, -5, -5]")
        if objective not in (None, "target") and target_N is not None:
            refuse(f"the objective {objective} has no target; give objective: target")
        return target_N

    @field_validator("thruster_weights")
    @classmethod
    def _can_be_told_apart(cls, weights: tuple[float, ...] | None) -> object:
        if weights and max(weights) > WEIGHTS_SPAN * min(weights):
            refuse(f"spans {min(weights):g} to {max(weights):g}; a ratio of {WEIGHTS_SPAN:g} at most is solvable")
        return weights
