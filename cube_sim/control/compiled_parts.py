"""What a `PathFollower` is made of, ready for one compiled call a tick."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cube_sim.control.along_path import MEMORY as SIDE
from cube_sim.control.along_path import AlongPath
from cube_sim.control.answering import SETTINGS, WANTING, LawParts, answer
from cube_sim.control.asked import MEMORY as ASKED
from cube_sim.control.attitude_mode import DESIRED, AttitudeMode
from cube_sim.control.authority import CAPABILITY
from cube_sim.control.balancing import BALANCE
from cube_sim.control.balancing import MEMORY as BALANCED
from cube_sim.control.ceiling import NO_CEILING
from cube_sim.control.course_keeping import COURSE
from cube_sim.control.disturbance import MEMORY as DISTURBANCE
from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.force_first import NOT_FORCE_FIRST, ForceFirst
from cube_sim.control.free_attitude import EFFORT, FreeAttitude
from cube_sim.control.free_attitude import MEMORY as REST
from cube_sim.control.look_at import LOOK, LookAt
from cube_sim.control.look_at import MEMORY as SIGHT
from cube_sim.control.loops import LOOPS
from cube_sim.control.oscillation_centre import CENTRE
from cube_sim.control.own_law import OwnLawParts, no_own_law
from cube_sim.control.pace import NO_BUDGET, Facets
from cube_sim.control.refuge import REFUGE
from cube_sim.control.shortage import SHORTAGE
from cube_sim.control.wanted_attitude import ALONG_PATH, FIXED, FREE, LOOK_AT
from cube_sim.guidance.approach import APPROACH, Approach
from cube_sim.guidance.law import MotionLaw
from cube_sim.guidance.pursuit import PURSUIT, Pursuit
from cube_sim.guidance.speed import ConstantSpeed, Parts
from cube_sim.native.apart import finish
from cube_sim.spatial import Matrix, Record, State, Vector
from cube_sim.vehicle.laws.hull_motion import HULL

if TYPE_CHECKING:
    from cube_sim.control.path_follower import PathFollower


@dataclass(frozen=True)
class CompiledParts:
    """Arguments of `answer` that stay while the thrusters do.

    Attributes:
        settings: record `SETTINGS`.
        law: hull, loops, what is left, normals, bounds and held shares, what the surface leaves, and those of the force
            served first.
        speed: of the profile.
        approach: record `APPROACH`.
        pursuit: record `PURSUIT`.
        mode: numbers of the attitudes that `LookAt` and `FreeAttitude` ask for; memories of those and of `AlongPath`.
        disturbance: memory of the observer.
        current: (3,) the estimate.
    """

    settings: Record
    law: tuple[Record, Record, Record, Matrix, Vector, Vector, Matrix, ForceFirst]
    speed: Parts
    approach: Record
    pursuit: Record
    mode: tuple[Record, Record, Record, Record, Record]
    disturbance: Record
    current: Vector

    def answer(
        self,
        follower: PathFollower,
        seen: Record,
        followed: Record,
        state: State,
        applied: Vector,
        dt: float,
        force_ratio: float,
    ) -> Vector:
        """One tick, its answer into `followed`; returns the desired attitude (4,)."""
        desired = np.zeros(1, DESIRED)
        motion = state.rotation, state.quaternion, state.velocity, state.rates
        told = applied, dt, force_ratio, attitude_address()
        answer(self.arguments(follower), seen, desired, followed, *motion, *told)
        return desired["quaternion"][0]

    def arguments(self, follower: PathFollower) -> LawParts:
        """What does not come from the tick, balanced or not as the follower's attitude is by now."""
        balanced = follower.balanced
        self.settings["balanced"] = balanced is not None
        return LawParts(
            self.settings,
            *self.law,
            *self.speed,
            self.approach,
            self.pursuit,
            NOT_BALANCED if balanced is None else balanced.parameters,
            *(NO_BUDGET if balanced is None else balanced.budget),
            *self.mode,
            self.disturbance,
            self.current,
            NEVER_BALANCED if balanced is None else balanced.memory,
            follower.centre,
            follower.memory,
            follower.refuge.memory,
            follower.shortage,
            follower.course,
            no_own_law(),
        )


KINDS: dict[type, int] = {AlongPath: ALONG_PATH, FixedAttitude: FIXED, LookAt: LOOK_AT, FreeAttitude: FREE}
NOT_BALANCED, NEVER_BALANCED = np.zeros(1, BALANCE), np.zeros(1, BALANCED)


def compiled_parts(
    follower: PathFollower,
    approach: MotionLaw,
    loops: Record,
    left: Record,
    budget: Facets,
    first: ForceFirst | None,
    dragged: bool,
) -> CompiledParts | None:
    """The parts of a follower; None where one of them is not of a kind that compiled laws read.

    Args:
        follower: whose memories they share.
        approach: the motion law it flies by now.
        loops: record of the loops it flies by now.
        left: record of what the thrusters can still do.
        budget: what they can make.
        first: by which the force is served before the torque; None where it is not.
        dragged: whether turning drags the hull along.
    """
    settings = np.zeros(1, SETTINGS)
    wanted = wanted_parts(follower.attitude, approach, follower.capability.effort, settings)
    mode = follower.attitude
    if wanted is None or (isinstance(mode, FreeAttitude) and mode.dynamics is not follower.loops.dynamics):
        return None
    observer, flow = follower.observer, follower.current_observer
    settings["dragged"], settings["budgeted"] = dragged, follower.budgeted
    settings["waits"] = follower.waits and isinstance(approach, Approach)
    settings["least_closing"] = approach.least_closing if isinstance(approach, Approach) else 1.0
    settings["most_rest"], settings["level"] = follower.most_rest, follower.capability.level
    settings["force_first"] = first is not None
    if observer is not None:
        settings["disturbance_time"] = observer.time
        settings["smeared_time"] = follower.smeared_time
        if flow is not None:
            settings["current_time"], settings["current_damping"] = flow.time, flow.damping
    return CompiledParts(
        settings=settings,
        law=(
            follower.loops.dynamics.record,
            loops,
            left,
            *budget,
            NO_CEILING if follower.ceiling is None else follower.ceiling.table,
            NOT_FORCE_FIRST if first is None else first,
        ),
        speed=wanted.speed,
        approach=wanted.approach,
        pursuit=wanted.pursuit,
        mode=wanted.mode,
        disturbance=np.zeros(1, DISTURBANCE) if observer is None else observer.memory,
        current=np.zeros(3) if flow is None else flow.estimate,
    )


