"""Path following in 3-D for a vehicle that commands all six axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.control.attitude import AttitudeMode
from cube_sim.control.controller import Decision
from cube_sim.control.disturbance import DisturbanceObserver
from cube_sim.control.loops import MotionLoops
from cube_sim.guidance.approach import Approach
from cube_sim.guidance.path import Path
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.spatial import State, Vector


@dataclass
class PathFollower:
    """Virtual target -> approach velocity and attitude -> loops -> wrench, less the estimated disturbance.

    Attributes:
        path: the path.
        target: the virtual target on it.
        approach: the desired velocity.
        attitude: the desired attitude.
        loops: desired motion to wrench.
        observer: the disturbance estimate, None for none.
    """

    path: Path
    target: VirtualTarget
    approach: Approach
    attitude: AttitudeMode
    loops: MotionLoops
    observer: DisturbanceObserver | None

    def decide(self, state: State, applied: Vector, dt: float) -> Decision:
        """See `Controller.decide`."""
        view = self.target.view(state.position, state.rotation @ state.velocity)
        motion = self.approach.motion(view, self.path.length)
        attitude = self.attitude.attitude(view, dt)
        wrench, reference = self.loops.wrench(state, motion, attitude)
        disturbance = np.zeros(6) if self.observer is None else self.observer.update(state, applied, dt)
        self.target.advance(view.speed, dt)
        return Decision(
            wrench=wrench - disturbance,
            disturbance=disturbance,
            view=view,
            remaining=self.path.length - view.arc_length,
            velocity=reference.velocity,
            rates=reference.rates,
            quaternion=attitude.quaternion,
            attitude_error=reference.attitude_error,
        )
