"""Steady straight courses a vehicle can keep with the thrusters it has, restoring moments included."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.actuation.hull import Hull
from cube_sim.actuation.subspaces import Subspaces
from cube_sim.actuation.wrench_axes import Matrix, Vector
from cube_sim.spatial import skew

_HEADINGS = 8
_STEPS = 30
_DIFFERENCE = 1e-6
_BALANCED = 1e-8


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
    hull: Hull, actuation: Subspaces, speed_m_s: float, inclination_rad: float, *, inclined: bool = False
) -> tuple[Course, ...]:
    """Attitudes in which the steady wrench of a course is within reach, nearest to level for each heading tried.

    Unknown is the attitude; the conditions are the unreachable combinations of the steady wrench. Newton steps of
    least norm, started level with the body's x axis at equally spaced angles from the course. Limits are not looked
    at here.

    Args:
        hull: the body.
        actuation: of the thrusters that are left.
        speed_m_s: speed over the course.
        inclination_rad: angle of the course above the horizontal.
        inclined: start with the body's deck along the course, not level.
    """
    pitch = _rotation(np.array([0.0, -inclination_rad if inclined else 0.0, 0.0]))
    course_W = course_velocity(speed_m_s, inclination_rad)
    planar = len(actuation.matrix) == 3
    rows = [0, 1, 5] if planar else list(range(6))
    conditions = np.array([c.coefficients for c in actuation.unreachable]).reshape(-1, len(rows))
    turns = np.array([[0.0, 0.0, 1.0]]).T if planar else np.eye(3)

    def demand(R: Matrix) -> Vector:
        nu = np.concatenate([R.T @ course_W, np.zeros(3)])
        return hull.steady_wrench(nu, R.T[:, 2])[rows]

    scale = max(1.0, float(np.linalg.norm(demand(np.eye(3)))), hull.buoyancy * _offset(hull))
    found = []
    for heading in 2.0 * np.pi * np.arange(_HEADINGS) / _HEADINGS:
        R = pitch @ _rotation(np.array([0.0, 0.0, heading]))
        for _ in range(_STEPS):
            error = conditions @ demand(R)
            if np.linalg.norm(error) <= _BALANCED * scale:
                wrench = demand(R)
                forces = actuation.pseudo_inverse @ wrench
                found.append(Course(inclination_rad, R.T @ course_W, R.T[:, 2], wrench, forces))
                break
            slope = np.column_stack(
                [(conditions @ demand(R @ _rotation(_DIFFERENCE * turn)) - error) / _DIFFERENCE for turn in turns.T]
            )
            step = np.linalg.lstsq(slope, -error, rcond=1e-9)[0]
            length = float(np.linalg.norm(step))
            R = R @ _rotation(turns @ step * min(1.0, 0.5 / max(length, 1e-12)))
    return tuple(found)


def course_velocity(speed_m_s: float, inclination_rad: float) -> Vector:
    """(3,) [m/s], world axes: forwards and up."""
    return speed_m_s * np.array([np.cos(inclination_rad), 0.0, np.sin(inclination_rad)])


def _offset(hull: Hull) -> float:
    return float(np.linalg.norm(hull.centre_of_buoyancy - hull.centre_of_mass))


def _rotation(vector: NDArray[np.floating]) -> Matrix:
    """exp(S(vector)), Rodrigues."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    K = skew(vector / angle)
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)
