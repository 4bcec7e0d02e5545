"""The gate against outliers: which readings the filter does not believe, and when it doubts itself instead."""

from __future__ import annotations

FALSE_ALARM_PROBABILITY = 1e-4
"""Share of the readings of a sensor as good as stated that the gate rejects."""
GATES = {1: 15.136705226623397, 2: 18.420680743952364, 3: 21.10751346616021}
"""The NIS beyond which a reading of n components is rejected: chi-square of n degrees of freedom exceeds it with that
probability. Numbers, as the library that knows this distribution takes longer to load than a run to prepare."""
MAX_REJECTIONS = 3
"""Readings of a sensor rejected in a row, in agreement, after which the estimate is doubted, not the sensor."""
MOST_DOUBTS = 8
"""Times the variances of an estimate in doubt are raised further before the reading is rejected all the same."""
AGREEMENT = 1.0 / 3.0
"""Two rejected readings in a row agree when what they say beyond the estimate differs by this share of the larger."""
DOUBTED_TILT, DOUBTED_SPEED = 0.05, 1.0
"""What an estimate in doubt is doubted by at most where a sensor sees it only through another quantity: standard
deviations of the attitude [rad] for one of velocity or position, of the velocity [m/s] for one of position."""
FREE_FALL = 0.5
"""Specific force below which an inertial unit is dead [m/s^2]: nothing under water falls as it would in a vacuum."""
UNKNOWN_RATE, UNKNOWN_ACCELERATION = 0.1, 0.5
"""What is added to the motion while it is, as noise [rad/s/sqrt(Hz), m/s^2/sqrt(Hz)]: some turning, some thrust."""
FASTEST = 30.0
"""No vehicle under water goes faster [m/s]: what the filter holds its velocity to, whatever its sensors say."""
