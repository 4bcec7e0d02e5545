"""How far a hull leaves its path after a fault, at most, from what the thrusters that are left can still do.

Thrown off by x_1 at a speed u_1 until the fault is found (`cube_sim.control.thrown`), a hull whose loops are served in
full moves on by the delay T of its thrusters and the time T_v of its velocity loop:

    x_1 + u_1 (T + T_v)

They are served where the wrench that keeps its motion steady, all that the loops ask for on top of it, and what is
stuck lie within the facets of what is attainable, and some of what they ask for in every other direction, too. Where
the torque that stops the turning fits in full, and the force does not, what is left of it brakes with b:

    x_1 + u_1 T + u_1^2 / (2 b) + b T_v^2 / 2,    u_1 > b T_v

Where not even the torque fits, it is served first for as long as it takes to stop the turning, and the force that comes
with the closest wrench pushes the hull meanwhile. (Beside a stuck thruster the law serves the force first, which pushes
it less.)

Where nothing holds it, where it has to turn to another attitude first, or the attitude has to point the thrust, the law
follows no such bound, and none is given. What is foreseen then stands in `cube_sim.control.foreseen`.
"""

from __future__ import annotations

from math import inf, pi
from typing import NamedTuple

import numpy as np

from cube_sim.control.authority import POINTING, Authority, Capability
from cube_sim.control.closing import unit_box
from cube_sim.control.foreseen import Foreseen, in_metres
from cube_sim.control.pace import LEAST_PACE, Facets
from cube_sim.control.roomiest_attitude import has_enough, roomiest_attitude
from cube_sim.control.thrown import LoopSpeeds, Thrown
from cube_sim.control.turned_round import LEAST_TOLD_M
from cube_sim.spatial import Matrix, Vector
from cube_sim.tuples import rotated
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.matrix import lever_arm

PACES = (1.0, 0.75, 0.5, LEAST_PACE)
"""Shares of the speed along the path that are looked at."""
FARTHEST_RAD = 1.2
"""A hull thrown farther about than this has left what is reckoned here."""
STILL_RAD = 0.1
"""A hull that swings farther about an axis left to the water is carried about by its own lift (a choice)."""
ROUNDING = 1e-9
ASIDE = 0.3
"""So much of what the loops ask for has to be there in every other direction, too: what they ask for turns as it goes
(a choice)."""
SHARES = (1.0, 0.5, 0.25)
"""Of a demand that is too large, which are looked at."""
TORQUE_WEIGHT = 30.0
"""Of torque against force errors where a demand is out of reach, as a scenario that does not say allocates."""
LEAST_M = 0.01
"""No bound is smaller: below, dead zones and what is not known of the water decide (a choice)."""
FARTHEST_M = 3.0
"""A bound beyond this says nothing: too little is left (a choice)."""
LONGEST_S = 5.0
"""What is left has to stop a hull, and its turning, within so long, or it is too little for a bound (a choice)."""


class Transient(NamedTuple):
    """What becomes of a hull after a fault.

    Attributes:
        bound_m: how far it leaves its path at most; infinite where there is no bound.
        reason: why there is none; empty where there is one.
        turns_rad: how far it turns to another attitude.
        wanders_m: how far from its place it is turned round, by its equations of motion: no bound; 0 where it is not.
    """

    bound_m: float
    reason: str
    turns_rad: float = 0.0
    wanders_m: float = 0.0

    @property
    def words(self) -> str:
        """One clause for the log."""
        return f"no bound of the transient: {self.reason}" if self.reason else f"transient at most {self.bound_m:.2g} m"

    def known_within(self, less_known_m: float) -> Transient:
        """The same of a hull of which it is known only so well where it is."""
        return self._replace(bound_m=self.bound_m + less_known_m)

    def words_with(self, ahead: Foreseen | None) -> str:
        """One clause for the log, with what is foreseen; None where nothing is."""
        if ahead is None:
            return self.words
        if not self.reason:
            most = max(self.bound_m, ahead.with_margin_m)
            return f"transient at most {most:.2g} m, {in_metres(ahead.farthest_m)} m foreseen"
        return f"transient {ahead.words}; no bound: {self.reason}"


