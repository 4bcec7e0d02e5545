"""The gate against outliers: which readings the filter does not believe, and when it doubts itself instead."""

from __future__ import annotations

FALSE_ALARM_PROBABILITY = 1e-4
"""Share of the readings of a sensor as good as stated that the gate rejects."""
GATES = {1: 15.136705226623397, 2: 18.420680743952364, 3: 21.10751346616021}
"""The NIS beyond which a reading of n components is rejected: chi-square of n degrees of freedom exceeds it with that
probability. Numbers, as the library that knows this distribution takes longer to load than a run to prepare."""
MAX_REJECTIONS = 3
"""Readings of a sensor rejected in a row after which the estimate is doubted, not the sensor."""
