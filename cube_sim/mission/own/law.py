"""A control law of the user's own: what it gets, and the controller that asks it."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass
from math import atan2, sqrt
from typing import Any, NamedTuple

import mujoco
import numpy as np

from cube_sim.control.attitude_mode import AttitudeMode, Situation
from cube_sim.control.authority import Capability
from cube_sim.control.controller import Decision
from cube_sim.control.loop_times import LoopTimes
from cube_sim.guidance.law import MotionLaw, Target, TargetView
from cube_sim.guidance.path import Path
from cube_sim.mission.own.code import OwnCode, numbers_of
from cube_sim.mission.own.handed import handed
from cube_sim.mission.own.others import NOBODY, Others
from cube_sim.scenario import Scenario
from cube_sim.spatial import Matrix, State, Vector, conjugate, multiply
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.vehicle import Vehicle


@dataclass(frozen=True)
class LawSetup:
    """What a control law of one's own is made from: the vehicle as the controller believes it, and the mission.

    Attributes:
        scenario: what is flown.
        period_s: the control period [s].
        model: the MuJoCo model with its water, a copy, its reference position where the mission begins; step it or
            linearise it as you like.
        vehicle: where the hull stands in the model, and its thrusters.
        dynamics: the hull's equations of motion.
        A: (6,m) actuation matrix [1, m].
        limits: (m,4) [F_max-, F_DZ-, F_DZ+, F_max+] of the thrusters, as the allocation keeps them [N].
        capability: what the thrusters can do.
        times: how fast cube_sim's own loops would be for this vehicle [s].
        path: the path.
        target: the target on it.
        motion: which velocity brings a vehicle to that target.
        attitude: which attitude it should take.
        others: of several vehicles in one water, the states of the others, see `Others`.
    """

    scenario: Scenario
    period_s: float
    model: mujoco.MjModel
    vehicle: Vehicle
    dynamics: Dynamics
    A: Matrix
    limits: Matrix
    capability: Capability
    times: LoopTimes
    path: Path
    target: Target
    motion: MotionLaw
    attitude: AttitudeMode
    others: Others = NOBODY


class Aim(NamedTuple):
    """One tick of a law: where the vehicle is, where it should be and how it should move; body axes unless said.

    Attributes:
        time: since the start [s].
        dt: length of a tick [s].
        state: the vehicle, as the controller knows it.
        target_view: the vehicle seen from its target on the path; numba keeps the name view for itself.
        error: (6,) [m, rad] from the vehicle to its target: the way there, and the rotation vector to the attitude
            wanted.
        velocity: (6,) wanted [m/s, rad/s], over ground.
        velocity_error: (6,) the velocity wanted less the actual one [m/s, rad/s].
        acceleration: (3,) derivative of the velocity wanted along the present motion [m/s^2], world axes.
        quaternion: q_WD (4,) wxyz, the attitude wanted.
        applied: (6,) [N, N m] the wrench allocated over the tick before.
        capability: what the thrusters can do that are believed to work.
        force_ratio: share of their force that the supply leaves the thrusters.
    """

    time: float
    dt: float
    state: State
    target_view: TargetView
    error: Vector
    velocity: Vector
    velocity_error: Vector
    acceleration: Vector
    quaternion: Vector
    applied: Vector
    capability: Capability
    force_ratio: float


class OwnLaw:
    """The controller around a function from an `Aim` to a wrench (6,), or to its primary and secondary parts (2,6).

    It keeps the target moving, and knows no safe mode: what to do with a path that cannot be followed is the law's own.

    Args:
        code: where the law comes from.
        law: the function.
        setup: what it was made from.
    """

    def __init__(self, code: OwnCode, law: Any, setup: LawSetup) -> None:
        self._code, self._law, self._period = code, law, setup.period_s
        self._target, self._motion, self._attitude = setup.target, setup.motion, setup.attitude
        self._ticks = 0
        self.reconfigure(setup.capability)
        self._demanded = np.zeros(6)

    def take_up(self, other: OwnLaw) -> None:
        """See `GoesOn.take_up`; the law itself and what it remembers stay."""
        self._target, self._motion, self._attitude = other._target, other._motion, other._attitude

    def view(self, state: State) -> TargetView:
        """See `Controller.view`."""
        return self._target.view(state.position, state.rotation @ state.velocity)

    def reconfigure(self, left: Capability) -> None:
        """Tell the law of other thrusters, in its aims."""
        self._capability, self._shown = left, deepcopy(left)

    def decide(self, state: State, applied: Vector, dt: float, force_ratio: float = 1.0) -> Decision:
        """See `Controller.decide`."""
        aim = self._aim(state, applied, dt, force_ratio)
        wrench, secondary = self._parts(self._code.call(self._law, handed(aim)))
        self._ticks, self._demanded = self._ticks + 1, wrench
        self._target.advance(aim.target_view.speed, dt)
        return Decision(
            wrench=wrench,
            secondary=secondary,
            disturbance=np.zeros(6),
            current=np.zeros(3),
            view=aim.target_view,
            remaining=aim.target_view.remaining,
            velocity=aim.velocity[:3],
            rates=aim.velocity[3:],
            quaternion=aim.quaternion,
            attitude_error=float(np.linalg.norm(aim.error[3:])),
            authority=self._capability.authority,
        )

    def _aim(self, state: State, applied: Vector, dt: float, force_ratio: float) -> Aim:
        R, view = state.rotation, self.view(state)
        motion = self._motion.motion(view)
        velocity_W = np.asarray(motion.velocity, dtype=float)
        force, torque = R @ self._demanded[:3], self._demanded[3:]
        effort = self._capability.effort
        situation = Situation(view, R, force, torque, np.zeros(3), effort, force_ratio, velocity_W)
        quaternion, rates_W = self._attitude.attitude(situation, dt)
        velocity = np.concatenate([velocity_W @ R, np.asarray(rates_W, dtype=float) @ R])
        turn = rotation_between(state.quaternion, np.asarray(quaternion, dtype=float))
        return Aim(
            time=self._ticks * self._period,
            dt=dt,
            state=state,
            target_view=view,
            error=np.concatenate([(view.point.position - state.position) @ R, turn]),
            velocity=velocity,
            velocity_error=velocity - np.concatenate([state.velocity, state.rates]),
            acceleration=np.asarray(motion.acceleration, dtype=float),
            quaternion=np.asarray(quaternion, dtype=float),
            applied=applied,
            capability=self._shown,
            force_ratio=force_ratio,
        )

    def _parts(self, answer: Any) -> tuple[Vector, Vector]:
        """The whole wrench (6,) and the part of it that gives way."""
        if getattr(answer, "ndim", 0) == 2 or (isinstance(answer, tuple | list) and len(answer) == 2):
            primary, secondary = numbers_of(self._code, answer, (2, 6), "a wrench in two parts")
            return primary + secondary, secondary
        return numbers_of(self._code, answer, (6,), "a wrench"), np.zeros(6)


def rotation_between(q: Vector, p: Vector) -> Vector:
    """The rotation vector (3,) [rad], at most pi long, that turns attitude q into p, in the axes of q."""
    w, x, y, z = multiply(conjugate(q), p)
    size = sqrt(x * x + y * y + z * z)
    if size == 0.0:
        return np.zeros(3)
    angle = 2.0 * atan2(size, abs(w))
    return np.array([x, y, z]) * ((angle if w >= 0.0 else -angle) / size)
