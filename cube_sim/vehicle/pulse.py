"""Servo pulses: how the commands of a thruster travel on the wire to its speed controller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

_COMMANDS = np.array([-1.0, 0.0, 1.0])


@dataclass(frozen=True)
class PulseRange:
    """Pulse widths of the commands -1, 0 and 1; linear between, saturated beyond.

    Attributes:
        reverse_us: full reverse [us].
        rest_us: at rest [us], between the other two.
        forward_us: full forward [us]; less than `reverse_us` where the controller is wired to turn the other way.
    """

    reverse_us: float
    rest_us: float
    forward_us: float

    def pulse(self, command: ArrayLike) -> NDArray[np.float64]:
        """Pulse widths [us] of normalised commands, any shape."""
        return np.interp(np.asarray(command, dtype=float), _COMMANDS, [self.reverse_us, self.rest_us, self.forward_us])

    def command(self, pulse_us: ArrayLike) -> NDArray[np.float64]:
        """Normalised commands of pulse widths [us], any shape."""
        sign = 1.0 if self.reverse_us < self.forward_us else -1.0
        widths = sign * np.array([self.reverse_us, self.rest_us, self.forward_us])
        return np.interp(sign * np.asarray(pulse_us, dtype=float), widths, _COMMANDS)
