"""Attitude for a vehicle that has lost part of its wrench: turn until force and righting torque come together.

When thrusters die, some combinations of force and torque can no longer be produced. N_f' F + N_t' M = b holds always;
b = 0 unless a thruster is stuck at a force. A force then comes with a torque. In some attitudes that torque is the very
one that holds the hull against its righting moment. There the vehicle pushes where the path needs it and keeps its
attitude. This law steers to such an attitude, and along the family of them as the demand turns. Turning the heading
does most of it, righting moments do the rest.
"""

from __future__ import annotations

import numpy as np

from cube_sim.control.asked import MEMORY as ASKED
from cube_sim.control.attitude_mode import DESIRED, AttitudeMode, DesiredAttitude, Situation
from cube_sim.control.authority import Capability
from cube_sim.control.balancing import BALANCE, MEMORY, NEVER_SEEN_RAD, SOFT_SHARE, SOFTNESS_N, balance
from cube_sim.control.course_trim import seeks_trim
from cube_sim.control.loop_times import FASTEST_TURN
from cube_sim.control.pace import NO_BUDGET, ForceBudget
from cube_sim.guidance.view_record import VIEW, record_of
from cube_sim.spatial import Matrix, Record, Vector
from cube_sim.vehicle.dynamics import Dynamics

ROLL_OF_FINS = 0.13
"""Sine of the roll, 7 degrees, up to which a hull that steers by fins is asked to roll so as to point a force (a
choice). Its righting moment lets it roll little, so farther over it would be asked for what it never does, and its
heading and pitch would be judged in axes that are turned by it."""


class BalancedAttitude:
    """Two tasks by priority (Nakamura 1987), on the turning rate w of the desired attitude R, body axes.

    What has to be made in an attitude is the wrench W(R) = W_s(R' U, R' e_z) + [R' F_W; M_0]. W_s keeps the wanted
    velocity U through the water steady: drag, Munk moment, weight and lift. It turns with the hull, as the water
    meets it from another side. F_W is the rest of the force, to change the velocity and against disturbances; its
    direction is that of the world. M_0 is the torque against disturbances and for the turning that goes on.

    First, the imbalance g = N' W - b decays over `time`: w = -J# (g / time + N' W'), J = dg/dw, W' that of U and F_W as
    the path turns. Second, in the null space of the first, the hull tilts and heads as the mission asks for, over
    `wish_time`. J# is damped, so nothing is singular when the force vanishes or lines up with the axis it cannot be
    turned about.

    Where W, as far as it can be produced at all, exceeds what is attainable, the facet it exceeds most is one more row
    of the first task: the vehicle turns until it lies within.

    U and F_W are averaged over `time` and led by as much: x = 2 x_1 - x_2, x_1 and x_2 averaged once and twice, and
    x' = 2 x_1' - x_2' is its very derivative. A force that turns evenly with the path is so pointed without lag. So is
    M_0, or what is no imbalance at all, a force and the torque that comes with it, would be one on the way.

    Args:
        left: what the thrusters can still do, and it steers by attitude; in a level plane by heading alone.
        dynamics: of the hull.
        rotation: R_WB (3,3) now, from which the first turn starts unless the hull is far from its wish.
        time: of the first task, and over which the demanded force is averaged [s].
        wish: the attitude of the second task.
        wish_time: of the second task [s].
        most_rate: bound on the turning of the desired attitude [rad/s].
    """

    def __init__(
        self,
        left: Capability,
        dynamics: Dynamics,
        rotation: Matrix,
        time: float,
        wish: AttitudeMode,
        wish_time: float = 2.0,
        most_rate: float = FASTEST_TURN,
    ) -> None:
        self._hull, self._wish = dynamics.record, wish
        self.budget = NO_BUDGET if left.budget is None else _of_what_is_made(left, left.budget)
        self.parameters, count = np.zeros(1, BALANCE), left.lost.shape[1]
        parameters = self.parameters[0]
        parameters["lost"][:, :count], parameters["constants"][:count] = left.lost, left.constants
        parameters["count"], parameters["level"] = count, left.level
        parameters["time"], parameters["wish_time"], parameters["most_rate"] = time, wish_time, most_rate
        parameters["most_roll"] = ROLL_OF_FINS if left.by_flow else np.inf
        parameters["softness"] = min(SOFTNESS_N, SOFT_SHARE * left.strongest)
        self.parameters["watched"] = seeks_trim(left)
        self.wished: Vector = np.array([1.0, 0.0, 0.0, 0.0])
        self.memory: Record = np.zeros(1, MEMORY)
        self.memory["rotation"], self.memory["off"], self.memory["astray"] = rotation, np.inf, NEVER_SEEN_RAD

    @property
    def short(self) -> bool:
        """Whether the wrench exceeds what is attainable in the attitude found."""
        return bool(self.memory["short"][0])

    @property
    def stale(self) -> bool:
        """Whether the course, or what is wished for on it, has become another than was judged."""
        return bool(self.memory["stale"][0])

    @property
    def trim(self) -> Matrix | None:
        """The attitude (3,3) it wishes for, body axes in those of the course, in place of the mission's; or None."""
        return self.parameters["trim"][0].copy() if self.parameters["trimmed"][0] else None

    def wish_for(self, trim: Matrix | None, judged: Record) -> None:
        """Wish for a trim, None for what the mission wishes, on the course that a record `MEMORY` holds.

        A trim that is wished for anew is where the search goes on from. On the way there may be attitudes in which a
        turn points no force, and the search would end in them.
        """
        p = self.parameters
        p["judged_wish"], p["judged_speed"], p["judged_climb"] = judged["course_wish"], judged["speed"], judged["climb"]
        if trim is not None and not p["trimmed"][0]:
            ahead, aside = (float(x) for x in judged["heading"])
            self.memory["rotation"][0] = np.array([[ahead, -aside, 0.0], [aside, ahead, 0.0], [0.0, 0.0, 1.0]]) @ trim
        p["trimmed"] = trim is not None
        if trim is not None:
            p["trim"] = trim
        self.memory["since"], self.memory["stale"] = 0.0, False

    @property
    def judged(self) -> bool:
        """Whether a course has been looked at before."""
        return bool(self.parameters["judged_speed"][0] != 0.0)

    @property
    def off(self) -> float:
        """How far the attitude found is from the wish [rad]."""
        return float(self.memory["off"][0])

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """See `AttitudeMode.attitude`."""
        asked, desired = np.zeros(1, ASKED), np.zeros(1, DESIRED)
        asked["velocity"] = situation.velocity
        asked["force"], asked["torque"] = situation.force, situation.torque
        desired[0] = tuple(self._wish.attitude(situation, dt))
        self.wished = desired["quaternion"][0].copy()
        balance(
            self._hull,
            self.parameters,
            *self.budget,
            self.memory,
            desired,
            np.zeros(1, VIEW) if situation.view is None else record_of(situation.view),
            situation.rotation,
            asked,
            situation.current,
            dt,
            situation.force_ratio,
        )
        return DesiredAttitude(*desired[0])


def _of_what_is_made(left: Capability, budget: ForceBudget) -> tuple[Matrix, Vector, Vector]:
    """Normals, bounds and held shares of a budget, to be asked with a wrench that is not yet moved into the range of A.

    What cannot be produced is balanced, not made. Along directions that cost too much it would exceed the little that
    is attainable.
    """
    projector, shift = left.onto_range
    return np.ascontiguousarray(budget.normals @ projector), budget.bounds, budget.held_shares - budget.normals @ shift