class _Room:
    """What is left over a motion kept steady, in an attitude and those about it."""

    def __init__(self, left: Capability, hull: Dynamics, ratio: float) -> None:
        budget = left.budget
        assert budget is not None
        self._left, self._hull, self._ratio = left, hull, ratio
        self._normals, self._offsets = budget.normals, ratio * budget.bounds + budget.held_shares
        self._projected = self._normals @ left.onto_range[0]
        self.mass = hull.total_mass
        along = self._projected @ self.mass
        self._push, self._twist = np.linalg.norm(along[:, :3], axis=1), np.linalg.norm(along[:, 3:], axis=1)

    def over(self, attitudes: Matrix, flow_W: Vector) -> Vector:
        """(p,) [N] how much of each facet is left in the worst of attitudes (k,3,3)."""
        flows = np.einsum("kji,j->ki", attitudes, flow_W)
        steady = self._hull.steady_wrenches(flows, attitudes[:, 2])
        needed = self._left.project_onto_range(steady) @ self._normals.T
        return self._offsets - np.max(needed, axis=0)

    def share(self, slack: Vector, wrench: Vector, beside: Vector | None = None) -> float:
        """How often a wrench (6,) [N, N m] fits, and `ASIDE` of it in every other direction, beside another in full."""
        if beside is not None:
            slack = slack - self._along(beside)
        return _least(slack, self._along(wrench))

    def _along(self, wrench: Vector) -> Vector:
        """(p,) [N] what a wrench and `ASIDE` of it in every other direction take of each facet."""
        motion = np.linalg.solve(self._hull.total_mass, wrench)
        sizes = np.linalg.norm(motion[:3]), np.linalg.norm(motion[3:])
        return self._projected @ wrench + ASIDE * (sizes[0] * self._push + sizes[1] * self._twist)

    def pull(self, slack: Vector) -> float:
        """The acceleration [m/s^2] that is left in every direction."""
        return _least(slack, self._push)

    def pushed(self, attitude: Matrix, flow_W: Vector, demand: Vector) -> float:
        """The acceleration [m/s^2] that the closest wrench leaves while more torque is asked for than there is.

        The largest one, of all of a demand (6,) [N, N m] on top of the steady wrench, less of it and some beside it.
        """
        from scipy.optimize import lsq_linear

        budget, mass = self._left.budget, self._hull.total_mass
        assert budget is not None
        scale = SPATIAL.scale(lever_arm(budget.matrix, SPATIAL)) * np.array([1.0] * 3 + [TORQUE_WEIGHT] * 3)
        steady = self._hull.steady_wrenches((attitude.T @ flow_W)[None], attitude[2:])[0]
        aside = np.linalg.norm(np.linalg.solve(mass, demand)[3:]) * mass[:, 3:] @ unit_box().T
        largest = 0.0
        for share in SHARES:
            for wanted in (demand, *(demand + ASIDE * aside.T)):
                asked = self._left.project_onto_range(steady + share * wanted)
                found = lsq_linear(
                    scale[:, None] * budget.matrix,
                    scale * (asked - budget.held),
                    bounds=tuple(self._ratio * budget.limits),
                )
                made = budget.matrix @ found.x + budget.held - self._left.project_onto_range(steady)
                largest = max(largest, float(np.linalg.norm(np.linalg.solve(mass, made)[:3])))
        return largest


def transient(
    left: Capability,
    hull: Dynamics,
    loops: LoopSpeeds,
    thrown: Thrown,
    attitude: Matrix,
    velocity_W: Vector,
    current_W: Vector,
    force_ratio: float = 1.0,
) -> Transient:
    """The bound of what follows a fault.

    Args:
        left: what the thrusters can do.
        hull: the body.
        loops: of the law as it goes on.
        thrown: how far it has been thrown off.
        attitude: R_WB (3,3) in which it flies.
        velocity_W: along its path (3,) [m/s], world axes.
        current_W: (3,) [m/s], world axes.
        force_ratio: share of their force that the supply leaves the thrusters.
    """
    if left.authority is Authority.SAFE:
        return Transient(inf, left.reason)
    if left.budget is None:
        return Transient(inf, "the limits of the thrusters are not known")
    if left.authority in POINTING:
        return Transient(inf, "the attitude has to point the thrust that is left")
    if left.turned is not None:
        return Transient(inf, left.turned.words, wanders_m=max(left.turned.wanders_m, LEAST_TOLD_M))
    if left.authority is Authority.LEVEL:
        return Transient(inf, "its depth is left to the water")
    slow = LEAST_PACE * velocity_W - current_W
    facets: Facets = (left.budget.normals, left.budget.bounds, left.budget.held_shares)
    if (
        left.authority is Authority.HOLONOMIC
        and left.held.any()
        and not has_enough(hull.record, facets, force_ratio, slow, attitude)
    ):
        return _turned_away(left, hull, facets, attitude, slow, force_ratio)
    spun = float(np.linalg.norm(thrown.turned) + np.linalg.norm(thrown.rates) * (loops.delay + loops.rate))
    swing = _swing(left, hull, attitude, velocity_W - current_W)
    if swing > STILL_RAD:
        return Transient(inf, f"it swings by up to {np.degrees(swing):.0f} deg about an axis that is left to the water")
    spun += swing
    if not spun < FARTHEST_RAD:
        return Transient(inf, f"it may turn by more than {np.degrees(FARTHEST_RAD):.0f} deg before it is stopped")
    room = _Room(left, hull, force_ratio)
    for pace in PACES:
        slower = (1.0 - pace) * (attitude.T @ velocity_W)
        found = _stopped(room, spun, loops, thrown, attitude, pace * velocity_W - current_W, slower)
        if found is not None:
            reason = "too little is left to stop its turning and to brake it" if found > FARTHEST_M else ""
            return Transient(inf if reason else found, reason)
    return Transient(inf, f"too little is left to brake it, turned by up to {np.degrees(spun):.0f} deg")


