"""The planar dynamic law as a controller of a vehicle in MuJoCo."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.control.authority import Authority, Capability
from cube_sim.control.controller import Decision
from cube_sim.control.planar.attainable_set import PlanarAttainableSet
from cube_sim.control.planar.dynamic import DesiredSpeed, DynamicLaw, Water
from cube_sim.control.planar.kinematic import KinematicLaw
from cube_sim.control.planar.model import PlanarCurrent, PlanarMotion
from cube_sim.control.planar.observer import PlanarObserver
from cube_sim.control.planar.path_view import heading, plane_view
from cube_sim.control.planar.short_of_torque import ShortOfTorque, torque_share
from cube_sim.guidance.law import TargetView
from cube_sim.guidance.speed import SpeedProfile
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.spatial import State, Vector, quaternion_from_euler

IN_PLANE = [0, 1, 5]
"""Surge, sway and yaw among the components of a wrench."""


@dataclass
class PlanarFollower:
    """Follows a level path with a force ahead and a torque about the vertical; depth, roll and pitch are left alone.

    It steers by moving ahead, so it does not stop. After the end of a path it runs on along the last tangent.

    Attributes:
        target: the virtual target on the path; its gain is the law's k2.
        profile: u_d along the path; its rate of change is fed forward, the rate of that is not.
        law: equation (6).
        observer: what it reckons with of the water.
        attainable: what the thrusters can make of its demand.
        waits: whether speed is given up while torque is short.
    """

    target: VirtualTarget
    profile: SpeedProfile
    law: DynamicLaw
    observer: PlanarObserver
    attainable: PlanarAttainableSet
    waits: bool = True

    def __post_init__(self) -> None:
        """Fly with the thrusters of the hull as built."""
        self._authority, self._given_up = Authority.UNICYCLE, ""
        self._short = ShortOfTorque()

    def reconfigure(self, left: Capability) -> None:
        """Go on while there is a force that comes without a torque; then the other direction steers."""
        self._authority = Authority.UNICYCLE if left.pure_forces.shape[1] else Authority.SAFE
        self._given_up = "" if left.pure_forces.shape[1] else f"{left.reason}; it drifts"

    def view(self, state: State) -> TargetView:
        """See `Controller.view`."""
        return self.target.view(state.position, state.rotation @ state.velocity)

    def decide(self, state: State, applied: Vector, dt: float, force_ratio: float = 1.0) -> Decision:
        """See `Controller.decide`."""
        view = self.view(state)
        motion = PlanarMotion(float(state.velocity[0]), float(state.velocity[1]), float(state.rates[2]))
        psi_B = heading(state.rotation)
        water = self.observer.update(psi_B, motion, applied[IN_PLANE], dt)
        flow = self.law.flow(motion, water.current)
        path = plane_view(view, psi_B + flow.side_slip)
        if view.remaining <= 0.0:
            path = path._replace(c_c=0.0, g_c=0.0)  # the path goes on straight
        speed = self.wanted_speed(view.arc_length, water.current, view.speed)
        command = self.law.command(motion, path, speed, water)
        planned = self.profile.at(view.arc_length).value
        F, Gamma = self.attainable.saturate(command.F, command.Gamma, torque_share(motion.u, planned))
        if self.waits:
            self._short.update(motion.u, planned, command.Gamma, Gamma, dt)
        k1, k2 = self.law.gains.k1, self.law.gains.k2
        kinematic = KinematicLaw(self.law.model, self.law.approach, k1, k2)
        wanted = kinematic.command(flow, path, water.current, water.dv)
        error = self.law.kinematics(motion, path, DesiredSpeed(speed.value), water).error
        self.target.advance(view.speed, dt)
        follows = self._authority is not Authority.SAFE
        return Decision(
            wrench=np.array([F, 0.0, 0.0, 0.0, 0.0, Gamma]) if follows else np.zeros(6),
            secondary=np.zeros(6),
            disturbance=self._disturbance(water),
            current=np.append(self.observer.current, 0.0),
            view=view,
            remaining=view.remaining,
            velocity=np.array([speed.value, 0.0, 0.0]),
            rates=np.array([0.0, 0.0, wanted.r]),
            quaternion=quaternion_from_euler(0.0, 0.0, psi_B - error),
            attitude_error=abs(error),
            authority=self._authority,
            given_up=self._given_up,
        )

    def wanted_speed(self, arc_length: float, current: PlanarCurrent, target_speed: float) -> DesiredSpeed:
        """u_d over ground: as planned, less what is given up for want of torque.

        Through the water it is no slower than the water itself: a hull that is slower than the current cannot head up
        against it when its path turns.

        Args:
            arc_length: of the target [m].
            current: of the water.
            target_speed: s' [m/s], at which the plan goes by.
        """
        planned, least, share = self.profile.at(arc_length), current.u + current.speed, self._short.share
        if share * planned.value < least:
            return DesiredSpeed(least)
        return DesiredSpeed(share * planned.value, share * planned.slope * target_speed)

    def _disturbance(self, water: Water) -> Vector:
        """What the model does not explain, as a wrench (6,) [N, N m]."""
        model = self.law.model
        result = np.zeros(6)
        result[IN_PLANE] = model.m_u * water.du, model.m_v * water.dv, model.m_r * water.dr
        return result
