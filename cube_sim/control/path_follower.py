"""Path following in 3-D with whatever the thrusters can still do."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from cube_sim.control.attitude import AttitudeMode, Situation
from cube_sim.control.authority import Authority, Capability, capability
from cube_sim.control.balanced_attitude import BalancedAttitude
from cube_sim.control.controller import Decision
from cube_sim.control.current import CurrentObserver
from cube_sim.control.disturbance import DisturbanceObserver
from cube_sim.control.loops import MotionLoops
from cube_sim.control.priority import path_first
from cube_sim.control.safe_mode import Refuge, SafeMode, Watch
from cube_sim.guidance.law import MotionLaw, Target
from cube_sim.guidance.virtual_target import TargetView
from cube_sim.spatial import State, Vector


@dataclass
class PathFollower:
    """Virtual target -> approach velocity and attitude -> loops -> wrench, with what is unknown estimated.

    Attributes:
        target: the target on the path.
        approach: the desired velocity.
        attitude: the desired attitude.
        loops: desired motion to wrench.
        balancing_time: of `BalancedAttitude` [s].
        observer: the disturbance estimate, None for none.
        current_observer: reads that estimate; None to take the water to be at rest.
        safe_mode: what to do when the path cannot be followed.
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
    capability: Capability = field(default_factory=lambda: capability(np.eye(6)))
    path_first: bool = False

    def __post_init__(self) -> None:
        """Fly with what the thrusters can do from the start."""
        self._force: Vector = np.zeros(3)
        self._refuge: Refuge | None = None
        self._balanced: BalancedAttitude | None = None
        self._watch = Watch(self.safe_mode)
        self.reconfigure(self.capability)

    def reconfigure(self, left: Capability) -> None:
        """Go on with what is left: steer by attitude, or, when that cannot follow a path, keep to the safe mode."""
        self.capability = left
        self._balanced, self._loops = None, self.loops
        if left.authority is not Authority.SAFE:
            self._refuge = None
        elif self._refuge is not None:
            self._refuge.because(left.reason)
        if left.authority in (Authority.LINE, Authority.UNICYCLE):
            # Force across the line has to wait for the attitude, so the velocity loop must be the slower one.
            slower = max(self.loops.velocity_time, 2.0 * self.loops.attitude_time)
            self._loops = replace(self.loops, velocity_time=slower)

    def decide(self, state: State, applied: Vector, dt: float) -> Decision:
        """See `Controller.decide`."""
        view = self.target.view(state.position, state.rotation @ state.velocity)
        refuge = self._seek_refuge(state, view, dt)
        motion = self.approach.motion(view) if refuge is None else refuge.motion(state.position)
        disturbance, current = self._unknowns(state, applied, dt)
        situation = Situation(view, state.rotation, self._force, current, self.capability.effort)
        attitude = self._mode(state).attitude(situation, dt)
        wrench, reference = self._loops.wrench(state, motion, attitude, current)
        demanded = wrench - disturbance
        self._force = state.rotation @ demanded[:3]
        if refuge is None:
            self.target.advance(view.speed, dt)
        attainable = self.capability.attainable(demanded)
        return Decision(
            wrench=attainable,
            secondary=self._secondary(attainable),
            disturbance=disturbance,
            current=current,
            view=view,
            remaining=view.remaining,
            velocity=reference.velocity,
            rates=reference.rates,
            quaternion=attitude.quaternion,
            attitude_error=reference.attitude_error,
            authority=self.capability.authority if refuge is None else Authority.SAFE,
            given_up="" if refuge is None else refuge.reason,
        )

    def _seek_refuge(self, state: State, view: TargetView, dt: float) -> Refuge | None:
        """Where to go instead of along the path, once there is a reason; only other thrusters end it."""
        if self._refuge is None:
            lost = self.capability.reason if self.capability.authority is Authority.SAFE else ""
            reason = lost or self._watch.reason(view, dt)
            self._refuge = Refuge(self.safe_mode, state, reason) if reason else None
        return self._refuge

    def _mode(self, state: State) -> AttitudeMode:
        """Who says which attitude to take."""
        if self.capability.steers_by_attitude:
            if self._balanced is None:
                self._balanced = BalancedAttitude(
                    self.capability, self.loops.dynamics, state.rotation, self.balancing_time
                )
            return self._balanced
        return self.attitude if self._refuge is None else self._refuge.attitude

    def _secondary(self, wrench: Vector) -> Vector:
        """The part (6,) of a wrench that gives way to the path: none where the attitude has to point the thrust.

        Nor where something is too dear: with only a share of the other part, the wrench would ask for that again.
        """
        if not self.path_first or self._balanced is not None or self.capability.cheap is not None:
            return np.zeros(6)
        dynamics = self.loops.dynamics
        return path_first(wrench, dynamics.mass_matrix + dynamics.added_mass).secondary

    def _unknowns(self, state: State, applied: Vector, dt: float) -> tuple[Vector, Vector]:
        """The estimated disturbance and current: what the current explains is taken out of the disturbance."""
        observer, flow = self.observer, self.current_observer
        current = np.zeros(3) if flow is None else flow.estimate
        if observer is None:
            return np.zeros(6), current
        disturbance = observer.update(state, applied, current, dt)
        return disturbance, current if flow is None else flow.update(state, disturbance, dt)
