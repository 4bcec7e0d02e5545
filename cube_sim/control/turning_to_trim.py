"""The way to a trim that is wished for: evenly, before anything is balanced.

A hull that is far from the trim of its course has nothing to balance there: the forces it is asked for on the way are
not those that its thrusters make, and an attitude that jumps asks for more torque than there is. Hulls of three
thrusters so came to swing for ever about trims that hold them well.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np

from cube_sim.control.attitude_mode import DesiredAttitude, Situation
from cube_sim.guidance.view_record import path_turning, record_of
from cube_sim.spatial import Matrix, State, Vector, quaternion_from_rotation, rotation_about
from cube_sim.tuples import quaternion_from_matrix, turn_between

FAR_RAD = 0.6
"""A hull this far from a trim that is wished for anew turns there first (a choice)."""
THERE_RAD, SLOWLY_RAD_S = 0.2, 0.2
"""So near, and turning no faster, it is there (choices)."""
TURNING_RAD_S = 0.3
"""How fast it turns, where its torque gives as much (a choice)."""
ENDING_S = 1.0
"""In which the last of the way is slowed down [s]."""
LONGEST_S = 30.0
"""After so long it is balanced from where it is (a choice) [s]."""
NO_TURN_RAD = 1e-9


class TurningToTrim:
    """An attitude led evenly from where the hull is to a trim, which turns along with the path.

    Args:
        rotation: R_WB (3,3) of the hull.
        trim: R_WB (3,3) of the trim on its course.
        most_rate: bound on the turning [rad/s].
    """

    def __init__(self, rotation: Matrix, trim: Matrix, most_rate: float) -> None:
        self.rotation, self.trim = rotation.copy(), trim.copy()
        self._rate, self._since = min(TURNING_RAD_S, most_rate), 0.0

    @staticmethod
    def is_far(rotation: Matrix, trim: Matrix) -> bool:
        """Whether an attitude (3,3) is far from a trim (3,3)."""
        return float(np.linalg.norm(_turn(rotation, trim))) > FAR_RAD

    def is_over(self, state: State) -> bool:
        """Whether the hull is there, or has been on its way for too long."""
        near = float(np.linalg.norm(_turn(state.rotation, self.trim))) < THERE_RAD
        return self._since > LONGEST_S or (near and float(np.linalg.norm(state.rates)) < SLOWLY_RAD_S)

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """See `AttitudeMode.attitude`."""
        self._since += dt
        with_path = 0.0 if situation.view is None else path_turning(record_of(situation.view))[2]
        turn = _turn(self.rotation, self.trim)
        angle = float(np.linalg.norm(turn))
        rate = min(self._rate, angle / ENDING_S)
        axis = turn / angle if angle > NO_TURN_RAD else np.zeros(3)
        rates = self.rotation @ (rate * axis) + np.array([0.0, 0.0, with_path])
        desired = DesiredAttitude(quaternion_from_rotation(self.rotation), rates)
        yawed = _yaw(with_path * dt)
        self.rotation, self.trim = yawed @ self.rotation, yawed @ self.trim
        if angle > NO_TURN_RAD:
            self.rotation = self.rotation @ rotation_about(axis, rate * dt)
        return desired


def _turn(R: Matrix, other: Matrix) -> Vector:
    """The rotation vector (3,) from one attitude (3,3) to another [rad], in the axes of the first."""
    return np.array(turn_between(quaternion_from_matrix(R), quaternion_from_matrix(other)))


def _yaw(angle_rad: float) -> Matrix:
    """(3,3)."""
    c, s = cos(angle_rad), sin(angle_rad)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
