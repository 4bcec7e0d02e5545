"""A flight in numbers, from rows that nobody keeps."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan

import numpy as np
from numpy.typing import NDArray

Signals = Mapping[str, NDArray[np.float64]]
CHANNELS = "pose", "velocity", "target", "path_error", "power", "allocation", "health"
"""That statistics are taken of."""


class FlightStatistics:
    """What `statistics_of` says of a flight whose rows come one part after another.

    It holds three numbers for each tick: means are those of all of them together, to the bit.
    """

    def __init__(self) -> None:
        self._cross_track: list[NDArray[np.float64]] = []
        self._off: list[NDArray[np.float64]] = []
        self._speed: list[NDArray[np.float64]] = []
        self._start, self._arc_length, self._energy, self._residual, self._lost = nan, nan, nan, -np.inf, 0

    def take(self, signals: Signals) -> None:
        """Take the next rows of all signals, in the order of time."""

        def column(name: str) -> NDArray[np.float64]:
            return signals[name][:, 1:]

        if not len(signals["pose.position"]):
            return
        if not self._speed:
            self._start = column("target.arc_length")[0, 0]
        self._cross_track.append(column("path_error.cross_track").ravel())
        self._off.append(column("path_error.attitude").ravel())
        self._speed.append(np.linalg.norm(column("velocity.linear"), axis=1))
        self._arc_length = column("target.arc_length")[-1, 0]
        self._energy = column("power.energy")[-1, 0] if "power.energy" in signals else nan
        self._residual = max(self._residual, column("allocation.residual").max())
        self._lost = np.count_nonzero(column("health.believed")[-1] == 0.0)

    def results(self) -> dict[str, float]:
        """See `statistics_of`."""
        if not self._speed:
            return dict.fromkeys(STATISTICS, nan)
        cross_track, off, speed = (np.concatenate(parts) for parts in (self._cross_track, self._off, self._speed))
        values = (
            _rms(cross_track),
            cross_track.max(),
            _rms(off),
            off.max(),
            speed.mean(),
            self._arc_length - self._start,
            self._energy,
            self._residual,
            self._lost,
        )
        return {name: float(value) for name, value in zip(STATISTICS, values, strict=True)}


def statistics_of(signals: Signals) -> dict[str, float]:
    """A flight in numbers, from its recorded signals; NaN where nothing was recorded.

    Returns:
        "cross_track_rms_m", "cross_track_max_m": distance from the path;
        "attitude_error_rms_rad", "attitude_error_max_rad": between desired and actual attitude;
        "speed_mean_m_s": over ground;
        "travelled_m": arc length that the target has run;
        "energy_J": drawn by the thrusters; NaN where the model does not state it;
        "residual_max_N": of the allocation;
        "thrusters_lost": believed dead or stuck at the end.
    """
    statistics = FlightStatistics()
    statistics.take(signals)
    return statistics.results()


STATISTICS = (
    "cross_track_rms_m",
    "cross_track_max_m",
    "attitude_error_rms_rad",
    "attitude_error_max_rad",
    "speed_mean_m_s",
    "travelled_m",
    "energy_J",
    "residual_max_N",
    "thrusters_lost",
)


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))