class WantedParts(NamedTuple):
    """Motion law and attitude mode, as compiled laws read them.

    Attributes:
        speed: of the profile.
        approach: record `APPROACH`.
        pursuit: record `PURSUIT`.
        mode: numbers of the attitudes that `LookAt` and `FreeAttitude` ask for; memories of those and of `AlongPath`.
    """

    speed: Parts
    approach: Record
    pursuit: Record
    mode: tuple[Record, Record, Record, Record, Record]


def wanted_parts(mode: AttitudeMode, approach: MotionLaw, effort: Matrix, settings: Record) -> WantedParts | None:
    """What says which motion and attitude are wanted; None where that is not of a kind that compiled laws read.

    Args:
        mode: whose memories they share.
        approach: the motion law.
        effort: Q (6,6) of the thrusters that work.
        settings: record `SETTINGS`, told of both.
    """
    kind = KINDS.get(type(mode))
    if kind is None or type(approach) not in (Approach, Pursuit):
        return None
    speed: Parts | None = approach.speed_parts  # type: ignore[attr-defined]
    if speed is None:
        return None
    settings["pursuit"], settings["kind"] = isinstance(approach, Pursuit), kind
    if isinstance(mode, FreeAttitude):
        mode.reckon_with(effort)
    elif isinstance(mode, FixedAttitude):
        settings["attitude"] = mode.quaternion
    elif isinstance(mode, AlongPath):
        settings["levelling_time"] = mode.levelling_time
    return WantedParts(
        speed,
        approach.record if isinstance(approach, Approach) else np.zeros(1, APPROACH),
        approach.record if isinstance(approach, Pursuit) else np.zeros(1, PURSUIT),
        (
            mode.parameters if isinstance(mode, LookAt) else np.zeros(1, LOOK),
            mode.parameters if isinstance(mode, FreeAttitude) else np.zeros(1, EFFORT),
            mode.memory if isinstance(mode, AlongPath) else np.zeros(1, SIDE),
            mode.memory if isinstance(mode, LookAt) else np.zeros(1, SIGHT),
            mode.memory if isinstance(mode, FreeAttitude) else np.zeros(1, REST),
        ),
    )


def own_law_parts(
    own: OwnLawParts, mode: AttitudeMode, approach: MotionLaw, effort: Matrix, memory: Record
) -> LawParts | None:
    """The parts of a law of the user's own; None where motion or attitude are not of a kind that compiled laws read.

    Args:
        own: the law.
        mode: the attitude it is told, whose memories they share.
        approach: the motion law it is told.
        effort: Q (6,6) of the thrusters that work.
        memory: record of `cube_sim.control.asked.MEMORY`.
    """
    rest, settings = resting_law(), np.zeros(1, SETTINGS)
    wanted = wanted_parts(mode, approach, effort, settings)
    if wanted is None:
        return None
    looking, least, side, sight, still = wanted.mode
    profile, nodes, square = wanted.speed
    return rest._replace(
        settings=settings,
        hull=mode.dynamics.record if isinstance(mode, FreeAttitude) else rest.hull,
        profile=profile,
        nodes=nodes,
        square=square,
        approach=wanted.approach,
        pursuit=wanted.pursuit,
        looking=looking,
        effort=least,
        side=side,
        sight=sight,
        rest=still,
        memory=memory,
        own=own,
    )


@cache
def resting_law() -> LawParts:
    """Arguments of `answer` of the right types, for a flight that another law steers."""

    def zero(*kinds: np.dtype) -> list[Record]:
        return [np.zeros(1, kind) for kind in kinds]

    told, speed = zero(SETTINGS, HULL, LOOPS, CAPABILITY), ConstantSpeed(1.0).parts
    motion, modes = zero(APPROACH, PURSUIT, BALANCE), zero(LOOK, EFFORT, SIDE, SIGHT, REST, DISTURBANCE)
    parts = (
        *told,
        *NO_BUDGET,
        NO_CEILING,
        NOT_FORCE_FIRST,
        *speed,
        *motion,
        *NO_BUDGET,
        *modes,
        np.zeros(3),
        *zero(BALANCED, CENTRE, ASKED, REFUGE, SHORTAGE, COURSE),
        no_own_law(),
    )
    return LawParts._make(parts)


ATTITUDE = f"{__name__}:attitude_address"
"""What compiles the part of the law that wants an attitude, for `cube_sim.native.apart`."""


@cache
def attitude_address() -> int:
    """Where the code of `cube_sim.control.wanted_attitude.want_attitude` lies."""
    if not WANTING.on_disk:
        finish(ATTITUDE)
    return WANTING.address()
