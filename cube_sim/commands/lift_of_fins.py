"""What fins leave of a vehicle's own lift or weight at a speed."""

from __future__ import annotations

import numpy as np

from cube_sim.vehicle.fins import FinsAtSpeed
from cube_sim.vehicle.remarks import NEUTRAL
from cube_sim.vehicle.vehicle import Vehicle

_Z = 2


def lift_words(vehicle: Vehicle, fins: FinsAtSpeed, speed_m_s: float) -> list[str]:
    """A sentence where fins and thrusters hold less, straight up or down, than the vehicle is lifted or pulled by.

    Args:
        vehicle: with fins.
        fins: what they do at that speed.
        speed_m_s: straight ahead.
    """
    g = float(np.linalg.norm(vehicle.gravity))
    less = (vehicle.displaced_mass - vehicle.mass) * g
    thrust = float(np.abs(vehicle.actuation_matrix[_Z]) @ np.abs(vehicle.thrusters.limits).max(axis=1))
    lift = float(np.abs(fins.matrix[_Z]) @ np.abs(fins.limits).max(axis=1))
    if abs(less) <= max(thrust + lift, NEUTRAL * vehicle.mass * g) or lift == 0.0:
        return []
    how, points = ("rises", "down") if less > 0.0 else ("sinks", "up")
    return [
        f"it {how} with {abs(less):.3g} N, and its fins make {lift:.3g} N across at {speed_m_s:g} m/s: it keeps its "
        f"depth there only with its nose {points}"
    ]
