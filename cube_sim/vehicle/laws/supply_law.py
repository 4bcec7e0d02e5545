"""What feeds the thrusters of a hull, and what they draw, compiled; `cube_sim.vehicle.power_supply` explains it."""

from __future__ import annotations

from math import sqrt

import numpy as np

from cube_sim.native.compiled import compiled

SUPPLY = np.dtype(
    [
        ("battery", np.bool_),
        *(
            (name, np.float64)
            for name in (
                "nominal",
                "full",
                "lowest",
                "resistance",
                "capacity",
                "voltage",
                "force_ratio",
                "charge",
                "energy",
                "counted_to",
                "drain",
            )
        ),
    ]
)
"""A `PowerSupply`: whether it is a battery, the voltage of the characteristics [V], a `Battery` [V, V, ohm, J].

What changes: voltage [V], share of the force, charge, energy [J], the time up to which it is counted [s], NaN at first,
and the power that the cells lose [W]."""


@compiled
def open_voltage_at(full, lowest, charge):
    """E [V] at a charge between 0, empty, and 1, full."""
    return lowest + charge * (full - lowest)


@compiled
def sagging_voltage(E, resistance, propellers):
    """The positive root V [V] of V = E - R k V^2; E [V], R [ohm], k [A/V^2]."""
    return 2.0 * E / (1.0 + sqrt(1.0 + 4.0 * resistance * propellers * E))


@compiled
def drain_of_cells(resistance, power, voltage):
    """P + R I^2 [W], I = P / V; P [W], V [V]."""
    if power <= 0.0:
        return 0.0
    current = power / voltage
    return power + resistance * current * current


@compiled
def total(power):
    """The sum of (m,) [W]."""
    result = 0.0
    for value in power:
        result += value
    return result


@compiled
def charge_left(supply, time):
    """The charge at a time [s]: less what the cells have lost since it was counted last, at that rate."""
    s = supply[0]
    if np.isnan(s.counted_to):
        return s.charge
    return max(0.0, s.charge - s.drain * (time - s.counted_to) / s.capacity)


@compiled
def feed_at(supply, packed, supply_at, voltage):
    """Feed the thrusters with a voltage [V]; `packed` and where in it their supplies (m,) are, is the model's."""
    s = supply[0]
    ratio = voltage / s.nominal
    s.voltage, s.force_ratio = voltage, ratio * ratio
    for at in supply_at:
        packed[at] = s.force_ratio


@compiled
def sag(supply, packed, supply_at, power):
    """Feed the thrusters with the voltage at which battery and propellers agree, each at its present speed per volt.

    Args:
        supply: record `SUPPLY`, moved on; its charge and its share of the force are above 0.
        packed: of `feed_at`, like the next.
        supply_at: of it.
        power: (m,) drawn now [W].
    """
    s = supply[0]
    at_nominal = total(power) / s.force_ratio**1.5
    E = open_voltage_at(s.full, s.lowest, s.charge)
    feed_at(supply, packed, supply_at, sagging_voltage(E, s.resistance, at_nominal / s.nominal**3))


@compiled
def count(supply, before, now, time):
    """Count what is drawn up to a time [s], by the trapezoidal rule.

    Args:
        supply: record `SUPPLY`, moved on.
        before: (m,) power when it was counted last [W].
        now: (m,) power now [W].
        time: [s].
    """
    s = supply[0]
    if not np.isnan(s.counted_to):
        both = 0.0
        for i in range(len(now)):
            both += before[i] + now[i]
        s.energy += 0.5 * both * (time - s.counted_to)
    s.counted_to = time
    if s.battery and s.force_ratio > 0.0:
        s.drain = drain_of_cells(s.resistance, total(now), s.voltage)
