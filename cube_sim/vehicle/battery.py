"""A battery: its voltage falls with the current drawn and with what has been drawn."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from cube_sim.vehicle.laws.supply_law import drain_of_cells, open_voltage_at, sagging_voltage


@dataclass(frozen=True)
class Battery:
    """A source of voltage behind a resistance.

    Attributes:
        open_voltage: E when full [V].
        resistance: R of cells and cable [ohm].
        empty_voltage: E when empty [V]; it falls in a straight line with the charge. None: as when full.
        capacity: energy given at open circuit from full to empty [J].
    """

    open_voltage: float
    resistance: float
    empty_voltage: float | None = None
    capacity: float = inf

    def open_voltage_at(self, charge: float) -> float:
        """E [V] at a charge between 0, empty, and 1, full."""
        return open_voltage_at(self.open_voltage, self.lowest_voltage, charge)

    @property
    def lowest_voltage(self) -> float:
        """E [V] when empty."""
        return self.open_voltage if self.empty_voltage is None else self.empty_voltage

    def voltage(self, propellers: float, charge: float = 1.0) -> float:
        """Terminal voltage V [V] while propellers draw the current I = k V^2.

        At constant command the power of a propeller goes with the cube of its speed, so with the cube of V; its current
        goes with the square. V = E - R k V^2 has one positive root at any load: V = 2 E / (1 + sqrt(1 + 4 R k E)).

        Args:
            propellers: k [A/V^2].
            charge: of the battery, 0 empty, 1 full.
        """
        return sagging_voltage(self.open_voltage_at(charge), self.resistance, propellers)

    def drain(self, power: float, voltage: float) -> float:
        """Power [W] that the cells lose: P + R I^2, I = P / V.

        Args:
            power: P delivered [W].
            voltage: V at the terminals [V].
        """
        return drain_of_cells(self.resistance, power, voltage)
