"""The thrusters of one vehicle, seen together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.vehicle.characteristic import Characteristic


@dataclass(frozen=True)
class Thrusters:
    """The m thrusters of a hull, in the order of the columns of its actuation matrix.

    Attributes:
        names: (m,) actuator names.
        actuators: (m,) indices into ctrl and actuator_force.
        characteristics: (m,) steady command-to-force curves.
        lag_s: (m,) time constants of the motors [s].
        power_coefficients: (m,2) k_P-, k_P+ of the electrical power k_P |F|^1.5 [W/N^1.5]; 0 where not known.
    """

    names: tuple[str, ...]
    actuators: NDArray[np.int_]
    characteristics: tuple[Characteristic, ...]
    lag_s: NDArray[np.float64]
    power_coefficients: NDArray[np.float64]

    @property
    def limits(self) -> NDArray[np.float64]:
        """(m,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N] per thruster."""
        return np.array([curve.limits for curve in self.characteristics]).reshape(-1, 4)

    @property
    def reactivity(self) -> NDArray[np.float64]:
        """(m,2) F_react-, F_react+ [N] per thruster."""
        return np.array([curve.reactivity for curve in self.characteristics]).reshape(-1, 2)

    def power(self, force: ArrayLike) -> NDArray[np.float64]:
        """(..., m) electrical power [W] of steady forces (..., m) [N]: k_P |F|^1.5.

        A propeller's ideal power is thrust times induced speed, and that speed goes with the root of the thrust.
        """
        F = np.asarray(force, dtype=float)
        k = np.where(F < 0.0, self.power_coefficients[:, 0], self.power_coefficients[:, 1])
        return k * np.abs(F) ** 1.5

    def energy(self, time: ArrayLike, force: ArrayLike) -> float:
        """Electrical energy [J] of forces (n,m) [N] at times (n,) [s], by the trapezoidal rule."""
        return float(np.trapezoid(self.power(force).sum(axis=-1), np.asarray(time, dtype=float)))

    def command(self, force: ArrayLike) -> NDArray[np.float64]:
        """(m,) commands whose steady forces are `force` (m,) [N]: the inverse characteristics."""
        F = np.asarray(force, dtype=float)
        return np.array([c.command(f) for c, f in zip(self.characteristics, F.tolist(), strict=True)])

    def force(self, command: ArrayLike) -> NDArray[np.float64]:
        """(m,) steady forces [N] of `command` (m,)."""
        c = np.asarray(command, dtype=float)
        return np.array([float(k.force(x)) for k, x in zip(self.characteristics, c, strict=True)])
