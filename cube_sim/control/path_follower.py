"""Path following in 3-D for a vehicle that commands all six axes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from cube_sim.control.attitude import AttitudeMode
from cube_sim.control.authority import Authority, Capability, capability
from cube_sim.control.controller import Decision
from cube_sim.control.disturbance import DisturbanceObserver
from cube_sim.control.loops import MotionLoops
from cube_sim.control.thrust_attitude import PointThrust
from cube_sim.guidance.approach import Approach
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.spatial import State, Vector


@dataclass
class PathFollower:
    """Virtual target -> approach velocity and attitude -> loops -> wrench, less the estimated disturbance.

    Attributes:
        target: the virtual target on the path.
        approach: the desired velocity.
        attitude: the desired attitude.
        loops: desired motion to wrench.
        pointing_time: over which `PointThrust` averages the demanded force [s].
        observer: the disturbance estimate, None for none.
        capability: what the thrusters can still do; demands are projected onto it.
    """

    target: VirtualTarget
    approach: Approach
    attitude: AttitudeMode
    loops: MotionLoops
    pointing_time: float
    observer: DisturbanceObserver | None
    capability: Capability = field(default_factory=lambda: capability(np.eye(6)))
    _pointing: PointThrust | None = None
    _force: Vector = field(default_factory=lambda: np.zeros(3))

    def reconfigure(self, left: Capability, state: State) -> None:
        """Go on with what is left: point it, or, when nothing can be pointed, stop demanding force."""
        self.capability = left
        if left.authority in (Authority.PLANE, Authority.LINE):
            heading = float(np.arctan2(state.rotation[1, 0], state.rotation[0, 0]))
            self._pointing = PointThrust(left.pure_forces, heading, self.pointing_time)
        else:
            self._pointing = None

    def decide(self, state: State, applied: Vector, dt: float) -> Decision:
        """See `Controller.decide`."""
        view = self.target.view(state.position, state.rotation @ state.velocity)
        motion = self.approach.motion(view)
        mode = self.attitude if self._pointing is None else self._pointing
        attitude = mode.attitude(view, self._force, dt)
        wrench, reference = self.loops.wrench(state, motion, attitude)
        disturbance = np.zeros(6) if self.observer is None else self.observer.update(state, applied, dt)
        demanded = wrench - disturbance
        self._force = state.rotation @ demanded[:3]
        self.target.advance(view.speed, dt)
        return Decision(
            wrench=self.capability.attainable(demanded),
            disturbance=disturbance,
            view=view,
            remaining=view.remaining,
            velocity=reference.velocity,
            rates=reference.rates,
            quaternion=attitude.quaternion,
            attitude_error=reference.attitude_error,
            authority=self.capability.authority,
        )
