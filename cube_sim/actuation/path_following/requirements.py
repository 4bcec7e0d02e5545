"""What a vehicle must be able to do to follow paths; every figure is a choice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.errors import ActuationError

SPEEDS_M_S = (0.001, 100.0)
"""Between these speeds [m/s] a course can be judged: below, hardly anything but round-off damps."""

ASLANT_RAD = 0.6
"""Farther than this from the flow a hull is not steered by its fins as it is straight ahead (a choice)."""


@dataclass(frozen=True)
class PathRequirements:
    """What the verdict asks for; every figure is a choice.

    Attributes:
        speed_m_s: speed over the course.
        inclinations_rad: angles of the courses above the horizontal. They count in 3-D only; in the plane it is 0.
        horizon_s: the time a side step may take.
        side_step_m: displacement that must be made good to either side of the course, in 3-D also up and down.
        most_turn_rad: largest rotation about each body axis on the way.
        nose_ahead: whether only attitudes count in which the flow comes from ahead, within `ASLANT_RAD`: fins.
    """

    speed_m_s: float = 0.3
    inclinations_rad: tuple[float, ...] = (float(np.radians(-15.0)), 0.0, float(np.radians(15.0)))
    horizon_s: float = 20.0
    side_step_m: float = 0.5
    most_turn_rad: float = float(np.radians(30.0))
    nose_ahead: bool = False

    def check(self) -> None:
        """Refuse requirements that make no sense.

        Raises:
            ActuationError: saying which figure, and what it should be.
        """
        low, high = SPEEDS_M_S
        if not low <= self.speed_m_s <= high:
            raise ActuationError(
                f"the required speed is {self.speed_m_s:g} m/s; it can be judged between {low:g} and {high:g} m/s"
            )
        for name in ("horizon_s", "side_step_m", "most_turn_rad"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise ActuationError(f"the required {name} is {value:g}; it must be positive")
        if not self.inclinations_rad or not np.all(np.abs(self.inclinations_rad) <= np.pi / 2.0):
            raise ActuationError(
                f"the required inclinations_rad are {self.inclinations_rad}; they must be angles of at most 90 degrees"
            )
