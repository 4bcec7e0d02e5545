"""A battery: its voltage falls with the current drawn and with what has been drawn."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt


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
        empty = self.open_voltage if self.empty_voltage is None else self.empty_voltage
        return empty + charge * (self.open_voltage - empty)

    def voltage(self, propellers: float, charge: float = 1.0) -> float:
        """Terminal voltage V [V] while propellers draw the current I = k V^2.

        At constant command the power of a propeller goes with the cube of its speed, so with the cube of V; its current
        goes with the square. V = E - R k V^2 has one positive root at any load: V = 2 E / (1 + sqrt(1 + 4 R k E)).

        Args:
            propellers: k [A/V^2].
            charge: of the battery, 0 empty, 1 full.
        """
        E = self.open_voltage_at(charge)
        return 2.0 * E / (1.0 + sqrt(1.0 + 4.0 * self.resistance * propellers * E))

    def drain(self, power: float, voltage: float) -> float:
        """Power [W] that the cells lose: P + R I^2, I = P / V.

        Args:
            power: P delivered [W].
            voltage: V at the terminals [V].
        """
        return power + self.resistance * (power / voltage) ** 2 if power > 0.0 else 0.0
