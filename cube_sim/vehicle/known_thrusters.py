"""Thrusters known by name: their published curves, at any voltage between those they were published at.

The numbers stand in known_thrusters.csv, with their source. Between two voltages force is interpolated at the same
share of the way from first thrust to full throttle, and so are the pulse widths of first thrust: thrust depends less on
voltage than the square of it, and the published tables say how.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from cube_sim.errors import ModelError
from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.thruster_tables import FULL_US, REST_US, Tables, read_tables

_FILE = Path(__file__).with_name("known_thrusters.csv")
NEWTONS_IN_KGF = 9.80665
LAG_S = 0.02
"""63 % of a T200's response (von Benzon et al. 2022, JMSE 10(12):1898); for others a choice."""
LIKE = "T200", 16.0
"""Whose curve gives the shape where only full throttle is published, and below the lowest row of a table that begins at
much throttle."""
LOWEST = 0.2
"""Command of the lowest row up to which that row counts as first thrust (a choice; a T200's is 0.08)."""


@dataclass(frozen=True)
class KnownThruster:
    """A thruster at a voltage, as an MJCF describes one.

    Attributes:
        name: of its type.
        voltage: [V].
        commands: (n,) from -1 to 1, (pulse width - 1500 us) / 400 us.
        forces: (n,) [N], never decreasing; 0 in the dead zone.
        force_dead_zone: (F_DZ-, F_DZ+), first thrusts [N].
        power: (k_P-, k_P+) of the electrical power k_P |F|^1.5 [W/N^1.5], least squares; None where it is not known.
        lag_s: time constant of its motor [s].
        source: of the numbers, and what is an estimate, in words.
        remarks: what its owner should know.
    """

    name: str
    voltage: float
    commands: Vector
    forces: Vector
    force_dead_zone: tuple[float, float]
    power: tuple[float, float] | None
    lag_s: float
    source: str
    remarks: tuple[str, ...] = ()


def known_thruster(name: str, voltage: float | None = None, tables: Tables | None = None) -> KnownThruster:
    """A thruster by the name of its type.

    Args:
        name: one of `known_names`, in any case.
        voltage: [V]; None for 16.
        tables: of thrusters of your own, see `read_tables`, looked at before the published ones.

    Raises:
        ModelError: no such thruster, or none at that voltage.
    """
    own = name.upper() in (tables or {})
    by_voltage = (tables or {}).get(name.upper()) or published().get(name.upper())
    if by_voltage is None:
        raise ModelError(name, f"is no thruster that is known by name; {', '.join(known_names(tables))} are")
    voltages = sorted(by_voltage)
    volts = 16.0 if voltage is None else voltage
    if not voltages[0] <= volts <= voltages[-1]:
        there = f"from {voltages[0]:g} to {voltages[-1]:g} V" if len(voltages) > 1 else f"at {voltages[0]:g} V alone"
        raise ModelError(
            name, f"has tables {there}, not at {volts:g}; take such a voltage, or give a curve of your own"
        )
    below, above = max(v for v in voltages if v <= volts), min(v for v in voltages if v >= volts)
    share = (volts - below) / (above - below) if above > below else 0.0
    source = f"{name.upper()} at {volts:g} V, " + (
        "tables of one's own" if own else "published tables (cube_sim/vehicle/known_thrusters.csv)"
    )
    if above > below:
        source += f", interpolated between {below:g} and {above:g} V"
    sides, remarks, alone = [], [], True
    for reverse in (True, False):
        low, high = (_side(by_voltage[v], reverse) for v in (below, above))
        side = _between(low, high, share)
        lowest = side[-1 if reverse else 0, 0]
        alone = alone and len(side) == 1
        rests = len(side) > 1 and any(_rests(by_voltage[v], reverse) for v in (below, above))
        if abs(lowest) > LOWEST and not rests:
            if len(side) > 1:
                remarks.append(
                    f"{name.upper()} at {volts:g} V: {'back' if reverse else 'ahead'}, its table begins at "
                    f"{REST_US + FULL_US * lowest:g} us; nearer to rest the curve has the shape of a {LIKE[0]}'s "
                    "(estimate), first thrust as well. A row of 0 kgf says where it is at rest"
                )
            side = _shaped(side, reverse)
        sides.append(side)
    if alone:  # full throttle
        source += f"; full throttle is known, the shape of the curve is that of a {LIKE[0]} at {LIKE[1]:g} V (estimate)"
    (back, ahead) = sides
    zero_after = min(_ZERO_AFTER, (ahead[0, 0] - back[-1, 0]) / 3.0)
    last, first = back[-1, 0] + zero_after, ahead[0, 0] - zero_after  # where it rests again
    commands = np.concatenate([back[:, 0], [last, first], ahead[:, 0]])
    forces = NEWTONS_IN_KGF * np.concatenate([back[:, 1], [0.0, 0.0], ahead[:, 1]])
    each = _power(back), _power(ahead)
    power = None if min(each) <= 0.0 else each
    if power is None:
        remarks.append(f"{name.upper()} at {volts:g} V: its table has no power, so there is no model of a battery")
    zone = (float(NEWTONS_IN_KGF * back[-1, 1]), float(NEWTONS_IN_KGF * ahead[0, 1]))
    return KnownThruster(name.upper(), volts, commands, forces, zone, power, LAG_S, source, tuple(remarks))


