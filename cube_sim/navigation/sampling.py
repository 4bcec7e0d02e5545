"""When a sensor takes a reading and when the reading arrives, in ticks of the control loop."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from cube_sim.native.compiled import compiled

_ROUNDING = 1e-9  # of a tick


@dataclass(frozen=True)
class Sampling:
    """A sensor's own clock; its first reading is taken at t = 0.

    Attributes:
        rate_hz: readings per second, at most one per tick.
        delay_s: from the instant of a reading to its arrival.
    """

    rate_hz: float
    delay_s: float = 0.0

    def tick_of(self, sample: int, period_s: float) -> int:
        """Tick of sample 0, 1, 2, ...: the first one not earlier than sample / rate_hz."""
        return int(tick_of_sample(sample, self.rate_hz, period_s))

    def delay_ticks(self, period_s: float) -> int:
        """Ticks from the sampling of a reading to the first tick at which it is there."""
        return ceil(self.delay_s / period_s - _ROUNDING)


@compiled
def tick_of_sample(sample, rate_hz, period_s):
    """See `Sampling.tick_of`."""
    return ceil(sample / (rate_hz * period_s) - _ROUNDING)
