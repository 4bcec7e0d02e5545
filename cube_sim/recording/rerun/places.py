"""Where in a Rerun recording the parts of a run are: entity paths, all below one prefix."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Places:
    """Entity paths of one run.

    Attributes:
        prefix: in front of every path; "" where the recording holds one run.
    """

    prefix: str = ""

    def at(self, place: str) -> str:
        """The entity of a place that is named without the prefix."""
        return self.prefix + place

    @property
    def world(self) -> str:
        """What is seen in 3-D, in world axes."""
        return self.at("/world")

    @property
    def surface(self) -> str:
        """The sea surface."""
        return f"{self.world}/surface"

    @property
    def vehicle(self) -> str:
        """The hull, in body axes."""
        return f"{self.world}/vehicle"

    @property
    def thrusters(self) -> str:
        """Where the thrusters sit."""
        return f"{self.vehicle}/thrusters"

    @property
    def thrust(self) -> str:
        """Their forces."""
        return f"{self.vehicle}/thrust"

    @property
    def path(self) -> str:
        """The path to follow."""
        return f"{self.world}/path"

    @property
    def trail(self) -> str:
        """Where the vehicle was."""
        return f"{self.world}/trail"

    @property
    def estimate(self) -> str:
        """Where the filter thinks the vehicle is."""
        return f"{self.world}/estimate"

    @property
    def estimate_trail(self) -> str:
        """Where it thought it was."""
        return f"{self.estimate}/trail"

    @property
    def fixes(self) -> str:
        """Position fixes as read."""
        return f"{self.estimate}/fixes"

    @property
    def target(self) -> str:
        """The virtual target, in path axes."""
        return f"{self.world}/target"

    @property
    def current(self) -> str:
        """The current, at the vehicle."""
        return f"{self.world}/current"

    @property
    def log(self) -> str:
        """What was said."""
        return self.at("/log")

    @property
    def scenario(self) -> str:
        """The scenario in a few lines."""
        return self.at("/scenario")
