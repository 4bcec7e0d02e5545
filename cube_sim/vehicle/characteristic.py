"""Thruster characteristic: command to steady force and back (report 3.3.3, figure 4)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Characteristic:
    """A measured curve with a dead zone.

    Outside the dead zone the force is the piecewise linear curve through the measured points. Inside it is zero. At the
    edges of the dead zone it jumps to F_DZ+ and F_DZ-, the smallest forces the thruster can hold.

    Attributes:
        commands: (n,) normalised commands, strictly increasing, c = 1 full forward.
        forces: (n,) steady forces along the thruster's axis [N], never decreasing.
        force_dead_zone: (F_DZ-, F_DZ+) [N], F_DZ- <= 0 <= F_DZ+.
    """

    commands: NDArray[np.float64]
    forces: NDArray[np.float64]
    force_dead_zone: tuple[float, float]

    @cached_property
    def command_dead_zone(self) -> tuple[float, float]:
        """(c_DZ-, c_DZ+): the commands between which the force is zero."""
        low, high = self.force_dead_zone
        (c_reverse, F_reverse), (c_forward, F_forward) = self.sides
        return float(np.interp(low, F_reverse, c_reverse)), float(np.interp(high, F_forward, c_forward))

    @cached_property
    def limits(self) -> NDArray[np.float64]:
        """[F_max-, F_DZ-, F_DZ+, F_max+] [N], the allowed set [F_max-, F_DZ-] u {0} u [F_DZ+, F_max+]."""
        low, high = self.force_dead_zone
        return np.array([self.forces[0], low, high, self.forces[-1]])

    @cached_property
    def reactivity(self) -> tuple[float, float]:
        """(F_react-, F_react+) [N]: on each side the force at which the curve is steepest.

        There a thruster answers fastest. It is the middle of the steepest measured segment, or of what the dead zone
        leaves of it: a thruster cannot hold the forces it jumps over.
        """
        (low, high), (c_low, c_high) = self.force_dead_zone, self.command_dead_zone
        (c_reverse, F_reverse), (c_forward, F_forward) = self.sides
        back, ahead = F_reverse < low, F_forward > high
        return (
            _steepest(np.append(c_reverse[back], c_low), np.append(F_reverse[back], low)),
            _steepest(np.append(c_high, c_forward[ahead]), np.append(high, F_forward[ahead])),
        )

    def force(self, command: ArrayLike) -> NDArray[np.float64]:
        """Steady force [N] of each normalised command, any shape; commands beyond the curve saturate."""
        c = np.asarray(command, dtype=float)
        low, high = self.command_dead_zone
        return np.where((c < low) | (c > high), np.interp(c, self.commands, self.forces), 0.0)

    def command(self, force: float) -> float:
        """Command whose steady force is `force` [N]; forces beyond the curve saturate.

        A force inside the dead zone has no command: the nearest of 0, F_DZ- and F_DZ+ is commanded. Commands for a
        non-zero force lie strictly outside the command dead zone, so that rounding never stops the thruster.
        """
        low, high = self.force_dead_zone
        (c_reverse, F_reverse), (c_forward, F_forward) = self.sides
        if force > 0.0 and force >= 0.5 * high:
            at_edge = np.nextafter(self.command_dead_zone[1], np.inf)
            return float(max(np.interp(force, F_forward, c_forward), at_edge))
        if force < 0.0 and force <= 0.5 * low:
            at_edge = np.nextafter(self.command_dead_zone[0], -np.inf)
            return float(min(np.interp(force, F_reverse, c_reverse), at_edge))
        return 0.0

    @cached_property
    def sides(self) -> tuple[tuple[NDArray[np.float64], NDArray[np.float64]], ...]:
        """(commands, forces) of the reverse and of the forward side, each with one point of zero force."""
        end = int(np.flatnonzero(self.forces >= 0.0)[0]) + 1
        start = int(np.flatnonzero(self.forces <= 0.0)[-1])
        return (self.commands[:end], self.forces[:end]), (self.commands[start:], self.forces[start:])


def _steepest(commands: NDArray[np.float64], forces: NDArray[np.float64]) -> float:
    """Middle of the steepest segment; the force itself where there is only one point."""
    if commands.size < 2:
        return float(forces[0])
    i = int(np.argmax(np.diff(forces) / np.diff(commands)))
    return float(0.5 * (forces[i] + forces[i + 1]))
