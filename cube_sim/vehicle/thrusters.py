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
    """

    names: tuple[str, ...]
    actuators: NDArray[np.int_]
    characteristics: tuple[Characteristic, ...]
    lag_s: NDArray[np.float64]

    @property
    def limits(self) -> NDArray[np.float64]:
        """(m,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N] per thruster."""
        return np.array([curve.limits for curve in self.characteristics]).reshape(-1, 4)

    def command(self, force: ArrayLike) -> NDArray[np.float64]:
        """(m,) commands whose steady forces are `force` (m,) [N]: the inverse characteristics."""
        F = np.asarray(force, dtype=float)
        return np.array([c.command(f) for c, f in zip(self.characteristics, F.tolist(), strict=True)])

    def force(self, command: ArrayLike) -> NDArray[np.float64]:
        """(m,) steady forces [N] of `command` (m,)."""
        c = np.asarray(command, dtype=float)
        return np.array([float(k.force(x)) for k, x in zip(self.characteristics, c, strict=True)])
