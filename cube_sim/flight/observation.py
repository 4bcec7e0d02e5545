"""What one who steps a flight sees."""

from __future__ import annotations

from typing import NamedTuple

from cube_sim.guidance.law import TargetView
from cube_sim.spatial import State, Vector


class Observation(NamedTuple):
    """A flight between two ticks.

    Attributes:
        time_s: simulated time [s].
        state: of the vehicle, true.
        estimate: of the state, as the controller had it at the tick before; the true state where nothing is estimated.
        view: the true vehicle as seen from its target on the path.
        wanted: (4,) wxyz, the attitude the controller asked for at the tick before; at the beginning the one it will.
        force: (m,) the forces the thrusters give [N].
        wrench: (6,) the wrench commanded over the tick before [N, N m], body axes.
        given_up: why the path is no longer followed; "" while it is, and where the controller was not asked.
        ended: why the flight has ended early; "" while it has not.
        over: whether its time has come, or it has ended early: nothing can be stepped any more.
    """

    time_s: float
    state: State
    estimate: State
    view: TargetView
    wanted: Vector
    force: Vector
    wrench: Vector
    given_up: str
    ended: str
    over: bool
