"""Thrusters whose curves at several voltages, or torques, are known, at the voltage of the moment; compiled.

Commands, forces and k_P of two neighbouring voltages are joined by straight lines. Beyond the first and the last the
forces go with the square of the voltage.

A record of voltages: k, n, V_1..V_k [V], and for each of them k_P-, k_P+ [W/N^1.5], c_DZ-, c_DZ+, F_DZ-, F_DZ+ [N],
c_1..c_n, F_1..F_n [N].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.laws.propeller_power import power_of_propeller
from cube_sim.vehicle.laws.supply_law import open_voltage_at, total

HEAD = 6
"""Numbers of one voltage before its commands."""
HALVINGS = 50
"""Of the interval in which the voltage under load lies: to the last digit."""


class VoltageTables(NamedTuple):
    """The thrusters of a hull, and what of them follows the voltage.

    Attributes:
        known: (m,) whether a thruster's curves at several voltages are known.
        record_at: (m,) where in the model's own numbers its record of voltages begins.
        curve_at: (m,) where its curve's record begins there: c_DZ-, c_DZ+, F_DZ-, F_DZ+, n.
        points_at: how far behind that the commands begin.
        power_at: how far behind that k_P-, k_P+ stand.
        curves: table of `cube_sim.vehicle.laws.curve_table`, moved on like the next two.
        starts: (m,) of it.
        coefficients: (m,2) k_P-, k_P+ [W/N^1.5].
        limits: (m,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N].
    """

    known: NDArray[np.bool_]
    record_at: NDArray[np.int64]
    curve_at: NDArray[np.int64]
    points_at: int
    power_at: int
    curves: Vector
    starts: NDArray[np.int64]
    coefficients: Matrix
    limits: Matrix


@compiled
def neighbours(packed, record, voltage):
    """(place of the lower voltage's numbers, of the higher one's, share of the way between, scale of the forces)."""
    k, n = int(packed[record]), int(packed[record + 1])
    size, first = HEAD + 2 * n, record + 2 + k
    low = 0
    while low < k - 2 and packed[record + 2 + low + 1] <= voltage:
        low += 1
    V_low, V_high = packed[record + 2 + low], packed[record + 3 + low]
    inside = min(max(voltage, V_low), V_high)
    at = first + low * size
    scale = voltage / inside
    return at, at + size, (inside - V_low) / (V_high - V_low), scale * scale


@compiled
def mixed(packed, low, high, share, i):
    """The i-th number at a share of the way between two voltages."""
    return (1.0 - share) * packed[low + i] + share * packed[high + i]


@compiled
def force_at(packed, record, voltage, command):
    """Steady force [N] of a command at a voltage.

    Args:
        packed: the model's own numbers, see `cube_sim.vehicle.plugin.layout`.
        record: where in them the record of voltages begins.
        voltage: [V].
        command: after the motor's lag.
    """
    low, high, share, scale = neighbours(packed, record, voltage)
    if mixed(packed, low, high, share, 2) <= command <= mixed(packed, low, high, share, 3):
        return 0.0
    n = int(packed[record + 1])
    before, behind = 0, n - 1
    if command <= mixed(packed, low, high, share, HEAD):
        return scale * mixed(packed, low, high, share, HEAD + n)
    if command >= mixed(packed, low, high, share, HEAD + n - 1):
        return scale * mixed(packed, low, high, share, HEAD + 2 * n - 1)
    while behind - before > 1:
        middle = (before + behind) // 2
        if mixed(packed, low, high, share, HEAD + middle) <= command:
            before = middle
        else:
            behind = middle
    c_0, c_1 = mixed(packed, low, high, share, HEAD + before), mixed(packed, low, high, share, HEAD + behind)
    F_0 = mixed(packed, low, high, share, HEAD + n + before)
    F_1 = mixed(packed, low, high, share, HEAD + n + behind)
    return scale * (F_0 + (command - c_0) / (c_1 - c_0) * (F_1 - F_0))


@compiled
def power_at(packed, record, voltage, force):
    """Electrical power [W] of a force [N] at a voltage: k_P |F|^1.5; the other arguments as in `force_at`."""
    low, high, share, _ = neighbours(packed, record, voltage)
    return mixed(packed, low, high, share, 0 if force < 0.0 else 1) * abs(force) ** 1.5


@compiled
def put_voltage(packed, record, curve, points_at, power_at, voltage):
    """Write the curve of a voltage into a curve record.

    Args:
        packed: the model's own numbers.
        record: where the record of voltages begins.
        curve: where the curve record begins.
        points_at: of `VoltageTables`, like the next.
        power_at: of it.
        voltage: [V].
    """
    low, high, share, scale = neighbours(packed, record, voltage)
    n = int(packed[record + 1])
    for i in range(2):
        packed[curve + power_at + i] = mixed(packed, low, high, share, i)
        packed[curve + i] = mixed(packed, low, high, share, 2 + i)
        packed[curve + 2 + i] = scale * mixed(packed, low, high, share, 4 + i)
    for i in range(n):
        packed[curve + points_at + i] = mixed(packed, low, high, share, HEAD + i)
        packed[curve + points_at + n + i] = scale * mixed(packed, low, high, share, HEAD + n + i)


@compiled
def feed_tables(tables, packed, supply_at, voltage):
    """Let every thruster whose curves are known at several voltages have the one of this voltage [V].

    Args:
        tables: `VoltageTables`, moved on.
        packed: the model's own numbers, moved on.
        supply_at: (m,) where in them the shares of force are: all of it, but for a voltage of 0.
        voltage: [V].
    """
    for i in range(len(tables.known)):
        if not tables.known[i]:
            continue
        packed[supply_at[i]] = 1.0 if voltage > 0.0 else 0.0
        if voltage <= 0.0:
            continue
        curve, at = tables.curve_at[i], tables.starts[i]
        put_voltage(packed, tables.record_at[i], curve, tables.points_at, tables.power_at, voltage)
        n = int(packed[curve + 4])
        for j in range(4):
            tables.curves[at + j] = packed[curve + j]
        for j in range(2 * n):
            tables.curves[at + 7 + j] = packed[curve + tables.points_at + j]
        tables.coefficients[i, 0] = packed[curve + tables.power_at]
        tables.coefficients[i, 1] = packed[curve + tables.power_at + 1]
        tables.limits[i, 0], tables.limits[i, 3] = tables.curves[at + 7 + n], tables.curves[at + 7 + 2 * n - 1]
        tables.limits[i, 1], tables.limits[i, 2] = packed[curve + 2], packed[curve + 3]


@compiled
def draws_at(tables, driven, packed, efficiency_at, stuck_at, activations, drawn, before, nominal, voltage):
    """Electrical power of all thrusters at a voltage [W], turning as they do.

    Args:
        tables: `VoltageTables`.
        driven: `cube_sim.vehicle.laws.propeller_power.DrivenPropellers`, felt.
        packed: the model's own numbers.
        efficiency_at: (m,) where in them the efficiencies are.
        stuck_at: (m,) where the forces of stuck thrusters are.
        activations: MuJoCo's.
        drawn: (m,) what each draws at the voltage before [W]: with its cube, where neither curves nor torques tell.
        before: that voltage [V].
        nominal: that of the characteristics [V].
        voltage: [V].
    """
    power, ratio = np.empty(len(drawn)), voltage / nominal
    for i in range(len(drawn)):
        if driven.draws[i]:
            health = packed[efficiency_at[i]], packed[stuck_at[i]]
            power[i] = power_of_propeller(driven, i, activations, health[0], health[1], ratio * ratio)
            continue
        if not tables.known[i]:
            power[i] = drawn[i] * (voltage / before) ** 3
            continue
        force = packed[stuck_at[i]]
        if np.isnan(force):
            force = (
                force_at(packed, tables.record_at[i], voltage, activations[driven.states[i]])
                if packed[efficiency_at[i]] > 0.0
                else 0.0
            )
        power[i] = power_at(packed, tables.record_at[i], voltage, force)
    return total(power)


@compiled
def searched_voltage(supply, tables, driven, packed, efficiency_at, stuck_at, activations, drawn):
    """The voltage V [V] at which battery and thrusters agree: V = E - R P(V) / V; arguments as in `draws_at`.

    Its left side grows with V, its right side falls as long as P grows with V faster than V does: the interval is
    halved down to the last digit.

    Args:
        supply: record `cube_sim.vehicle.laws.supply_law.SUPPLY`; its charge is above 0.
        tables: of `draws_at`, like all that follow.
        driven: of it.
        packed: of it.
        efficiency_at: of it.
        stuck_at: of it.
        activations: of it.
        drawn: of it.
    """
    s = supply[0]
    E = open_voltage_at(s.full, s.lowest, s.charge)
    low, high = 0.0, E
    for _ in range(HALVINGS):
        V = 0.5 * (low + high)
        power = draws_at(tables, driven, packed, efficiency_at, stuck_at, activations, drawn, s.voltage, s.nominal, V)
        if E * V - s.resistance * power > V * V:
            low = V
        else:
            high = V
    return high