def keeps(left: Capability, hull: Dynamics, attitude: Matrix, flow_W: Vector) -> bool:
    """Whether a motion is kept steady in an attitude (3,3) whose force is all there, flow (3,) [m/s], world axes."""
    if left.budget is None or left.authority not in (Authority.HOLONOMIC, Authority.TRIM):
        return False
    return bool(np.all(_Room(left, hull, 1.0).over(attitude[None], flow_W) >= 0.0))


def _stopped(
    room: _Room, spun: float, loops: LoopSpeeds, thrown: Thrown, attitude: Matrix, flow_W: Vector, slower: Vector
) -> float | None:
    """The bound [m] where the attitude is kept; None where too little is left for that."""
    slack, mass = room.over(_tilted(attitude, spun), flow_W), room.mass
    velocity, off = thrown.velocity + slower, thrown.off_m
    speed, damp = float(np.linalg.norm(velocity)), 1.0 / loops.rate + 1.0 / loops.attitude
    turn_back = damp * thrown.rates + thrown.turned / (loops.rate * loops.attitude)
    learned_force = np.concatenate([thrown.learned[:3], np.zeros(3)])
    push = -mass @ np.concatenate([velocity / loops.velocity, np.zeros(3)]) - learned_force
    twist = -mass @ np.concatenate([np.zeros(3), turn_back]) - (thrown.learned - learned_force)
    back = 0.0
    if loops.observer < inf:  # what it has wrongly learned
        answer = float(np.linalg.norm(np.linalg.solve(mass, thrown.learned)[:3]))
        back = answer * loops.velocity * loops.observer
    turn = room.share(slack, twist)
    if turn < 1.0:
        # The torque asked for is more than there is, and comes first: until it has stopped the turning, the force is
        # whatever comes with it.
        if turn * LONGEST_S * damp < 1.0:
            return None
        seconds, push_m_s2 = (1.0 - turn) / (turn * damp), room.pushed(attitude, flow_W, push + twist)
        off += speed * seconds + 0.5 * push_m_s2 * seconds**2
        speed += push_m_s2 * seconds
        brake = room.pull(slack)
    else:
        brake = min(1.0, room.share(slack, push, beside=twist)) * speed / loops.velocity
    if brake * LONGEST_S < speed:
        return None
    return max(off + speed * loops.delay + braking_m(speed, brake, loops.velocity), back, LEAST_M)


def braking_m(speed: float, brake: float, time: float) -> float:
    """How far a hull comes [m] that a loop of this time [s] stops by no more than `brake` [m/s^2]."""
    if speed <= brake * time * (1.0 + ROUNDING):
        return speed * time
    return speed**2 / (2.0 * brake) + brake * time**2 / 2.0


def _turned_away(
    left: Capability, hull: Dynamics, facets: Facets, attitude: Matrix, flow_W: Vector, force_ratio: float
) -> Transient:
    """No bound where another attitude has to be turned to first, or none has enough."""
    there = roomiest_attitude(hull.record, facets, force_ratio, flow_W, attitude)
    if there is None:
        return Transient(inf, "the others cannot make up for what is stuck in any attitude it can turn to")
    angle = float(np.arccos(np.clip(0.5 * (np.sum(attitude * there) - 1.0), -1.0, 1.0)))
    reason = f"it has to turn by {np.degrees(angle):.0f} deg first, to where the others have enough"
    return Transient(inf, reason, angle)


def _tilted(attitude: Matrix, angle: float) -> Matrix:
    """An attitude and those turned away from it by an angle [rad] about 26 axes (27,3,3)."""
    return np.array([attitude, *(rotated(attitude, tuple(axis.tolist()), angle) for axis in unit_box())])


def _swing(left: Capability, hull: Dynamics, attitude: Matrix, flow_W: Vector) -> float:
    """How far a hull swings [rad] about axes left to the water: to its trim and as far beyond; no further than half."""
    steady = hull.steady_wrenches((attitude.T @ flow_W)[None], attitude[2:])[0]
    torque = (left.project_onto_range(steady) - steady)[3:]
    righting = float(hull.righting_moment @ attitude[2])
    size = float(np.linalg.norm(torque))
    if size <= 1e-9 * max(righting, 1.0):
        return 0.0
    return 2.0 * float(np.arcsin(size / righting)) if size < righting else pi


def _least(slack: Vector, per_unit: Vector) -> float:
    """How many units fit into every facet; none where one is exceeded already."""
    if np.any(slack < 0.0):
        return 0.0
    counts = per_unit > 1e-12 * max(1.0, float(np.max(np.abs(per_unit), initial=0.0)))
    return float(np.min(slack[counts] / per_unit[counts], initial=inf))