def known_at_voltages(
    name: str, lowest: float, highest: float, tables: Tables | None = None
) -> tuple[KnownThruster, ...]:
    """A thruster at every voltage at which it was published, from the last below a battery's lowest to the first above.

    Args:
        name: one of `known_names`, in any case.
        lowest: of the battery, empty [V].
        highest: full [V].
        tables: of `known_thruster`.

    Raises:
        ModelError: no such thruster, none at such voltages, or none at two of them.
    """
    for volts in (lowest, highest):
        known_thruster(name, volts, tables)  # refused where it has none
    by_voltage = (tables or {}).get(name.upper()) or published()[name.upper()]
    voltages = sorted(by_voltage)
    first, last = max(v for v in voltages if v <= lowest), min(v for v in voltages if v >= highest)
    if first == last:
        raise ModelError(name, f"has one table about {lowest:g} to {highest:g} V; a battery takes two, leave it out")
    return tuple(known_thruster(name, volts, tables) for volts in voltages if first <= volts <= last)


def known_names(tables: Tables | None = None) -> tuple[str, ...]:
    """Types of thrusters that are known, those of tables of one's own first."""
    return tuple(dict.fromkeys([*(tables or {}), *published()]))


_ZERO_AFTER = 4.0 / FULL_US
"""Published rows are 4 us apart: beside the first thrust stands a row of none; nearer where there is less room."""


@cache
def published() -> Tables:
    """What the file beside this one holds."""
    return read_tables(_FILE)


def _side(table: Matrix, reverse: bool) -> Matrix:
    """Rows of one direction that push, by command."""
    return table[(table[:, 1] < 0.0) if reverse else (table[:, 1] > 0.0)]


def _rests(table: Matrix, reverse: bool) -> bool:
    """Whether a row says how far it makes no thrust."""
    return bool((table[table[:, 1] == 0.0, 0] * (-1.0 if reverse else 1.0) > 0.0).any())


def _between(low: Matrix, high: Matrix, share: float) -> Matrix:
    """Rows of a voltage so far between two."""
    if share == 0.0:
        return low
    along = np.unique(np.concatenate([_along(low), _along(high)]).round(9))
    both = [
        np.column_stack([np.interp(along, _along(side), side[:, column]) for column in range(3)])
        for side in (low, high)
    ]
    return (1.0 - share) * both[0] + share * both[1]


def _along(side: Matrix) -> Vector:
    """Share (n,) of the way from the first row's command to the last's."""
    if len(side) == 1:
        return np.zeros(1)
    return (side[:, 0] - side[0, 0]) / (side[-1, 0] - side[0, 0])


def _shaped(side: Matrix, reverse: bool) -> Matrix:
    """Rows of a whole direction from those that there are: below the lowest, in proportion to it, those of `LIKE`."""
    name, volts = LIKE
    like = _side(published()[name][volts], reverse)
    lowest = side[-1 if reverse else 0]
    at_lowest = np.array([np.interp(lowest[0], like[:, 0], like[:, column]) for column in (1, 2)])
    nearer = like[np.abs(like[:, 0]) < abs(lowest[0])]
    below = np.column_stack([nearer[:, 0], nearer[:, 1:] / at_lowest * lowest[1:]])
    return np.vstack([side, below] if reverse else [below, side])


def _power(side: Matrix) -> float:
    """k_P of P = k_P |F|^1.5, in W/N^1.5, of the rows whose power is known; 0 where there is none."""
    side = side[np.isfinite(side[:, 2])]
    if not len(side):
        return 0.0
    raised = np.abs(NEWTONS_IN_KGF * side[:, 1]) ** 1.5
    return float(raised @ side[:, 2] / (raised @ raised))
