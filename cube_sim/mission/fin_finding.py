"""Faults of fins that nobody tells of, found by where their servos report that they stand.

The controller sees that at every tick anyway. Beside each fin goes a model of its servo, a lag and a fastest rate, that
does what the fin is told from the start of the flight on. A healthy fin is where its model is. Once a second they are
compared:

- a fin that has stood still while its model was off to one side has come to an end of its travel there: it is short;
- one that has stood still while its model was off to the other side too, now or since, is jammed;
- one that moves, is far from its model for two seconds on end, and comes no nearer to where it is told to be, is loose.

A model off by the fin's own numbers is no such thing: a healthy fin that is asked to move does not stand still, and it
comes nearer. What a slow servo does is not found.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.fin_health import FinHealth
from cube_sim.vehicle.fins import Fins
from cube_sim.wrench.health import Health

LOOK_S = 1.0
"""So often they are compared (a choice)."""
STILL_RAD = 0.002
"""A fin that moves by less within that time stands still (a choice)."""
OFF_RAD = 0.03
"""A model that is so far off is somewhere else: 1.7 degrees (a choice)."""
LOOSE_RAD, LOOSE_SHARE = 0.045, 0.5
"""A fin is far from its model by the first, and by the second of how far that has moved (choices)."""
LOOKS = 2
"""So many in a row say that a fin is loose."""
NEARER = 0.7
"""Of its distance to where it is told to be that a fin which comes no nearer has left after these (a choice)."""


class NoUse(NamedTuple):
    """What is wrong with fins that left no way to follow a path, beside thrusters in the state they were in then."""

    fins: FinHealth | None = None
    thrusters: Health | None = None


class FinFinding:
    """Watches the fins of a vehicle.

    Args:
        fins: as the controller believes in them.
        period_s: of a tick.
        told: what is believed of them at first.

    Attributes:
        found: what is believed of them by now.
        of_no_use: what was last, and left no way to follow a path.
    """

    def __init__(self, fins: Fins, period_s: float, told: FinHealth) -> None:
        self._lag_s, self._rate, self._travel = fins.lag_s, fins.rate, fins.travel
        self._period_s, self._per_look = period_s, max(1, round(LOOK_S / period_s))
        self._expected: Vector | None = None
        self._rows: list[tuple[Vector, Vector, Vector]] = []
        self._looked, k = 0, len(fins.names)
        self._far, self._distance = np.zeros(k, dtype=np.int64), np.zeros(k)
        self.found, self.of_no_use = told, NoUse()

    def note(self, wanted: Matrix, stood: Matrix) -> None:
        """Take in ticks.

        Args:
            wanted: (n,k) deflections asked for at each [rad].
            stood: (n,k) at which the fins stood before that [rad].
        """
        for asked, there in zip(np.atleast_2d(wanted), np.atleast_2d(stood), strict=True):
            expected = there if self._expected is None else self._expected
            self._rows.append((asked.copy(), there.copy(), expected.copy()))
            self._expected = self._next(expected, asked)

    def ticks_before_look(self, tick: int) -> int:
        """How many ticks from this one on come before they are compared again."""
        return self._per_look - tick % self._per_look

    def look(self, tick: int) -> bool:
        """Compare fins and models where it is time to; whether something else is believed from this tick on."""
        if tick % self._per_look or tick == self._looked or not self._rows:
            return False
        self._looked = tick
        wanted, stood, expected = (np.array(each) for each in zip(*self._rows, strict=True))
        self._rows = []
        before = self.found
        for i in np.flatnonzero(before.steers).tolist():
            self._judge(i, wanted[:, i], stood[:, i], expected[:, i])
        return self.found is not before

    def _judge(self, i: int, wanted: Vector, stood: Vector, expected: Vector) -> None:
        """Compare one fin with its model, over the (n,) ticks since the last time."""
        off, angle = expected - stood, float(stood[-1])
        above, below = bool(off.max() > OFF_RAD), bool(off.min() < -OFF_RAD)
        if np.ptp(stood) < STILL_RAD:
            self._far[i] = 0
            if above or below:
                self._stands(i, angle, above, below)
            return
        if np.abs(off).mean() <= LOOSE_RAD + LOOSE_SHARE * np.ptp(expected):
            self._far[i] = 0
            return
        if self._far[i] == 0:
            self._distance[i] = abs(wanted[0] - stood[0])
        self._far[i] += 1
        if self._far[i] >= LOOKS:
            self._far[i] = 0
            if abs(wanted[-1] - stood[-1]) >= NEARER * self._distance[i]:
                self.found = self.found.with_fin(i, loose=True)

    def _stands(self, i: int, angle: float, above: bool, below: bool) -> None:
        """Conclude from a fin that stands still at an angle [rad] while its model was off to one side, or to both."""
        least, most = self.found.travel[i].tolist()
        at_an_end = (above and abs(angle - least) < STILL_RAD) or (below and abs(angle - most) < STILL_RAD)
        if (above and below) or at_an_end:  # it stands where it could go no further the other way
            self.found = self.found.with_fin(i, jammed=True)
        elif above:
            self.found = self.found.with_fin(i, travel=(least, angle))
        else:
            self.found = self.found.with_fin(i, travel=(angle, most))

    def _next(self, stood: Vector, wanted: Vector) -> Vector:
        """Where servos bring fins in a tick: at their fastest rate, then by their lag alone."""
        low, high = np.clip(self._travel.T, self.found.travel[:, 0], self.found.travel[:, 1])
        return servo_step(stood, np.clip(wanted, low, high), self._lag_s, self._rate, self._period_s)


def servo_step(
    stood: NDArray[np.float64], target: NDArray[np.float64], lag_s: Vector, rate: Vector, time_s: float
) -> NDArray[np.float64]:
    """Deflections (k,) [rad] of servos after a time, in closed form.

    d' = clip((target - d) / lag, -rate, rate): the distance falls by rate t down to lag rate, then as exp(-t / lag).

    Args:
        stood: (k,) [rad].
        target: (k,) [rad], which stays.
        lag_s: (k,) [s].
        rate: (k,) fastest [rad/s].
        time_s: [s].
    """
    distance, linear = np.abs(target - stood), lag_s * rate
    at_most = np.where(distance > linear, (distance - linear) / rate, 0.0)
    turning = np.minimum(at_most, time_s)
    left = (distance - rate * turning) * np.exp(-(time_s - turning) / lag_s)
    return target - np.sign(target - stood) * left


def columns_of(rows: Matrix, k: int) -> Sequence[Matrix]:
    """(wanted, stood) of rows of the channel `fins`, each (n,k) [rad]."""
    return rows[:, 1 : 1 + k], rows[:, 1 + k : 1 + 2 * k]
