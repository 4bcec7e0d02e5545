"""A thruster's curves at several voltages, between which the supply's voltage of the moment interpolates.

    <body>:thruster_voltage_table   rows voltage [V], command, force [N]: the published curve at each voltage; in
                                    place of thruster_characteristic and thruster_dead_zone
    <body>:thruster_voltage         the voltage without a battery [V], one between them
    <body>:thruster_power           k_P-, k_P+ of all of them, or of each in the order of voltage [W/N^1.5]
    <actuator>:thruster_...         each of these for one thruster, before its hull's

On each side rows of the same share of the way from first thrust to full throttle belong together, since the pulse of
first thrust moves with the voltage: between two voltages commands, forces and powers go in straight lines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import counted
from cube_sim.vehicle.characteristic import Characteristic
from cube_sim.vehicle.mjcf.numbers import Numerics, rows
from cube_sim.vehicle.thruster_tables import READING

TABLE = "thruster_voltage_table"
_RESTS_AFTER = 0.01
"""Command from first thrust back to none, or a third of the dead zone where that is less: published rows are so far
apart (T200: 4 us of 400)."""


@dataclass(frozen=True)
class VoltageParameters:
    """Curves of one shape at k voltages.

    Attributes:
        source: name of the numeric.
        voltages: (k,) increasing [V].
        curves: at each, with as many points.
        power: (k,2) k_P-, k_P+ [W/N^1.5].
    """

    source: str
    voltages: NDArray[np.float64]
    curves: tuple[Characteristic, ...]
    power: NDArray[np.float64]

    def at(self, voltage: float) -> tuple[Characteristic, tuple[float, float]]:
        """The curve and k_P-, k_P+ at a voltage between the first and the last."""
        high = int(np.clip(np.searchsorted(self.voltages, voltage), 1, len(self.voltages) - 1))
        share = (voltage - self.voltages[high - 1]) / (self.voltages[high] - self.voltages[high - 1])
        one, two = self.curves[high - 1], self.curves[high]
        zone = np.array([one.force_dead_zone, two.force_dead_zone])
        zone, power = ((1.0 - share) * pair[0] + share * pair[1] for pair in (zone, self.power[high - 1 : high + 1]))
        curve = Characteristic(
            (1.0 - share) * one.commands + share * two.commands,
            (1.0 - share) * one.forces + share * two.forces,
            (float(zone[0]), float(zone[1])),
        )
        return curve, (float(power[0]), float(power[1]))


def voltages_of(numerics: Numerics, name: str, power: str | None) -> VoltageParameters:
    """The curves that a numeric holds.

    Args:
        numerics: name -> values (n,), all numerics of the model.
        name: of the numeric.
        power: name of that of k_P; None where it is not known.

    Raises:
        ModelError: names the numeric at fault and says what would be right.
    """
    table = rows(numerics, name, 3, "voltage [V], command, force [N]")
    voltages = np.unique(table[:, 0])
    if len(voltages) < 2 or voltages[0] <= 0.0:
        raise ModelError(
            name,
            f"has {counted(len(voltages), 'voltage')}; two at least, above 0 V, are right (thruster_characteristic for "
            "one)",
        )
    sides = [_sides(name, table[table[:, 0] == volts][:, 1:], volts) for volts in voltages]
    back, ahead = ([each[k] for each in sides] for k in (0, 1))
    curves = tuple(_curve(*pair) for pair in zip(_alike(back), _alike(ahead), strict=True))
    k = len(voltages)
    values = np.zeros(2) if power is None else numerics[power]
    if values.size not in (2, 2 * k) or not np.isfinite(values).all() or values.min() < 0.0:
        raise ModelError(
            power or "",
            f"has {counted(values.size, 'value')}; 2, or 2 for each of {k} voltages, none below 0, are right",
        )
    return VoltageParameters(name, voltages, curves, np.broadcast_to(values.reshape(-1, 2), (k, 2)).copy())


def _sides(name: str, table: NDArray[np.float64], volts: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rows command, force of either direction that push, from first thrust on."""
    table = table[np.argsort(table[:, 0])]
    commands, forces = table.T
    if np.any(np.diff(commands) <= 0.0):
        raise ModelError(name, f"has a command twice at {volts:g} V")
    if np.abs(commands).max() > 1.0:
        raise ModelError(
            name, f"has the command {commands[np.argmax(np.abs(commands))]:g} at {volts:g} V; -1 to 1 is right"
        )
    falls, allowed = np.diff(forces), READING * float(np.ptp(forces))
    if falls.min(initial=0.0) < -allowed:
        i = int(np.argmin(falls))
        raise ModelError(
            name,
            f"falls from {forces[i]:g} to {forces[i + 1]:g} N at {volts:g} V (command {commands[i + 1]:g}); force "
            "never decreases with the command",
        )
    back, ahead = table[forces < 0.0][::-1], table[forces > 0.0]
    if not len(back) or not len(ahead) or back[:, 0].max() >= 0.0 or ahead[:, 0].min() <= 0.0:
        raise ModelError(name, f"does not push back below command 0 and ahead above at {volts:g} V")
    if len(back) < 2 or len(ahead) < 2:
        raise ModelError(
            name, f"has one pushing row a side at {volts:g} V; first thrust and full throttle at least are right"
        )
    return back, ahead


def _alike(sides: list[NDArray[np.float64]]) -> list[NDArray[np.float64]]:
    """The same sides at the same shares of the way from first thrust to full throttle, none falling."""
    shares = [(side[:, 0] - side[0, 0]) / (side[-1, 0] - side[0, 0]) for side in sides]
    every = np.unique(np.concatenate(shares).round(9))
    alike = []
    for side, share in zip(sides, shares, strict=True):
        force = np.interp(every, share, side[:, 1])
        size = np.maximum.accumulate(np.abs(force))
        alike.append(np.column_stack([side[0, 0] + every * (side[-1, 0] - side[0, 0]), np.sign(force) * size]))
    return alike


def _curve(back: NDArray[np.float64], ahead: NDArray[np.float64]) -> Characteristic:
    rests = min(_RESTS_AFTER, (ahead[0, 0] - back[0, 0]) / 3.0)
    commands = np.concatenate([back[::-1, 0], [back[0, 0] + rests, ahead[0, 0] - rests], ahead[:, 0]])
    forces = np.concatenate([back[::-1, 1], [0.0, 0.0], ahead[:, 1]])
    return Characteristic(commands, forces, (float(back[0, 1]), float(ahead[0, 1])))
