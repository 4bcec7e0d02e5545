"""Path following in 3-D with whatever the thrusters can still do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from cube_sim.control.attitude_mode import AttitudeMode, Situation
from cube_sim.control.authority import Authority, Capability, capability
from cube_sim.control.balanced_attitude import BalancedAttitude
from cube_sim.control.controller import Decision
from cube_sim.control.current import CurrentObserver
from cube_sim.control.disturbance import DisturbanceObserver
from cube_sim.control.loops import MotionLoops, Reference
from cube_sim.control.pace import LEAST_PACE, Flags, largest_pace
from cube_sim.control.priority import split_path_first
from cube_sim.control.safe_mode import LossOfTargetMonitor, SafeMode, SafeModeGoal
from cube_sim.guidance.approach import Approach
from cube_sim.guidance.law import DesiredMotion, MotionLaw, Target, TargetView
from cube_sim.spatial import Matrix, State, Vector, cross

SLOWER = 3.0
"""A force that waits for the attitude is asked for by a velocity loop this many times slower than the attitude's."""
SLOWER_ACROSS = 2.0
"""The cross-track error is then removed this many times more slowly than that of the velocity."""
SLOWER_AT_TRIM = 2.0
"""Where roll or pitch is left to the water, the balance of force and torque is sought this many times more slowly."""
MEAN_TIME_S = 4.0
"""Over which the turning is averaged that the path asks for [s]."""
PATIENCE_S = 1.0
"""How long the thrusters have to be short of what a slow pace asks for before the vehicle turns."""
BACK_RAD = 0.02
"""Within this angle of the attitude its mission asks for it is taken to be back there."""


def along_path(motion: DesiredMotion, view: TargetView) -> DesiredMotion:
    """The part of a motion along the path; it turns with the path frame."""
    T = view.point.rotation[:, 0]
    velocity = float(motion.velocity @ T) * T
    return DesiredMotion(velocity, (motion.acceleration @ T) * T + cross(view.turning, velocity))


