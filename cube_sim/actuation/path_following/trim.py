"""Steady straight courses a vehicle can keep with the thrusters it has, restoring moments included."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.actuation.path_following.attitudes import Attitudes, rotations
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.axes import Matrix, Vector

_HEADINGS = 8


@dataclass(frozen=True)
class Course:
    """A straight course at constant velocity and attitude.

    Attributes:
        inclination_rad: angle of the course above the horizontal.
        velocity: (3,) [m/s], body axes.
        up: (3,) world up in body axes.
        wrench: (n,) that keeps it [N, N m].
        forces: (m,) least-norm thruster forces that make it, limits not looked at [N].
    """

    inclination_rad: float
    velocity: Vector
    up: Vector
    wrench: Vector
    forces: Vector

    @property
    def tilt_rad(self) -> float:
        """Angle between the body's z axis and the vertical."""
        return float(np.arctan2(np.hypot(self.up[0], self.up[1]), self.up[2]))


def courses(
    hull: Dynamics, actuation: Subspaces, speed_m_s: float, inclination_rad: float, *, inclined: bool = False
) -> tuple[Course, ...]:
    """Attitudes in which the steady wrench of a course is within reach, nearest to level for each heading tried.

    Unknown is the attitude; the conditions are the unreachable combinations of the steady wrench. Started level with
    the body's x axis at equally spaced angles from the course. Limits are not looked at here.

    Args:
        hull: the body.
        actuation: of the thrusters that are left.
        speed_m_s: speed over the course.
        inclination_rad: angle of the course above the horizontal.
        inclined: start with the body's deck along the course, not level.
    """
    pitch = rotations(np.array([[0.0, -inclination_rad if inclined else 0.0, 0.0]]))
    headings = 2.0 * np.pi * np.arange(_HEADINGS) / _HEADINGS
    attitudes = Attitudes.on(hull, actuation, speed_m_s, inclination_rad)
    R, producible = attitudes.producible(pitch @ rotations(np.outer(headings, [0.0, 0.0, 1.0])))
    return courses_in(attitudes, R[producible], actuation, inclination_rad)


def courses_in(attitudes: Attitudes, R: Matrix, actuation: Subspaces, inclination_rad: float) -> tuple[Course, ...]:
    """The course in each of the attitudes R (q,3,3)."""
    return tuple(
        Course(inclination_rad, attitudes.velocity @ r, r[2], wrench, actuation.pseudo_inverse @ wrench)
        for r, wrench in zip(R, attitudes.wrenches(R), strict=True)
    )
