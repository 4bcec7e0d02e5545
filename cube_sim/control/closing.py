"""How fast a vehicle that moves any way can afford to come to its path."""

from __future__ import annotations

import numpy as np

from cube_sim.control.authority import Authority, Capability
from cube_sim.control.levelling import UP
from cube_sim.spatial import Matrix
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.laws.hull_motion import steady_wrenches

SHARE = 0.5
"""Share of what is attainable that closing may ask for; the rest holds against the water and turns the hull (a
choice)."""
STEEPEST = 0.4
"""The approach brakes by no more than this times its closing speed, over the time in which a small error goes."""
FASTEST_M_S = 2.0
"""No vehicle closes faster than this, whatever its thrusters make (a choice)."""
HALVINGS = 12
"""Steps of bisection: to half a millimetre a second."""


def closing_speed(left: Capability, dynamics: Dynamics, lateral_time: float) -> float:
    """The speed [m/s] at which a large cross-track error can be run down, whichever way it lies.

    Its drag and Munk moment, and the force to brake, lie within `SHARE` of what is attainable, in each of the 26
    directions to the sides, edges and corners of a box about the hull (8 in the plane); level, with the water at rest.
    c tanh(rho / (c T)) falls by 0.385 c / T at most, and c sin(psi_a tanh(rho / (psi_a c T))) by less.

    Args:
        left: what the thrusters can do.
        dynamics: of the hull.
        lateral_time: T, in which a small cross-track error goes [s].

    Returns:
        0 where force has to be pointed by the attitude first, or nothing is known of the thrusters' limits.
    """
    if left.budget is None or left.authority not in (Authority.HOLONOMIC, Authority.LEVEL, Authority.TRIM):
        return 0.0
    ways = unit_box()
    if left.level:
        ways = ways[ways[:, 2] == 0.0]
    slow, fast = 0.0, FASTEST_M_S
    braking = STEEPEST / lateral_time
    if _affords(left, dynamics, braking, fast * ways):
        return fast
    for _ in range(HALVINGS):
        middle = 0.5 * (slow + fast)
        if _affords(left, dynamics, braking, middle * ways):
            slow = middle
        else:
            fast = middle
    return slow


def unit_box() -> Matrix:
    """(26,3) unit vectors to the sides, edges and corners of a box."""
    box = np.array(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3)).reshape(3, -1).T
    box = box[np.any(box != 0.0, axis=1)]
    return box / np.linalg.norm(box, axis=1, keepdims=True)


def _affords(left: Capability, dynamics: Dynamics, braking: float, velocities: Matrix) -> bool:
    """Whether all of these velocities (q,3) [m/s], body axes, can be kept, and fall by `braking` times them [1/s]."""
    budget = left.budget
    assert budget is not None
    steady = steady_wrenches(dynamics.record, velocities, np.tile(UP, (len(velocities), 1)))
    change = braking * velocities @ dynamics.total_mass[:, :3].T
    wrenches = left.project_onto_range(np.concatenate([steady, steady + change, steady - change]))
    return bool(np.all(wrenches @ budget.normals.T - budget.held_shares <= SHARE * budget.attainable.offsets))