@dataclass
class PathFollower:
    """Virtual target -> approach velocity and attitude -> loops -> wrench; disturbance and current are estimated.

    Attributes:
        target: the target on the path.
        approach: the desired velocity.
        attitude: the desired attitude.
        loops: desired motion to wrench.
        balancing_time: of `BalancedAttitude` [s].
        observer: the disturbance estimate, None for none.
        current_observer: reads that estimate; None to take the water to be at rest.
        safe_mode: what to do when the path cannot be followed.
        most_rest: how much of a force that could not be made is asked for again at the next tick [N].
        waits: whether the speed along the path falls to what the thrusters can keep.
        capability: what the thrusters can still do; demands are projected onto it.
        path_first: whether the attitude gives way to the path when the thrusters cannot serve both. Where the attitude
            has to point the thrust, it never does.
    """

    target: Target
    approach: MotionLaw
    attitude: AttitudeMode
    loops: MotionLoops
    balancing_time: float
    observer: DisturbanceObserver | None
    current_observer: CurrentObserver | None
    safe_mode: SafeMode
    most_rest: float = 0.0
    waits: bool = True
    capability: Capability = field(default_factory=lambda: capability(np.eye(6)))
    path_first: bool = False

    def __post_init__(self) -> None:
        """Fly with what the thrusters can do from the start."""
        self._force: Vector = np.zeros(3)
        self._velocity: Vector = np.zeros(3)
        self._torque: Vector = np.zeros(3)
        self._mean_rates: Vector = np.zeros(3)
        self._asked: Vector | None = None
        self._force_ratio, self._short_s, self._pressed = 1.0, 0.0, False
        self._goal: SafeModeGoal | None = None
        self._balanced: BalancedAttitude | None = None
        self._monitor = LossOfTargetMonitor(self.safe_mode)
        self.reconfigure(self.capability)

    def reconfigure(self, left: Capability) -> None:
        """Go on with what is left: steer by attitude, or, when that cannot follow a path, keep to the safe mode."""
        self.capability = left
        self._balanced, self._loops, self._approach = None, self.loops, self.approach
        mass = self.loops.dynamics.total_mass
        self._dragged = np.linalg.solve(mass[:3, :3], left.dragged_force @ mass[3:, 3:])
        if left.authority is not Authority.SAFE:
            if self._goal is not None:
                self._monitor.restart()
            self._goal = None
        elif self._goal is not None:
            self._goal.set_reason(left.reason)
        if left.authority in (Authority.PLANE, Authority.LINE, Authority.UNICYCLE):
            # Force across the line has to wait for the attitude, so the velocity loop must be the slower one.
            slower = max(self.loops.velocity_time, SLOWER * self.loops.attitude_time)
            self._loops = replace(self.loops, velocity_time=slower)
            if isinstance(self.approach, Approach):
                self._approach = self.approach.no_faster_than(SLOWER_ACROSS * slower)

    def decide(self, state: State, applied: Vector, dt: float, force_ratio: float = 1.0) -> Decision:
        """See `Controller.decide`."""
        self._force_ratio = force_ratio
        view = self.target.view(state.position, state.rotation @ state.velocity)
        goal = self._safe_mode_goal(state, view, dt)
        motion = self._approach.motion(view) if goal is None else goal.motion(state.position)
        disturbance, current = self._unknowns(state, applied, dt)
        situation = Situation(
            view,
            state.rotation,
            self._force,
            self._torque,
            current,
            self.capability.effort,
            force_ratio,
            self._velocity - current,
        )
        attitude = self._mode(state).attitude(situation, dt)
        motion = self._undragged(state, motion, dt)
        wrench, reference = self._loops.wrench(state, motion, attitude, current)
        pace, pointed = 1.0, wrench - disturbance
        if self.capability.budget is not None:
            demand = self._demand(state, motion, view, wrench - disturbance, reference, disturbance, current)
            if goal is None and self.waits and isinstance(self._approach, Approach):
                pace = largest_pace(self._allowed, demand)
            if pace < 1.0:
                along = along_path(motion, view)
                motion = DesiredMotion(
                    motion.velocity + (pace - 1.0) * along.velocity,
                    motion.acceleration + (pace - 1.0) * along.acceleration,
                )
                wrench, reference = self._loops.wrench(state, motion, attitude, current)
            pointed = demand(np.array([max(pace, LEAST_PACE)]))
            self._watch_shortage(bool(self._allowed(pointed)[0]), dt)
            pointed = pointed[0]
        demanded = wrench - disturbance
        self._force = state.rotation @ (pointed[:3] - self._of_own_turning(state, view, current))
        self._velocity = motion.velocity
        if goal is None:
            self.target.advance(view.speed, dt)
        in_range = self.capability.project_onto_range(demanded + self._rest(applied))
        self._asked = in_range
        # Nobody but the balanced attitude asks for it.
        turning = np.zeros(3) if self._balanced is None else self._turning_torque(state, current)
        self._torque = turning - disturbance[3:]
        return Decision(
            wrench=in_range,
            secondary=self._secondary(in_range),
            disturbance=disturbance,
            current=current,
            view=view,
            remaining=view.remaining,
            velocity=reference.velocity,
            rates=reference.rates,
            quaternion=attitude.quaternion,
            attitude_error=reference.attitude_error,
            authority=self.capability.authority if goal is None else Authority.SAFE,
            pace=pace,
            given_up="" if goal is None else goal.reason,
        )

    def _turning_torque(self, state: State, current: Vector) -> Vector:
        """The torque (3,) [N m], body axes, that the hull asks for as it goes on turning as it has on average."""
        straight_on = self._as_it_turns(state, np.zeros(3), current)
        return (self._as_it_turns(state, self._mean_rates, current) - straight_on)[3:]

    def _undragged(self, state: State, motion: DesiredMotion, dt: float) -> DesiredMotion:
        """A motion whose velocity error does not count what the torque of turning drags along.

        A hull that turns by a force on a lever is first pushed the wrong way. Answering that would feed on itself. The
        centre of oscillation does not move then: its velocity is the one to correct.
        """
        self._mean_rates = self._mean_rates + min(1.0, dt / MEAN_TIME_S) * (state.rates - self._mean_rates)
        pushed = state.rotation @ (self._dragged @ (state.rates - self._mean_rates))
        return DesiredMotion(motion.velocity, motion.acceleration + pushed / self._loops.velocity_time)

    def _of_own_turning(self, state: State, view: TargetView, current: Vector) -> Vector:
        """The force (3,) [N], body axes, that the hull asks for as it turns otherwise than the path.

        An attitude that points it would chase itself: added mass makes that force grow with the turning, not the path.
        """
        along = view.turning @ state.rotation
        return (self._as_it_turns(state, state.rates, current) - self._as_it_turns(state, along, current))[:3]

    def _as_it_turns(self, state: State, rates: Vector, current: Vector) -> Vector:
        """The wrench (6,) [N, N m], body axes, of the velocity the hull has over ground, kept while it turns."""
        v, none = state.velocity, np.zeros(3)
        nu, nu_dot = np.concatenate([v, rates]), np.concatenate([-cross(rates, v), none])
        return self.loops.dynamics.wrench(state.rotation, nu, nu_dot, current)

    def _safe_mode_goal(self, state: State, view: TargetView, dt: float) -> SafeModeGoal | None:
        """Where to go instead of along the path, once there is a reason to; only other thrusters end it."""
        if self._goal is None:
            lost = self.capability.reason if self.capability.authority is Authority.SAFE else ""
            reason = lost or self._monitor.reason(view, dt)
            self._goal = SafeModeGoal(self.safe_mode, state, reason) if reason else None
        return self._goal

    def _demand(
        self,
        state: State,
        motion: DesiredMotion,
        view: TargetView,
        demanded: Vector,
        reference: Reference,
        disturbance: Vector,
        current: Vector,
    ) -> Callable[[Vector], Matrix]:
        """Paces (q,) along the path -> the wrenches (q,6) they ask for, with the torque that holds the attitude."""
        loops, dynamics, R = self._loops, self.loops.dynamics, state.rotation
        along = along_path(motion, view)
        velocity, flow = along.velocity @ R, current @ R
        push = dynamics.total_mass[:3, :3] @ (velocity / loops.velocity_time + along.acceleration @ R)
        rest = np.concatenate([demanded[:3], -disturbance[3:]])
        rest[:3] -= dynamics.steady_wrenches((reference.velocity - flow)[None], R[2:])[0, :3]

        def demand(paces: Vector) -> Matrix:
            fewer = (paces - 1.0)[:, None]
            steady = dynamics.steady_wrenches(
                reference.velocity - flow + fewer * velocity, np.broadcast_to(R[2], (len(paces), 3))
            )
            return steady + rest + fewer * np.concatenate([push, np.zeros(3)])

        return demand

    def _allowed(self, wrenches: Matrix) -> Flags:
        """Whether wrenches (q,6) can be made, as far as they lie in the range of A."""
        budget, left = self.capability.budget, self.capability
        assert budget is not None
        return budget.allows(left.project_onto_range(wrenches), self._force_ratio)

    def _watch_shortage(self, enough: bool, dt: float) -> None:
        """Turn to where the thrusters have more when they have been short for a while, and back when they are not."""
        self._short_s = 0.0 if enough else self._short_s + dt
        if self._short_s > PATIENCE_S:
            self._pressed = True
        elif (
            self._pressed and self._balanced is not None and not self._balanced.short and self._balanced.off < BACK_RAD
        ):
            self._pressed = False

    def _rest(self, applied: Vector) -> Vector:
        """What was not made of the last demand (6,), bounded: what a dead zone swallows is asked for again."""
        rest = np.zeros(6) if self._asked is None else self._asked - applied
        size = float(np.linalg.norm(rest[:3]))
        return rest * min(1.0, self.most_rest / max(size, 1e-12))

    def _mode(self, state: State) -> AttitudeMode:
        """Who says which attitude to take."""
        if self.capability.steers_by_attitude or self._pressed:
            if self._balanced is None:
                self._balanced = BalancedAttitude(
                    self.capability,
                    self.loops.dynamics,
                    state.rotation,
                    self.balancing_time * (SLOWER_AT_TRIM if self.capability.authority is Authority.TRIM else 1.0),
                    self.attitude if self._goal is None else self._goal.attitude,
                    most_rate=self.loops.most_rate,
                )
            return self._balanced
        self._balanced = None
        return self.attitude if self._goal is None else self._goal.attitude

    def _secondary(self, wrench: Vector) -> Vector:
        """The part (6,) of a wrench that gives way to the path: none where the attitude has to point the thrust.

        None under a cost limit that takes directions away, either: with only a share of the secondary part the wrench
        would have a component along them again.
        """
        if not self.path_first or self.capability.steers_by_attitude or self.capability.within_cost_limit is not None:
            return np.zeros(6)
        return split_path_first(wrench, self.loops.dynamics.total_mass).secondary

    def _unknowns(self, state: State, applied: Vector, dt: float) -> tuple[Vector, Vector]:
        """The estimated disturbance and current: what the current explains is taken out of the disturbance."""
        observer, flow = self.observer, self.current_observer
        current = np.zeros(3) if flow is None else flow.estimate
        if observer is None:
            return np.zeros(6), current
        disturbance = observer.update(state, applied, current, dt)
        return disturbance, current if flow is None else flow.update(state, disturbance, dt)
