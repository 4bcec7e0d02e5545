"""All of a tick of a compiled law of the user's own, as `cube_sim.control.answering` is for cube_sim's."""

from __future__ import annotations

from cube_sim.control.answering import WANTING
from cube_sim.control.own_law import ANSWERED, ask
from cube_sim.guidance.approach import approach_motion
from cube_sim.guidance.pursuit import pursuit_motion
from cube_sim.guidance.speed import speed_at
from cube_sim.native.callee import call_at
from cube_sim.native.compiled import compiled


@compiled
def answer_by_own(parts, view, desired, followed, R, q, v, w, applied, dt, force_ratio, wanting):
    """One tick; arguments of `cube_sim.control.answering.answer`.

    Where the law has no answer nothing has moved on, and the wrench is NaN.
    """
    p, s = parts, parts.settings[0]
    side, sight, rest = p.side.copy(), p.sight.copy(), p.rest.copy()
    speed, slope = speed_at(p.profile, p.nodes, p.square, view[0].arc_length)
    if s.pursuit:
        velocity, acceleration = pursuit_motion(view, p.pursuit, slope)
    else:
        velocity, acceleration = approach_motion(view, p.approach, speed, slope)
    call_at(WANTING, wanting, (p, desired, view, R, q, dt, force_ratio))
    motion = R, q, v, w, velocity, acceleration, applied, dt, force_ratio
    if ask(p.own, p.memory, view, desired, followed, *motion) != ANSWERED:
        p.side[0], p.sight[0], p.rest[0] = side[0], sight[0], rest[0]
