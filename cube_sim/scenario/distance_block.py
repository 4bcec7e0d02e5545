"""The check of the distance between two vehicles, and the others that may be asked of several."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic.types import Strict

from cube_sim.scenario.check_blocks import (
    AlwaysCheckBlock,
    BeforeAfterCheckBlock,
    CheckBlock,
    EventuallyCheckBlock,
    RatioCheckBlock,
    SignalCheckBlock,
)
from cube_sim.scenario.statistic_keys import LimitKeys, StatisticKeys, statistic_alone
from cube_sim.scenario.values import refuse
from cube_sim.scenario.windows import WindowKeys

DISTANCE = "distance"
"""The channel of the distances between vehicles."""


class DistanceCheckBlock(WindowKeys, LimitKeys, StatisticKeys, CheckBlock):
    """One statistic of the distance between two vehicles against one limit.

    It is that between their body origins, as the signal distance.A_to_B has it.
    """

    kind: Literal["distance"]
    between: Annotated[tuple[str, str], Strict(False)] = Field(
        description="Names of the two vehicles, for example [leader, follower]."
    )

    @model_validator(mode="after")
    def _two(self) -> DistanceCheckBlock:
        if self.between[0] == self.between[1]:
            refuse("name two vehicles", "between")
        return self

    @property
    def title(self) -> str:
        """Name shown in results."""
        return self.name or f"{statistic_alone(self)} distance between {' and '.join(self.between)}"

    def of_signal(self, pairs: Sequence[tuple[str, str]]) -> SignalCheckBlock:
        """The same as a check of the recorded distance.

        Args:
            pairs: of vehicles, as they are recorded; this one may have them the other way round.
        """
        pair = next((pair for pair in pairs if set(pair) == set(self.between)), self.between)
        same = {key: getattr(self, key) for key in type(self).model_fields if key in SignalCheckBlock.model_fields}
        told = {"kind": "signal", "name": self.title, "signal": f"{DISTANCE}.{'_to_'.join(pair)}"}
        return SignalCheckBlock.model_construct(**{**same, **told})


AnyFleetCheck = Annotated[
    SignalCheckBlock
    | AlwaysCheckBlock
    | EventuallyCheckBlock
    | RatioCheckBlock
    | BeforeAfterCheckBlock
    | DistanceCheckBlock,
    Field(discriminator="kind"),
]
