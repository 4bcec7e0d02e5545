"""A desired speed that is lowered where a planar hull cannot turn as its path does."""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from cube_sim.guidance.speed import Parts, Speed, SpeedProfile, speed_at
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record

SLOWEST = np.dtype([("slowest", np.float64)])
"""The speed that every curve allows [m/s], infinite where none has to be lowered."""


class TurningSpeed:
    """A profile lowered to what a hull can keep: planned round its curves, or as slow as its slowest curve asks.

    Args:
        wanted: before.
        planned: nowhere faster than what its curve allows.
        slowest: a speed that every curve allows [m/s].
    """

    def __init__(self, wanted: SpeedProfile, planned: SpeedProfile, slowest: float) -> None:
        self.wanted, self.planned, self.slowest = wanted, planned, slowest

    @property
    def least(self) -> float:
        """The lowest speed anywhere [m/s]."""
        return max(self.planned.least, min(self.wanted.least, self.slowest))

    @property
    def most(self) -> float:
        """The highest speed anywhere [m/s]."""
        return max(self.planned.most, min(self.wanted.most, self.slowest))

    def at(self, s: float) -> Speed:
        """The speed at arc length s [m]: the higher one of the two, both of which can be flown."""
        return Speed(*turning_speed_at(TurningParts.of(self), s))


class TurningParts(NamedTuple):
    """A profile as the planar law reads it.

    Attributes:
        slowest: record `SLOWEST`.
        wanted: of the profile before it is lowered.
        planned: of the planned one; the same where nothing is lowered.
    """

    slowest: Record
    wanted: Parts
    planned: Parts

    @staticmethod
    def of(profile: SpeedProfile) -> TurningParts:
        """Those of a `TurningSpeed`, or of any other profile that has `parts`."""
        if isinstance(profile, TurningSpeed):
            slowest, both = profile.slowest, (profile.wanted, profile.planned)
        else:
            slowest, both = inf, (profile, profile)
        wanted, planned = (one.parts for one in both)  # type: ignore[attr-defined]
        return TurningParts(np.array([(slowest,)], SLOWEST), wanted, planned)


@compiled
def turning_speed_at(parts, s):
    """The speed [m/s] at arc length s [m] and its slope [1/s]; `parts` are `TurningParts`."""
    slowest = parts.slowest[0].slowest
    value, slope = speed_at(*parts.wanted, s)
    if value > slowest:
        value, slope = slowest, 0.0
    planned, planned_slope = speed_at(*parts.planned, s)
    if planned >= value:
        return planned, planned_slope
    return value, slope
