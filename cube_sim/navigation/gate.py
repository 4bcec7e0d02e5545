"""The gate against outliers: which readings the filter does not believe, and when it doubts itself instead."""

from __future__ import annotations

from scipy.special import chdtri

FALSE_ALARM_PROBABILITY = 1e-4
"""Share of the readings of a sensor as good as stated that the gate rejects."""
GATES = {n: float(chdtri(n, FALSE_ALARM_PROBABILITY)) for n in (1, 2, 3)}
"""The NIS beyond which a reading of n components is rejected, from the chi-square distribution."""
MAX_REJECTIONS = 3
"""Readings of a sensor rejected in a row after which the estimate is doubted, not the sensor."""
