"""How far a fault throws a hull off until it is found, at most, from the model.

A thruster that is believed to give f and gives c pushes with (c - f) A_i beside all that is asked for. The loops, and
the observer of the disturbance, answer the motion that comes of it, in part by asking more of that very thruster, which
does not give it: f = f_0 + (A^+)_i tau. That is a linear system, integrated here from the moment of the fault without
the drag of the water; of the place the whole way counts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.spatial import Matrix, Vector
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.matrix import lever_arm
from cube_sim.wrench.tolerances import RANK_TOLERANCE

STEP_S = 0.01
"""Of the integration."""


class LoopSpeeds(NamedTuple):
    """What of the loops the bound of a transient depends on [s]."""

    velocity: float
    attitude: float
    rate: float
    observer: float
    delay: float


class Thrown(NamedTuple):
    """How far a hull has been thrown off; vectors in body axes.

    Attributes:
        off_m: from where it would be, at most.
        velocity: (3,) off the one it would have [m/s].
        turned: (3,) off its attitude, as a rotation vector [rad].
        rates: (3,) off its rates [rad/s].
        learned: (6,) what the observer of the disturbance takes for one [N, N m].
    """

    off_m: float
    velocity: Vector
    turned: Vector
    rates: Vector
    learned: Vector

    def pushed_on(self, motion: Vector, time_s: float) -> Thrown:
        """The same after a push that goes on until the others have made up for it.

        Args:
            motion: accelerations (6,) [m/s^2, rad/s^2], body axes.
            time_s: for how long.
        """
        velocity, rates = self.velocity + motion[:3] * time_s, self.rates + motion[3:] * time_s
        speeds = float(np.linalg.norm(self.velocity)) + float(np.linalg.norm(velocity))
        return Thrown(
            off_m=self.off_m + 0.5 * speeds * time_s,
            velocity=velocity,
            turned=self.turned + 0.5 * (self.rates + rates) * time_s,
            rates=rates,
            learned=self.learned,
        )


def thrown_by(
    mass: Matrix,
    A: Matrix,
    limits: Matrix,
    made: Matrix,
    thruster: int,
    given_N: tuple[float, float],
    loops: LoopSpeeds,
    time_s: float,
) -> Thrown:
    """What one thruster does to a hull until it is known that it does not do what it is told.

    Args:
        mass: M (6,6) of the hull.
        A: (6,m) of all thrusters.
        limits: (m,2) their least and largest forces [N].
        made: (6,6) what is made of a demand while they all work, see `Capability.onto_range`.
        thruster: which.
        given_N: what it is asked for at the beginning, and what it gives.
        loops: of the law while they all work.
        time_s: how long it goes on.
    """
    inverse, column, asks = np.linalg.inv(mass), A[:, thruster], share_asked(A)[thruster]
    (asked, given), (low, high) = given_N, limits[thruster]
    velocity, rates, angles = np.zeros(3), np.zeros(3), np.zeros(3)
    demand, learned, off = np.zeros(6), np.zeros(6), 0.0
    turn_back, damp = 1.0 / (loops.rate * loops.attitude), 1.0 / loops.rate + 1.0 / loops.attitude
    for _ in range(round(time_s / STEP_S)):
        wanted = -mass @ np.concatenate([velocity / loops.velocity, damp * rates + turn_back * angles]) - learned
        demand += STEP_S / max(loops.delay, STEP_S) * (made @ wanted - demand)
        push = column * (given - float(np.clip(asked + asks @ demand, low, high)))
        learned += STEP_S / loops.observer * (push - learned)
        motion = inverse @ (demand + push)
        velocity, rates = velocity + STEP_S * motion[:3], rates + STEP_S * motion[3:]
        angles = angles + STEP_S * rates
        off += STEP_S * float(np.linalg.norm(velocity))
    return Thrown(off, velocity, angles, rates, learned)


def share_asked(A: Matrix) -> Matrix:
    """(m,6) what is asked of each thruster for a wrench, by the least forces; nothing for what is as good as lost."""
    scale = SPATIAL.scale(lever_arm(A, SPATIAL))
    return np.linalg.pinv(scale[:, None] * A, rcond=RANK_TOLERANCE) * scale
