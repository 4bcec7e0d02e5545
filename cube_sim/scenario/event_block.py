"""What every block of the `events` list has."""

from __future__ import annotations

from pydantic import Field

from cube_sim.scenario.titled_block import TitledBlock


class EventBlock(TitledBlock):
    """What every event has."""

    at_s: float = Field(ge=0, le=86400, description="When it happens [s].")

    @property
    def message(self) -> str:
        """What the log of a flight says of it."""
        return self.title

    @property
    def ends(self) -> tuple[float, str] | None:
        """When it is over by itself [s], and what the log says then; None where it lasts."""
        return None
