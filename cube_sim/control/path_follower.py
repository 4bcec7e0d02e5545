"""Path following in 3-D for a vehicle that commands all six axes."""

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
from cube_sim.guidance.law import MotionLaw, Target
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
    capability: Capability = field(default_factory=lambda: capability(np.eye(6)))
    path_first: bool = False
    _balanced: BalancedAttitude | None = None
    _force: Vector = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        """Fly with the loops as given."""
        self._loops = self.loops

    def reconfigure(self, left: Capability, state: State) -> None:
        """Go on with what is left: steer by attitude, or, when that cannot follow a path, stop demanding force."""
        self.capability = left
        self._balanced, self._loops = None, self.loops
        if left.authority in (Authority.PLANE, Authority.LINE):
            self._balanced = BalancedAttitude(left, self.loops.dynamics, state.rotation, self.balancing_time)
        if left.authority is Authority.LINE:
            # Force across the line has to wait for the attitude, so the velocity loop must be the slower one.
            slower = max(self.loops.velocity_time, 2.0 * self.loops.attitude_time)
            self._loops = replace(self.loops, velocity_time=slower)

    def decide(self, state: State, applied: Vector, dt: float) -> Decision:
        """See `Controller.decide`."""
        view = self.target.view(state.position, state.rotation @ state.velocity)
        motion = self.approach.motion(view)
        mode = self.attitude if self._balanced is None else self._balanced
        disturbance, current = self._unknowns(state, applied, dt)
        attitude = mode.attitude(Situation(view, state.rotation, self._force, current), dt)
        wrench, reference = self._loops.wrench(state, motion, attitude, current)
        demanded = wrench - disturbance
        self._force = state.rotation @ demanded[:3]
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
            authority=self.capability.authority,
        )

    def _secondary(self, wrench: Vector) -> Vector:
        """The part (6,) of a wrench that gives way to the path: none where the attitude has to point the thrust."""
        if not self.path_first or self._balanced is not None:
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
