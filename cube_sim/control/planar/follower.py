"""The planar dynamic law as a controller of a vehicle in MuJoCo."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.control.attitude_mode import DESIRED
from cube_sim.control.authority import Authority, Capability
from cube_sim.control.controller import Decision
from cube_sim.control.following import FOLLOWED
from cube_sim.control.moment_budget import NOTHING_MOVES, MomentBudget
from cube_sim.control.planar.attainable_set import PlanarAttainableSet
from cube_sim.control.planar.dynamic import DesiredSpeed, DynamicLaw
from cube_sim.control.planar.model import PlanarCurrent
from cube_sim.control.planar.observer import PlanarObserver
from cube_sim.control.planar.short_of_torque import ShortOfTorque
from cube_sim.control.planar.steering import ESTIMATED, SETTINGS, PlanarParts, steer, wanted_speed
from cube_sim.control.planar.turning_profile import TurningParts
from cube_sim.guidance.law import TargetView
from cube_sim.guidance.speed import SpeedProfile
from cube_sim.guidance.view_record import view_of
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.spatial import State, Vector
from cube_sim.tuples import turned_to_world


@dataclass
class PlanarFollower:
    """Follows a level path with a force ahead and a torque about the vertical; depth, roll and pitch are left alone.

    It steers by moving ahead, so it does not stop. After the end of a path it runs on along the last tangent.

    Attributes:
        target: the virtual target on the path; its gain is the law's k2.
        profile: u_d along the path; one that has `parts`.
        law: equation (6).
        observer: what it reckons with of the water.
        attainable: what the thrusters can make of its demand.
        waits: whether speed is given up while torque is short.
        moment: what of it follows the limits of the thrusters, where they move.
    """

    target: VirtualTarget
    profile: SpeedProfile
    law: DynamicLaw
    observer: PlanarObserver
    attainable: PlanarAttainableSet
    waits: bool = True
    moment: MomentBudget = NOTHING_MOVES

    def __post_init__(self) -> None:
        """Fly with the thrusters of the hull as built."""
        self.authority, self._given_up = Authority.UNICYCLE, ""
        self.parts = PlanarParts(
            settings=np.array([(self.waits, True)], SETTINGS),
            law=self.law.record,
            profile=TurningParts.of(self.profile),
            normals=self.attainable.normals,
            sizes=self.attainable.sizes,
            observer=self.observer.parts,
            short=ShortOfTorque().memory,
            estimated=np.zeros(1, ESTIMATED),
        )

    def take_up(self, other: PlanarFollower) -> None:
        """See `GoesOn.take_up`."""
        self.target, self.profile, self.law, self.waits = other.target, other.profile, other.law, other.waits
        self.moment = other.moment
        self.observer.expect(other.observer)
        follows = self.parts.settings["follows"][0]
        self.parts = other.parts._replace(observer=self.observer.parts)
        self.parts.settings["follows"] = follows

    def reconfigure(self, left: Capability) -> None:
        """Go on while there is a force that comes without a torque; then the other direction steers."""
        follows = bool(left.pure_forces.shape[1])
        self.authority = Authority.UNICYCLE if follows else Authority.SAFE
        self._given_up = "" if follows else f"{left.reason}; it drifts"
        self.parts.settings["follows"] = follows

    def view(self, state: State) -> TargetView:
        """See `Controller.view`."""
        return self.target.view(state.position, turned_to_world(state.rotation, state.velocity))

    def decide(self, state: State, applied: Vector, dt: float, force_ratio: float = 1.0) -> Decision:
        """See `Controller.decide`."""
        seen = self.target.seen(state.position, turned_to_world(state.rotation, state.velocity))
        desired, followed = np.zeros(1, DESIRED), np.zeros(1, FOLLOWED)
        steer(self.parts, seen, desired, followed, state.rotation, state.velocity, state.rates, applied, dt)
        view, answer, estimated = view_of(seen), followed[0], self.parts.estimated[0]
        self.target.advance(view.speed, dt)
        return Decision(
            wrench=answer["wrench"],
            secondary=np.zeros(6),
            disturbance=estimated["disturbance"].copy(),
            current=estimated["current"].copy(),
            view=view,
            remaining=view.remaining,
            velocity=answer["velocity"],
            rates=answer["rates"],
            quaternion=desired["quaternion"][0],
            attitude_error=float(answer["attitude_error"]),
            authority=self.authority,
            given_up=self._given_up,
        )

    def wanted_speed(self, arc_length: float, current: PlanarCurrent, target_speed: float) -> DesiredSpeed:
        """u_d over ground at an arc length [m]; the other arguments as in `wanted_speed`."""
        planned = self.profile.at(arc_length)
        share = float(self.parts.short["share"][0])
        return wanted_speed(planned.value, planned.slope, share, current, target_speed)
