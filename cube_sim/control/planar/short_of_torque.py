"""How much of the speed wanted a hull gives up while it is short of the torque to turn as it should."""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record

LEAST_SHARE = 0.5
"""Share of the speed wanted that is always kept: it is what the hull steers by."""
FALL, RISE = 0.2, 0.1
"""How fast that share falls while the torque does not suffice, and rises again after [1/s]."""


SHARE = np.dtype([("share", np.float64)])
"""What `ShortOfTorque` remembers: the share of the speed wanted that is left."""


@compiled
def torque_share(u, wanted):
    """What the torque gets of the thrusters before the force, as a share of what it could have alone.

    Half where the speed is missing, which has to be gathered before the hull steers; all of it at the speed wanted. To
    brake or to speed up there at the cost of the torque would turn the hull even later.

    Args:
        u: surge [m/s].
        wanted: the speed wanted, nothing given up [m/s].
    """
    return min(max(u / wanted, LEAST_SHARE), 1.0)


class ShortOfTorque:
    """The torque that a change of course takes grows with the square of the speed; what the thrusters make does not.

    A law whose torque is cut off at a high speed turns too late, and may swing about its path for ever. So the speed
    falls until the torque suffices, and comes back at half that rate: a hull that swings is short of torque in every
    swing, and loses more speed in it than it regains until the next. Below `LEAST_SHARE` of the speed wanted it is the
    speed that is missing, not the torque, and nothing is given up.
    """

    def __init__(self) -> None:
        self.memory: Record = np.ones(1, SHARE)

    @property
    def share(self) -> float:
        """The share of the speed wanted that is left."""
        return float(self.memory["share"][0])

    def update(self, u: float, wanted: float, asked: float, made: float, dt: float) -> None:
        """Learn from one tick, see `watch_torque`."""
        watch_torque(self.memory, u, wanted, asked, made, dt)


@compiled
def watch_torque(memory, u, wanted, asked, made, dt):
    """One tick of `ShortOfTorque`.

    Args:
        memory: record `SHARE`, moved on.
        u: surge [m/s].
        wanted: the speed wanted, nothing given up [m/s].
        asked: torque of the law [N m].
        made: the part of it that is attainable [N m].
        dt: length of the tick [s].
    """
    short = abs(asked) > 1.02 * abs(made) and u > LEAST_SHARE * wanted
    step = -FALL if short else RISE
    memory[0].share = min(max(memory[0].share + dt * step, LEAST_SHARE), 1.0)
