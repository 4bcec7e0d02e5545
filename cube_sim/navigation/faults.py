"""What can be wrong with a sensor beyond the errors it is stated to have, and what that makes of its readings."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from statistics import NormalDist
from typing import Any

import numpy as np

from cube_sim.native.compiled import inlined
from cube_sim.navigation.imu import INERTIAL
from cube_sim.spatial import Record

FAULT = np.dtype(
    [
        ("lost", np.bool_),
        ("upright", np.float64),
        ("deepest", np.float64),
        ("shallowest", np.float64),
        ("zeros", np.bool_),
        ("frozen", np.bool_),
        ("given", np.bool_),
        ("last", np.float64, INERTIAL),
        ("late", np.int64),
        ("outlier_below", np.float64),
        ("size", np.float64),
        ("offset", np.float64, 6),
        ("row", np.int64),
    ]
)
"""The faults of one sensor, the inertial unit or another; `HEALTHY` has those of none.

Whether it gives no readings; or none while the vertical's share of the body's z axis is less than `upright`, or while
it is deeper or less deep than two depths [m]; whether it reads zeros; whether it repeats its last reading, whether
there is one, and that; by how many ticks its readings are older than it says; the standard normal number below which
a reading is an outlier, and the standard deviation of what that is off by; what is added to a reading; and which row of
the random numbers its outliers take, -1 for none.
"""
HEALTHY: dict[str, Any] = {
    "lost": False,
    "upright": -inf,
    "deepest": inf,
    "shallowest": -inf,
    "zeros": False,
    "frozen": False,
    "late": 0,
    "outlier_below": -inf,
    "size": 0.0,
    "offset": 0.0,
}
"""The fields of `FAULT` that faults change."""


class SensorFaults:
    """The faults of a vehicle's sensors, changed while it flies.

    Args:
        sensors: names of the sensors, "imu" first.
        latest: ticks by which readings may be older than they say, at most.
        outliers: names of the sensors whose readings may be outliers.

    Attributes:
        sensors: the same.
        latest: the same.
        outliers: the same, in the order of the sensors.
        records: (1 + k,) of `FAULT`.
    """

    def __init__(self, sensors: Sequence[str], latest: int = 0, outliers: Sequence[str] = ()) -> None:
        self.sensors, self.latest = tuple(sensors), latest
        self.outliers = tuple(name for name in self.sensors if name in outliers)
        self.records: Record = np.zeros(len(self.sensors), FAULT)
        self.records["row"] = [
            len(self.sensors) + self.outliers.index(name) if name in self.outliers else -1 for name in self.sensors
        ]
        for name in self.sensors:
            self.recover(name)

    def change(self, sensor: str, fields: dict[str, Any]) -> None:
        """Give a sensor faults: fields of `FAULT` and their values."""
        record = self.records[self.sensors.index(sensor)]
        for name, value in fields.items():
            record[name] = value

    def recover(self, sensor: str) -> None:
        """Let a sensor be whole again."""
        self.change(sensor, HEALTHY)


def outlier_below(share: float) -> float:
    """The standard normal number below which a share of such numbers lies."""
    return inf if share >= 1.0 else NormalDist().inv_cdf(share)


@inlined
def is_lost(fault, height, upright):
    """Whether a sensor gives no reading.

    Args:
        fault: element of `FAULT`.
        height: true z of the body origin [m].
        upright: true vertical's share of the body's z axis.
    """
    return fault.lost or upright < fault.upright or -height > fault.deepest or -height < fault.shallowest


@inlined
def spoil(fault, value, n, normals):
    """What the faults of a sensor make of a reading.

    Args:
        fault: element of `FAULT`; its last reading is kept.
        value: (n,) or more, changed.
        n: numbers in it.
        normals: `cube_sim.navigation.normals.Normals`, moved on where outliers are.
    """
    if fault.row >= 0:
        first = normals.used[fault.row]
        if normals.values[fault.row, first] < fault.outlier_below:
            for j in range(n):
                value[j] += fault.size * normals.values[fault.row, first + 1 + j]
        normals.used[fault.row] = first + 1 + n
    for j in range(n):
        value[j] += fault.offset[j % 6]  # of the inertial unit's nine numbers the last are rates like the first
        if fault.frozen and fault.given:
            value[j] = fault.last[j]
        if fault.zeros:
            value[j] = 0.0
        fault.last[j] = value[j]
    fault.given = True
