"""Voltage sag: what the thrusters draw lowers the voltage they are fed with."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt


@dataclass(frozen=True)
class Battery:
    """A source of constant voltage behind a resistance.

    Attributes:
        open_voltage: E [V].
        resistance: of the cells and the cable, R [ohm].
    """

    open_voltage: float
    resistance: float

    @property
    def greatest_power(self) -> float:
        """The most it can deliver, E^2 / 4R [W]."""
        return self.open_voltage**2 / (4.0 * self.resistance) if self.resistance > 0.0 else float("inf")

    def voltage(self, power: float) -> float:
        """Terminal voltage [V] while delivering `power` [W]: V = E/2 + sqrt(E^2/4 - R P), from V = E - R P / V.

        Beyond the greatest power the voltage stays at E/2, where that power is reached.
        """
        under_root = 0.25 * self.open_voltage**2 - self.resistance * power
        return 0.5 * self.open_voltage + sqrt(max(0.0, under_root))
