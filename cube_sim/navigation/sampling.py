"""When a sensor looks and when its reading is there, in ticks of the control loop."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

_ROUNDING = 1e-9  # of a tick


@dataclass(frozen=True)
class Sampling:
    """A sensor's own clock; it looks for the first time at t = 0.

    Attributes:
        rate_hz: readings per second, at most one per tick.
        delay_s: from the instant of a reading to its arrival.
    """

    rate_hz: float
    delay_s: float = 0.0

    def tick_of(self, look: int, period_s: float) -> int:
        """Tick of a look 0, 1, 2, ...: the first one not earlier than look / rate_hz."""
        return ceil(look / (self.rate_hz * period_s) - _ROUNDING)

    def delay_ticks(self, period_s: float) -> int:
        """Ticks from a look to the first tick at which its reading is there."""
        return ceil(self.delay_s / period_s - _ROUNDING)
