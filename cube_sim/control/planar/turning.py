"""How fast a hull that nothing pushes sideways can run round a curve for good."""

from __future__ import annotations

from math import hypot, inf

from cube_sim.control.planar.attainable_set import PlanarAttainableSet
from cube_sim.control.planar.model import PlanarModel, PlanarMotion

KEPT_FOR_STEERING = 0.3
"""Share of what the thrusters can make that a steady turn leaves for everything else."""


def steady_turn(model: PlanarModel, u: float, curvature: float) -> PlanarMotion | None:
    """The motion through still water at surge u [m/s] along a circle; None where it would slip by more than 45 degrees.

    Sway is where m_ur u r + d_v(u, v) = 0 with r = curvature v_t, by bisection: the first term falls behind the second
    as the side-slip grows.

    Args:
        model: the hull.
        u: surge [m/s], positive.
        curvature: of the circle, positive to the left [1/m].
    """

    def pushed_out(slip: float) -> float:
        """Sway force that is left over at v = slip u, of a turn to the right [N]: its sway is to the left."""
        return model.m_ur * u * abs(curvature) * u * hypot(1.0, slip) - model.d_v(u, slip * u)

    low, high = 0.0, 1.0
    if pushed_out(high) > 0.0:
        return None
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if pushed_out(middle) > 0.0 else (low, middle)
    v = low * u if curvature < 0.0 else -low * u
    return PlanarMotion(u, v, curvature * hypot(u, v))


def tightest_turn(model: PlanarModel, u: float) -> float:
    """The largest curvature [1/m] of a steady turn at surge u [m/s] with 45 degrees of side-slip."""
    return model.d_v(u, u) / (model.m_ur * u * u * hypot(1.0, 1.0))


def turning_length(model: PlanarModel, u: float) -> float:
    """L [m]: a turn that tightens by c' takes as much torque beside its own as one tighter by L c' takes for good.

    The course turns at c v_t, and so by c' v_t^2 faster in a second. Only loop_gain of a yaw acceleration turns the
    course, the rest being side-slip: r' = c' v_t^2 / loop_gain, by the torque m_r r'. A steady turn takes d_r, which
    grows with c v_t^2 as well.

    Args:
        model: the hull.
        u: surge [m/s] at which both are compared, in a turn half as tight as it can be.
    """
    curvature = 0.5 * tightest_turn(model, u)
    turn = steady_turn(model, u, curvature)
    if turn is None or model.d_r(turn) == 0.0:
        return inf
    return curvature * _torque_to_tighten(model, turn, 1.0) / abs(model.d_r(turn))


def turning_speed(
    model: PlanarModel, attainable: PlanarAttainableSet, curvature: float, speed: float, change: float = 0.0
) -> float:
    """The highest surge up to `speed` [m/s] at which the hull stays on a circle, with some thrust kept for steering.

    A circle tighter than any it can run round is treated as the tightest one.

    Args:
        model: the hull.
        attainable: what its thrusters can make.
        curvature: of the circle [1/m], not negative.
        speed: highest one of interest [m/s].
        change: of the curvature along the path, either way [1/m^2].
    """

    def flies(u: float) -> bool:
        turn = steady_turn(model, u, min(curvature, (1.0 - 1e-9) * tightest_turn(model, u)))
        if turn is None:
            return False
        torque = abs(model.d_r(turn)) + _torque_to_tighten(model, turn, abs(change))
        return attainable.holds(model.d_u(turn) / (1.0 - KEPT_FOR_STEERING), torque / (1.0 - KEPT_FOR_STEERING))

    if flies(speed):
        return speed
    low, high = 0.0, speed
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if flies(middle) else (low, middle)
    return low


def _torque_to_tighten(model: PlanarModel, turn: PlanarMotion, change: float) -> float:
    """Torque [N m] by which a turn tightens by `change` [1/m^2] along its path."""
    return model.m_r * change * turn.speed**2 / model.loop_gain(turn)
