"""A sensor of one's own: the range to an acoustic beacon, by which dead reckoning is held.

A scenario flies on it with

    navigation:
      own:
        - {name: beacon, python: own_range.py:range_to, options: {place: [20, 0, -5]}, rate_hz: 1, noise: 0.1}

It answers the reading without its errors; rate, delay, noise and bias are the scenario's. The filter finds by itself
how the reading changes with the motion.

    python examples/own_range.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import cube_sim

HERE = Path(__file__).resolve().parent
FARTHEST = 500.0
"""Beyond, nothing is heard [m]."""


def range_to(place=(0.0, 0.0, 0.0), nearest=0.5):
    """The distance from the beacon [m]; None too near to tell, or too far to hear."""

    def reading(motion):
        distance = np.linalg.norm(motion.position - np.asarray(place))
        return distance if nearest < distance < FARTHEST else None

    return reading


def main() -> None:
    """Fly a helix by dead reckoning, and again with the ranges to three beacons around it."""
    beacons = [
        {
            "name": f"beacon_{number}",
            "python": f"{HERE / 'own_range.py'}:range_to",
            "options": {"place": place},
            "unit": "m",
            "noise": 0.1,
        }
        for number, place in enumerate(([20.0, 0.0, -5.0], [-10.0, 17.0, -5.0], [-10.0, -17.0, -8.0]))
    ]
    for own in ([], beacons):
        flight = cube_sim.Flight(
            HERE.parent / "scenarios" / "cube_navigated.yaml",
            {"navigation.position": None, "navigation.own": own, "checks": [{"kind": "allowed_forces"}]},
        )
        while not flight.over:
            flight.step()
        error = flight.signals["navigation_error.position"]
        off = np.linalg.norm(error[error[:, 0] >= 30.0, 1:], axis=1)
        print(f"{len(own)} beacons: the estimate is off by {np.sqrt(np.mean(off**2)):.2f} m RMS")


if __name__ == "__main__":
    main()
