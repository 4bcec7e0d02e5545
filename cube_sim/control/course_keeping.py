"""What a vehicle that its fins steer keeps a course by, worked out of its model at the speed of its path.

Such a hull goes where its nose points, through the water. So its heading is the direction of the velocity wanted
through the water, turned by the slip at which hull and fins make the force that is still missing; there is no other
force aside to be asked for. How fast it may turn, and how far it may slip, is what its fins hold.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.control.authority import Capability
from cube_sim.spatial import Matrix, Record, Vector
from cube_sim.vehicle.dynamics import Dynamics

TURN_SHARE, SLIP_SHARE = 1.4, 0.6
"""Share of what the fins make that a steady turn, and a slip, take at most, reckoned by slopes about straight ahead
(choices). In a turn the hull is slower and its drag across is more: it keeps turns that by these slopes it does not."""
STEEPEST_FLOW_RAD, LEANING_RAD = (0.29, 0.45), (0.25, 0.4)
"""Angle at which the flow meets fins astern in the tightest turn that is asked for, and the slip in it. A foil stalls
at 15 to 20 degrees, and one that has stalled does not stop a turn. A hull that turns into its flow by itself stops by
itself: the second of each (choices)."""
MOST_SLIP_RAD = 0.2
"""Largest slip asked for (a choice): hull and fins are known by slopes, which hold up to there."""
FEEBLE = 0.02
"""Share of the largest torque, on its lever, that counts as none: about that axis nothing is asked for."""
ACROSS = 2.0
"""A cross-track error is removed this many times more slowly than heading and slip follow (a choice)."""
SLIP_ROWS = [1, 2, 4, 5]

COURSE = np.dtype(
    [
        ("steered", np.bool_),
        ("speed", np.float64),
        ("makes", np.float64, (6, 4)),
        ("slips", np.float64, (2, 4)),
        ("turning", np.float64, (4, 2)),
        ("levers", np.float64, 2),
        ("most_rate", np.float64, 2),
        ("most_slip", np.float64, 2),
        ("learning_time", np.float64),
        ("learned", np.float64, 2),
        ("water", np.float64, 3),
        ("turned_for", np.float64),
        ("turned_away", np.bool_),
    ]
)
"""Numbers of `CourseKeeping`, whose names these are, and whether it steers. The time [s] in which it learns, and what
it has learned: by how much its nose is to point higher and farther to the left than reckoned [rad]. And the velocity of
the water in which fins are turned (3,) [m/s], world axes: out. For how long the hull has turned away by itself [s], and
whether it is to lose its way because of it, see `cube_sim.control.turned_away`."""


@dataclass(frozen=True)
class CourseKeeping:
    """Straight ahead at one speed, body axes; forces and torques across the hull are (Y, Z, M, N).

    Attributes:
        speed: u_0 through the water [m/s].
        makes: (6,4) wrench of thrusters and fins for a surge force, and torques about x, y and z, one each; a column of
            zeros where there is none.
        slips: (2,4) slip velocities aside and up [m/s] at which hull and fins balance a wrench (Y, Z, M, N), the torque
            being the fins'.
        turning: (4,2) wrench (Y, Z, M, N) of the water on a hull that turns at 1 rad/s about y and z, taken negative.
        levers: (2,) on which fins turn the hull about y and z [m].
        most_rate: (2,) rates about y and z up to which it is asked to turn [rad/s].
        most_slip: (2,) slip aside and up, up to which it is asked to slip [rad].
        slip_time: in which a slip follows the heading [s].
    """

    speed: float
    makes: Matrix
    slips: Matrix
    turning: Matrix
    levers: Vector
    most_rate: Vector
    most_slip: Vector
    slip_time: float

    @staticmethod
    def of(left: Capability, hull: Dynamics, speed_m_s: float) -> CourseKeeping | None:
        """Of what is left of a vehicle; None where fins do not steer it.

        Args:
            left: what thrusters and fins can do, at that speed.
            hull: the body.
            speed_m_s: through the water.
        """
        if not left.by_flow or left.budget is None or not speed_m_s > 0.0:
            return None
        columns = left.budget.matrix * np.abs(left.budget.limits).max(axis=0)
        makes, most = _makes(columns)
        D = hull.steady_wrench_slope(np.array([speed_m_s, 0.0, 0.0, 0.0, 0.0, 0.0]))
        slip, turning = D[np.ix_(SLIP_ROWS, [1, 2])], D[np.ix_(SLIP_ROWS, [4, 5])]
        balance = np.asarray(
            -np.linalg.pinv(np.column_stack([slip, -makes[np.ix_(SLIP_ROWS, [2, 3])]])), dtype=np.float64
        )
        rates, slips, levers = np.empty(2), np.empty(2), np.array([_lever(columns, k) for k in range(2)])
        for slip_axis, about in ((0, 1), (1, 0)):  # a slip aside is held about z, one up about y
            needed = abs(float(D[4 + about, 1 + slip_axis])) * speed_m_s
            slips[slip_axis] = min(MOST_SLIP_RAD, SLIP_SHARE * most[about] / max(needed, 1e-12))
        steady = (bool(D[4, 2] >= 0.0), bool(D[5, 1] <= 0.0))
        for k in range(2):
            answer = balance @ turning[:, k]
            lean = float(np.abs(answer[:2]).max()) / speed_m_s
            rates[k] = min(
                TURN_SHARE * most[k] / max(abs(float(answer[2 + k])), 1e-12),
                LEANING_RAD[steady[k]] / max(lean, 1e-12),
                STEEPEST_FLOW_RAD[steady[k]] / max(lean + float(levers[k]) / speed_m_s, 1e-12),
            )
        slip_time = float(np.max(np.diag(hull.total_mass)[1:3] / np.maximum(np.diag(D)[1:3], 1e-9)))
        return CourseKeeping(speed_m_s, makes, balance[:2], turning, levers, rates, slips, slip_time)

    def lateral_time(self, attitude_time: float) -> float:
        """In which a cross-track error is removed [s], no faster."""
        return ACROSS * (attitude_time + self.slip_time)

    def record(self, attitude_time: float) -> Record:
        """Its numbers, as compiled laws read them: (1,) of `COURSE`; behind an attitude's loop of a time [s]."""
        record = np.zeros(1, COURSE)
        for name in ("speed", "makes", "slips", "turning", "levers", "most_rate", "most_slip"):
            record[name] = getattr(self, name)
        record["steered"], record["learning_time"] = True, self.lateral_time(attitude_time)
        return record


