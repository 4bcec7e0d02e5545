"""What the thrusters do while a force carries the hull away: they fight it, from the first moment to the last."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from closed_loop.flown_loop import NOTHING, FlownLoop
from closed_loop.linear_loop import LinearLoop

LONGEST_S = 20.0
"""In which the hull turns back, or stays."""


class Drift(NamedTuple):
    """The answer to a unit force that begins at once and stays, while the hull goes with it.

    Attributes:
        helped: largest force of the thrusters along it, as a share of it; 0 where they never help.
        work: work of the thrusters along the drift [J], per [N^2] of the force: negative.
        carried_m: how far the hull goes with it [m/N].
    """

    helped: float
    work: float
    carried_m: float


def drift(loop: LinearLoop, axis: int) -> Drift:
    """Push the hull along an axis of the body, 0 to 2, until its velocity turns round."""
    at = np.zeros(len(loop.closed))
    helped, work, carried = 0.0, 0.0, 0.0
    for _ in range(round(LONGEST_S / loop.period)):
        force = float(loop.demand[axis] @ at)
        at = loop.closed @ at + loop.drag[:, axis]
        speed = float(at[3 + axis])
        if speed <= 0.0:
            break
        helped = max(helped, force)
        work += loop.period * force * speed
        carried += loop.period * speed
    return Drift(helped, work, carried)


class PointedDrift(NamedTuple):
    """The same of a hull that points its thrust: seen along the axis as it was, so that the thrust turns with the hull.

    Where turning pushes the hull, by G w' along the axis, G = e' M_ff dragged, it is first pushed on by it. The energy
    that the thrusters so put into the drift is bounded by the impulse of that push, max |G w|, times the speed of the
    drift. Where turning does not push it they put in none.

    Attributes:
        helped: largest force of the thrusters along the drift, as a share of the force that carries the hull away.
        put_in: what they put in while they help [J], as a share of what that force does.
        most_put_in: the bound of it.
        work: all that they do along the drift, as that share: negative where they take out more than they put in.
    """

    helped: float
    put_in: float
    most_put_in: float
    work: float


def pointed_drift(flown: FlownLoop, loop: LinearLoop, axis: int) -> PointedDrift:
    """Push a hull along an axis of its steady attitude, 0 to 2, until its velocity turns round.

    Args:
        flown: the loop.
        loop: the same about its steady motion.
        axis: which.
    """
    along, first = np.eye(3)[axis], len(loop.point.vectors)
    thrust, velocity = flown.tick(loop.point, NOTHING)[1][:3], loop.point.vectors[3:6]
    pushes = (
        along @ flown.hull.total_mass[:3, :3] @ flown.controller.capability.record(flown.hull.total_mass)["dragged"][0]
    )
    at, rows = np.zeros(len(loop.closed)), []
    for _ in range(round(LONGEST_S / loop.period)):
        force = along @ ((loop.demand @ at)[:3] + np.cross(at[first : first + 3], thrust))
        at = loop.closed @ at + loop.drag[:, axis]
        speed = along @ (at[3:6] + np.cross(at[first : first + 3], velocity))
        rows.append((force, max(speed, 0.0), abs(pushes @ at[6:9])))
        if speed <= 0.0:
            break
    force, speed, impulse = np.array(rows).T
    done, power = float(np.sum(speed)), force * speed
    return PointedDrift(
        helped=max(float(np.max(force)), 0.0),
        put_in=float(np.sum(np.maximum(power, 0.0))) / done,
        most_put_in=float(np.max(impulse) * np.max(speed)) / (loop.period * done),
        work=float(np.sum(power)) / done,
    )
