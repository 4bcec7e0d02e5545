"""One reading of an aiding sensor, from the tick at which it is taken to what the filter made of it."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from cube_sim.spatial import Vector

NONE, UNDER_WAY, ARRIVED = range(3)
"""Where a reading is: there is none, it is taken but not there yet, it is there."""

READING = np.dtype(
    [
        ("aid", np.int64),
        ("tick", np.int64),
        ("whereabouts", np.int64),
        ("value", np.float64, 3),
        ("innovation", np.float64, 3),
        ("nis", np.float64),
        ("outcome", np.int64),
    ]
)
"""Index of the sensor, the tick at which it looked, where the reading is, and the attributes of `Fusion`; of value and
innovation the first n numbers count."""

FUSED, REJECTED, ACCEPTED_AFTER_REJECTIONS = range(3)
"""`ReadingOutcome`, for compiled laws."""


class ReadingOutcome(IntEnum):
    """What became of a reading."""

    FUSED = FUSED
    REJECTED = REJECTED
    ACCEPTED_AFTER_REJECTIONS = ACCEPTED_AFTER_REJECTIONS
    """Fused after its predecessors, which agree, were rejected; the covariance of what it reads was inflated."""


class Reading(NamedTuple):
    """One reading of an aiding sensor.

    Attributes:
        aid: index of the sensor.
        tick: at which it was taken.
        value: (n,).
    """

    aid: int
    tick: int
    value: Vector


class Fusion(NamedTuple):
    """A reading and what the filter made of it.

    Attributes:
        reading: the reading.
        innovation: (n,) the reading less the one expected by the estimate of its instant.
        nis: normalised innovation squared y' S^-1 y; y the innovation, S its covariance.
        outcome: fused or not.
    """

    reading: Reading
    innovation: Vector
    nis: float
    outcome: ReadingOutcome


def fusion_of(record: np.void, components: int) -> Fusion:
    """An element of `READING` whose reading has arrived, n numbers in it; a copy."""
    value, innovation = record["value"][:components].copy(), record["innovation"][:components].copy()
    reading = Reading(int(record["aid"]), int(record["tick"]), value)
    return Fusion(reading, innovation, float(record["nis"]), ReadingOutcome(int(record["outcome"])))
