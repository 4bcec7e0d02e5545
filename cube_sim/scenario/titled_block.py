"""What a block has that readers are told of by a title: an event, a condition that ends a run."""

from __future__ import annotations

from pydantic import Field

from cube_sim.scenario.values import Block, Title


class TitledBlock(Block):
    """Each also has a `what`: the same in words."""

    name: Title | None = Field(default=None, description="Shown where it is told of. Default: what it is, in words.")

    @property
    def what(self) -> str:
        """What it is, for readers."""
        raise NotImplementedError

    @property
    def title(self) -> str:
        """What it is, for readers, after the name that the scenario gives it."""
        return self.what if self.name is None else f"{self.name}: {self.what}"
