"""What every block of the `events` list has."""

from __future__ import annotations

from pydantic import Field

from cube_sim.scenario.values import Block, Title


class EventBlock(Block):
    """What every event has; each also has a `what`: what happens, in words."""

    name: Title | None = Field(default=None, description="Shown where the event is told. Default: what happens.")
    at_s: float = Field(ge=0, le=86400, description="When it happens [s].")

    @property
    def what(self) -> str:
        """What happens, for readers."""
        raise NotImplementedError

    @property
    def title(self) -> str:
        """What happens, for readers, after the name that the scenario gives it."""
        return self.what if self.name is None else f"{self.name}: {self.what}"

    @property
    def message(self) -> str:
        """What the log of a flight says of it."""
        return self.title

    @property
    def ends(self) -> tuple[float, str] | None:
        """When it is over by itself [s], and what the log says then; None where it lasts."""
        return None