def turning_diameter(left: Capability, hull: Dynamics, speed_m_s: float) -> float:
    """Of the tightest level turn at a speed [m/s] that a hull is asked for whose fins steer it [m]; 0 of any other.

    Args:
        left: as for `CourseKeeping.of`, like the next.
        hull: see there.
        speed_m_s: through the water.
    """
    keeping = CourseKeeping.of(left, hull, speed_m_s)
    return 0.0 if keeping is None else 2.0 * speed_m_s / float(keeping.most_rate[1])


def _makes(columns: Matrix) -> tuple[Matrix, Vector]:
    """`makes` of actuators at full force (6,n), and the most torque about y and z [N m]."""
    lever = float(np.sqrt(np.sum(columns[3:] ** 2) / max(float(np.sum(columns[:3] ** 2)), 1e-300)))
    scaled = columns[[0, 3, 4, 5]] / np.array([[1.0], [lever], [lever], [lever]])
    most = np.abs(columns[3:]).sum(axis=1)
    singular = np.sqrt(np.linalg.svd(scaled @ scaled.T, compute_uv=False))
    rows = [0, 1, 2, 3] if singular[-1] > FEEBLE * singular[0] else [0, 2, 3]  # without roll, if none comes by itself
    makes = np.zeros((6, 4))
    makes[:, rows] = (
        columns
        @ np.linalg.pinv(scaled[rows], rcond=FEEBLE)
        @ np.diag(np.array([1.0, 1.0 / lever, 1.0 / lever, 1.0 / lever])[rows])
    )
    return makes, most[1:]


def _lever(columns: Matrix, k: int) -> float:
    """The rms lever, about y or z, of the forces that turn the hull there [m]."""
    force, torque = columns[2 - k], columns[4 + k]
    return float(np.sqrt(np.sum(torque**2) / max(float(np.sum(force**2)), 1e-300)))
