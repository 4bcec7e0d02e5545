"""Path following in 3-D with whatever the thrusters can still do."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import inf

import numpy as np

from cube_sim.control.along_path import AlongPath
from cube_sim.control.asked import MEMORY
from cube_sim.control.attitude_mode import DESIRED, AttitudeMode, DesiredAttitude, Situation
from cube_sim.control.authority import POINTING, Authority, Capability
from cube_sim.control.balanced_attitude import BalancedAttitude
from cube_sim.control.balancing import FARTHEST_RAD
from cube_sim.control.ceiling import Ceiling, keep_under_surface, lift
from cube_sim.control.compiled_parts import NEVER_BALANCED, CompiledParts, compiled_parts
from cube_sim.control.controller import Decision
from cube_sim.control.course_keeping import COURSE, CourseKeeping
from cube_sim.control.course_trim import CourseTrims
from cube_sim.control.current import CurrentObserver, told_of_water
from cube_sim.control.disturbance import DisturbanceObserver
from cube_sim.control.following import FOLLOWED, follow
from cube_sim.control.force_first import LITTLE_TORQUE, TORQUE, ForceFirst, serve_force_first
from cube_sim.control.free_attitude import FreeAttitude
from cube_sim.control.holding import Holding, Stuck
from cube_sim.control.judged_capability import capability
from cube_sim.control.loops import MotionLoops
from cube_sim.control.moment_budget import NOTHING_MOVES, MomentBudget
from cube_sim.control.oscillation_centre import CENTRE, begin_centre, see_centre, watch_centre
from cube_sim.control.pace import LEAST_PACE, NO_BUDGET
from cube_sim.control.priority import force_with_torque, yield_attitude
from cube_sim.control.refuge import KeptMotion, Refuge
from cube_sim.control.resting import Rest, nearest_rest
from cube_sim.control.roomiest_attitude import has_enough
from cube_sim.control.safe_mode import CLOSE_M, POINTING_M, LossOfTargetMonitor, SafeMode, SafeModeGoal
from cube_sim.control.shortage import SHORTAGE, watch_shortage
from cube_sim.control.slowed_loops import slowed_approach, slowed_loops
from cube_sim.control.steering_by_fins import keep_course
from cube_sim.control.thrown import LoopSpeeds
from cube_sim.guidance.approach import Approach
from cube_sim.guidance.law import DesiredMotion, MotionLaw, Target, TargetView
from cube_sim.guidance.view_record import record_of, see_level, view_of
from cube_sim.spatial import Matrix, Record, State, Vector, rotation_from_quaternion
from cube_sim.tuples import turned_to_world

BALANCING = 0.6
"""Share of the time of the attitude's loop in which the balance of force and torque is sought, where it points the
thrust; where roll or pitch is left to the water, all of it."""
RESTING = 0.9
"""Share of their force with which thrusters hold a hull at rest in an attitude that it is to come to (a choice)."""
OVERPOWERED = "in no attitude can the others make up for what is stuck"
"""Words for that."""
UNDER_WAY_RAD = 0.7
"""Farther than this from that attitude a hull is on its way there; to be short of force on the way will pass."""


@dataclass
class PathFollower:
    """Virtual target -> approach velocity and attitude -> loops -> wrench; disturbance and current are estimated.

    Attributes:
        target: the target on the path.
        approach: the desired velocity.
        attitude: the desired attitude.
        loops: desired motion to wrench.
        pointing_time: of the attitude's loop, where the attitude points the thrust [s].
        observer: the disturbance estimate, None for none.
        current_observer: reads that estimate; None to take the water to be at rest.
        safe_mode: what to do when the path cannot be followed.
        most_rest: how much of a force and of a torque that could not be made is asked for again at the next tick (2,)
            [N, N m].
        speed: along the path [m/s], for which that time is found; 0 leaves it as it is.
        radius: of the tightest turn of the path [m]; infinite where it has none.
        waits: whether the speed along the path falls to what the thrusters can keep.
        capability: what the thrusters can still do; demands are projected onto it.
        limits_move: whether what the thrusters can make follows inflow and voltage, see `moment`.
        ceiling: what the hull lacks near the surface, above which it is not asked; None in endless water.
        fins_speed: that at which it is known what the fins make [m/s]; 0 where none steer it.
        path_first: whether the attitude gives way to the path when the thrusters cannot serve both. Where the attitude
            has to point the thrust, it never does.
    """

    target: Target
    approach: MotionLaw
    attitude: AttitudeMode
    loops: MotionLoops
    pointing_time: float
    observer: DisturbanceObserver | None
    current_observer: CurrentObserver | None
    safe_mode: SafeMode
    most_rest: Vector = field(default_factory=lambda: np.zeros(2))
    speed: float = 0.0
    radius: float = inf
    waits: bool = True
    capability: Capability = field(default_factory=lambda: capability(np.eye(6)))
    path_first: bool = False
    limits_move: bool = False
    ceiling: Ceiling | None = None
    fins_speed: float = 0.0

    def __post_init__(self) -> None:
        """Fly with what the thrusters can do from the start."""
        self.memory: Record = np.zeros(1, MEMORY)
        self.centre: Record = np.zeros(1, CENTRE)
        self.shortage: Record = np.zeros(1, SHORTAGE)
        self.desired: Vector = np.array([1.0, 0.0, 0.0, 0.0])
        self._goal: SafeModeGoal | None = None
        self._holding: Holding | None = None
        self._rests = False
        self.balanced: BalancedAttitude | None = None
        self.monitor = LossOfTargetMonitor(self.safe_mode)
        self.coupling = force_with_torque(self.loops.dynamics.total_mass)
        self.reconfigure(self.capability)

    def reconfigure(self, left: Capability) -> None:
        """Go on with what is left: steer by attitude, or, when that cannot follow a path, keep to the safe mode."""
        if self.limits_move and left.budget is not None:
            left = replace(left, budget=left.budget.made_to_move())
        self.capability = left
        self.balanced, self._loops, self._approach = None, self.loops, self.approach
        self.refuge, self._holding = Refuge(), None
        budget, turned = left.budget, left.turned
        self._left = left.record(self.loops.dynamics.total_mass)
        keeping = None
        if isinstance(self.attitude, AlongPath):  # any other attitude is one that the thrust is pointed in
            keeping = CourseKeeping.of(left, self.loops.dynamics, self.fins_speed)
        self.course: Record = np.zeros(1, COURSE) if keeping is None else keeping.record(self.loops.attitude_time)
        self.dragged = bool(self._left["dragged"].any()) and keeping is None
        self._budget = NO_BUDGET if budget is None else (budget.normals, budget.bounds, budget.held_shares)
        if left.authority is Authority.HOLONOMIC and left.held.any():
            # A thruster has stuck: whether the others have enough beside it is seen at once.
            wished = rotation_from_quaternion(self.desired)
            self.shortage["pressed"] |= not has_enough(*self.kept(1.0), wished)
        wish = rotation_from_quaternion(self.desired)
        self.overpowered = bool(left.held.any()) and not self._rest(wish, 1.0).held
        self._first = None
        if self.force_first and budget is not None:
            rests = left.level or self._rest(wish, RESTING).held
            alone = TORQUE if rests else LITTLE_TORQUE
            counts = (False, alone) if turned is None else (True, turned.torque)
            self._first = ForceFirst.of(budget, self.coupling, *counts)
        close = POINTING_M if left.steers_by_attitude else CLOSE_M
        self.monitor.look_closely(close if self.overpowered and turned is None else None)
        if left.authority is not Authority.SAFE:
            if self._goal is not None:
                self.monitor.restart()
            self._goal = None
        elif self._goal is not None:
            self._goal.set_reason(left.reason)
        if keeping is not None:
            self._approach = slowed_approach(self.approach, keeping, self.loops.attitude_time)
        else:
            trims_at = self.speed if self.dragged else 0.0
            self._loops, self._approach = slowed_loops(
                left, self.loops, self.approach, self.pointing_time, self.radius, trims_at
            )
        self._compiled = compiled_parts(
            self, self._approach, self._loops.record, self._left, self._budget, self._first, self.dragged
        )

    def take_up(self, other: PathFollower) -> None:
        """See `GoesOn.take_up`."""
        self.target, self.approach, self.attitude = other.target, other.approach, other.attitude
        self.pointing_time, self.speed, self.radius, self.waits = (
            other.pointing_time,
            other.speed,
            other.radius,
            other.waits,
        )
        self.path_first, self._goal = other.path_first, None
        self.fins_speed = other.fins_speed
        self.monitor = LossOfTargetMonitor(self.safe_mode)
        self.shortage = np.zeros(1, SHORTAGE)
        self.centre = np.zeros(1, CENTRE)
        self.reconfigure(self.capability)

    @property
    def most_up(self) -> float:
        """The force straight up that the thrusters make, the hull upright, beside what is stuck [N]."""
        return lift(*self._budget, 1.0)

    @property
    def highest(self) -> float:
        """The height that the thrusters hold it at, at the full share of their force [m]; inf where none is."""
        return inf if self.ceiling is None else self.ceiling.highest(self.most_up)

    @property
    def moment(self) -> MomentBudget:
        """What of it follows the limits of the thrusters, where they move."""
        return NOTHING_MOVES if self.capability.budget is None else self.capability.budget.moving

    def view(self, state: State) -> TargetView:
        """See `Controller.view`."""
        return self.target.view(state.position, turned_to_world(state.rotation, state.velocity))

    def decide(self, state: State, applied: Vector, dt: float, force_ratio: float = 1.0) -> Decision:
        """See `Controller.decide`."""
        seen = self._seen(state)
        view = self.view(state) if seen is None else view_of(seen)
        goal = self._safe_mode_goal(state, view, force_ratio, dt)
        mode = self._mode(state, force_ratio)
        followed = np.zeros(1, FOLLOWED)
        if seen is not None and goal is None and self._compiled is not None:
            quaternion = self._compiled.answer(self, seen, followed, state, applied, dt, force_ratio)
            disturbance, current = self._estimates()
        else:
            motion = self._motion(state, view, goal, dt, force_ratio)
            disturbance, current = self._unknowns(state, applied, dt)
            situation = self._situation(state, view, current, force_ratio)
            attitude = mode.attitude(situation, dt)
            if self.dragged and self.balanced is not None:
                begin_centre(self._left, self.centre, state.rotation, state.quaternion, self.balanced.wished)
            if self.refuge.taken:
                self._look_back(situation, dt)
            quaternion = attitude.quaternion
            if self.keeps_course:
                quaternion = self._keep_course(followed, state, view, goal, motion, disturbance, current, dt)
            else:
                self._follow(followed, state, view, goal, motion, attitude, disturbance, current, applied, force_ratio)
            self._rests = goal is not None and goal.afloat(state.position)
            if self._rests or (self._holding is not None and self._holding.left_alone):
                followed["wrench"] = self.capability.held
            elif self._first is not None:
                normals, _, held_shares = self._budget
                serve_force_first(self._first, normals, held_shares, force_ratio, followed["wrench"][0])
        answer = followed[0]
        if self.budgeted:
            balanced = NEVER_BALANCED if self.balanced is None else self.balanced.memory
            watch_shortage(self.shortage, bool(answer["enough"]), self.balanced is not None, balanced, dt)
        if goal is None:
            self.target.advance(view.speed, dt)
        self.desired = quaternion
        return Decision(
            wrench=answer["wrench"],
            secondary=self._secondary(answer["wrench"], state),
            disturbance=disturbance,
            current=current,
            view=view,
            remaining=view.remaining,
            velocity=answer["velocity"],
            rates=answer["rates"],
            quaternion=quaternion,
            attitude_error=float(answer["attitude_error"]),
            authority=self.capability.authority if goal is None else Authority.SAFE,
            pace=float(answer["pace"]),
            given_up="" if goal is None else goal.reason,
            fins_water=self.course["water"][0].copy() if self.keeps_course else None,
        )

    def _seen(self, state: State) -> Record | None:
        """The view as compiled laws read it; None from a target that only Python asks."""
        seen = getattr(self.target, "seen", None)
        return None if seen is None else seen(state.position, turned_to_world(state.rotation, state.velocity))

    def _estimates(self) -> tuple[Vector, Vector]:
        """The disturbance and the current as they are estimated."""
        return self.disturbance, self.current.copy()

    def loop_speeds(self, delay_s: float) -> LoopSpeeds:
        """The times of the loops that fly now, behind a delay [s]."""
        loops, observer = self._loops, self.observer
        learns = inf if observer is None else observer.time
        return LoopSpeeds(loops.velocity_time, loops.attitude_time, loops.rate_time, learns, delay_s)

    def _follow(
        self,
        followed: Record,
        state: State,
        view: TargetView,
        goal: SafeModeGoal | None,
        motion: DesiredMotion,
        attitude: DesiredAttitude,
        disturbance: Vector,
        current: Vector,
        applied: Vector,
        force_ratio: float,
    ) -> None:
        """The law itself, its answer into `followed`."""
        desired = np.zeros(1, DESIRED)
        desired[0] = tuple(attitude)
        follow(
            self.loops.dynamics.record,
            self._loops.record,
            self._left,
            *self._budget,
            self.memory,
            followed,
            state.rotation,
            state.quaternion,
            state.velocity,
            state.rates,
            *motion,
            desired,
            disturbance,
            current,
            record_of(view if goal is None else view._replace(speed=0.0)),
            applied,
            force_ratio,
            self.most_rest,
            self.budgeted,
            goal is None and self.waits and isinstance(self._approach, Approach),
            self._approach.least_closing if goal is None and isinstance(self._approach, Approach) else 1.0,
            self.balanced is not None,
            float(self.shortage["since"][0]),
        )

    def _keep_course(
        self,
        followed: Record,
        state: State,
        view: TargetView,
        goal: SafeModeGoal | None,
        motion: DesiredMotion,
        disturbance: Vector,
        current: Vector,
        dt: float,
    ) -> Vector:
        """The law of a vehicle that its fins steer, its answer into `followed`; the attitude wanted (4,)."""
        desired = np.zeros(1, DESIRED)
        keep_course(
            self.loops.dynamics.record,
            self.course,
            self._loops.record,
            self.memory,
            followed,
            desired,
            record_of(view),
            state.rotation,
            state.quaternion,
            state.velocity,
            state.rates,
            *motion,
            disturbance,
            current,
            dt,
            goal is not None,
        )
        return desired["quaternion"][0]

    def _motion(
        self, state: State, view: TargetView, goal: SafeModeGoal | None, dt: float, ratio: float
    ) -> DesiredMotion:
        """The desired motion of the hull, or of its centre of oscillation where turning pushes it."""
        there = view
        if goal is None and self.capability.level:
            level = record_of(view)
            see_level(level)
            view = view_of(level)
        if not self.dragged:
            if goal is not None:
                return goal.motion(state.position)
            return self._below(self._approach.motion(view), there, ratio)
        time = self._loops.velocity_time
        seen = record_of(view if goal is None else view._replace(speed=0.0))
        watch_centre(self._left, self.centre, state.rotation, state.rates, seen, dt, time)
        shift, pushed = self.centre["shift"][0], self.centre["pushed"][0]
        if goal is None:
            see_centre(seen, self.centre)
            motion = self._below(self._approach.motion(view_of(seen)), there, ratio)
        else:
            motion = goal.motion(state.position - shift)
        return DesiredMotion(motion.velocity, motion.acceleration + pushed / time)

    def _below(self, motion: DesiredMotion, view: TargetView, ratio: float) -> DesiredMotion:
        """The same, no higher than the hull can be held."""
        if self.ceiling is None:
            return motion
        below = DesiredMotion(*(np.array(each, dtype=np.float64) for each in motion))
        keep_under_surface(self.ceiling.table, *self._budget, ratio, record_of(view), *below, self._loops.velocity_time)
        return below

    def _situation(self, state: State, view: TargetView, current: Vector, force_ratio: float) -> Situation:
        """What the attitude may depend on."""
        before = self.memory[0]
        return Situation(
            view,
            state.rotation,
            before["force"].copy(),
            before["torque"].copy(),
            current,
            self.capability.effort,
            force_ratio,
            before["velocity"].copy(),
        )

    def _safe_mode_goal(self, state: State, view: TargetView, force_ratio: float, dt: float) -> SafeModeGoal | None:
        """Where to go instead of along the path, once there is a reason to; only other thrusters end it."""
        if self._goal is None:
            lost = self.capability.reason if self.capability.authority is Authority.SAFE else ""
            reason = lost or self.monitor.reason(view, dt)
            if reason and self.overpowered:
                reason = f"{reason}; {OVERPOWERED}"
            self._goal = SafeModeGoal(self.safe_mode, state, reason) if reason else None
        if self._goal is not None and self.safe_mode.surface is None and self.capability.held.any():
            self._hold(self._goal, state, force_ratio, dt)
        return self._goal

    def _hold(self, goal: SafeModeGoal, state: State, force_ratio: float, dt: float) -> None:
        """Hold a place beside what is stuck, or let go where that is better."""
        budget, before = self.capability.budget, self._holding
        if budget is None or self.capability.turned is not None:
            return
        off = goal.off_m(state.position)
        if before is not None:
            before.watch(off, dt)
            if not before.over:
                return
        points, rest = self.capability.authority in POINTING, self._rest(state.rotation, force_ratio)
        stuck = Stuck.of(budget, self.loops.dynamics, rest, state, self.current, points)
        self._holding = Holding.first(stuck, off) if before is None else before.next(stuck, off)
        if before is not None or self._holding.attitude is not None:
            self.balanced, self.refuge = None, Refuge()  # what it sought before has led nowhere
        if self._holding.left_alone != (before is not None and before.left_alone):
            goal.say_left_alone(self._holding.left_alone)

    def _rest(self, near: Matrix, force_ratio: float) -> Rest:
        """Where the hull rests beside what is stuck."""
        budget = self.capability.budget
        if budget is None:
            return Rest(near, self.capability.held, False)
        return nearest_rest(self.loops.dynamics.record, budget, force_ratio, -self.current, near)

    @property
    def disturbance(self) -> Vector:
        """The wrench (6,) that the model does not explain [N, N m], body axes, as estimated; zero where it is not."""
        return np.zeros(6) if self.observer is None else self.observer.memory["estimate"][0].copy()

    @property
    def current(self) -> Vector:
        """The current (3,) as it is estimated [m/s], world axes; zero where nobody estimates it."""
        return np.zeros(3) if self.current_observer is None else self.current_observer.estimate

    def _mode(self, state: State, force_ratio: float) -> AttitudeMode:
        """Who says which attitude to take."""
        if self._goal is not None and self._held_in is not None and not self.capability.steers_by_attitude:
            self.balanced = None
            return self._held_in
        if self.keeps_course:
            self.balanced = None
            return self._wish
        chosen = self.refuge.taken or self.balanced is not None or self.capability.steers_by_attitude
        if self.pressed and not chosen and self._is_under_way(state, force_ratio):
            self.shortage["since"], self.shortage["pressed"] = 0.0, False
        if self.pressed and not chosen:
            self.refuge.seek(self.kept(force_ratio), state.rotation, rotation_from_quaternion(self.desired))
        if self.refuge.attitude is not None:
            return self.refuge.attitude
        if self.capability.steers_by_attitude or self.pressed:
            if self.balanced is None:
                self.balanced = self._balanced_from(state.rotation)
            elif self.balanced.stale and self._goal is None:
                self.balanced = self._judged_again(self.balanced, state.rotation)
            return self.balanced
        self.balanced = None
        return self._wish

    @property
    def _wish(self) -> AttitudeMode:
        """The attitude that would be taken if the thrusters could make anything."""
        if self._goal is None:
            return self.attitude
        return self._goal.attitude if self._held_in is None else self._held_in

    @property
    def _held_in(self) -> AttitudeMode | None:
        """The attitude in which a place is held beside what is stuck; None for no other than usual."""
        return None if self._holding is None else self._holding.attitude

    def _balanced_from(self, rotation: Matrix) -> BalancedAttitude:
        """A search for balance that begins in an attitude."""
        return BalancedAttitude(
            self.capability,
            self.loops.dynamics,
            rotation,
            self._loops.attitude_time * (1.0 if self.capability.authority is Authority.TRIM else BALANCING),
            self._wish,
            most_rate=self._loops.most_rate,
        )

    def _judged_again(self, balanced: BalancedAttitude, rotation: Matrix) -> BalancedAttitude:
        """The same with the wish that suits its course, or a search that begins anew where that is far from before."""
        judged, before = balanced.memory[0], balanced.trim
        course = float(judged["speed"]), float(judged["climb"])
        trims = CourseTrims.of(self.capability, self.loops.dynamics, *course, self.pointing_time)
        radius = inf if balanced.judged else self.radius  # one under way stays in the trim that it has come to
        trim = None if trims is None else trims.nearest(judged["course_wish"], before, radius)
        old, new = (judged["course_wish"] if R is None else R for R in (before, trim))
        following = balanced
        if np.trace(old.T @ new) < 1.0 + 2.0 * np.cos(FARTHEST_RAD):
            following = self._balanced_from(rotation)
        following.wish_for(trim, judged)
        return following

    def _is_under_way(self, state: State, force_ratio: float) -> bool:
        """Whether the hull is far from the attitude its mission asks for, and the thrusters have enough once there.

        One that is free, which leads the hull from where it lies, asks in the end for an upright one.
        """
        there = rotation_from_quaternion(self.desired)
        if isinstance(self._wish, FreeAttitude) and not self.capability.held.any():
            there = self._wish.upright(there)
        far = np.trace(there.T @ state.rotation) < 1.0 + 2.0 * np.cos(UNDER_WAY_RAD)
        return bool(far) and has_enough(*self.kept(force_ratio), there)

    def _look_back(self, situation: Situation, dt: float) -> None:
        """Leave the refuge once it is no more of use."""
        back = self._wish.attitude(situation, dt).quaternion
        if self.refuge.look_back(self.kept(situation.force_ratio), back, self.shortage["since"][0] != 0.0):
            self.shortage["pressed"] = False

    def kept(self, force_ratio: float) -> KeptMotion:
        """The motion at the least pace."""
        flow_W = LEAST_PACE * self.memory["velocity"][0] - self.current
        return KeptMotion(self.loops.dynamics.record, self._budget, force_ratio, flow_W)

    def _secondary(self, wrench: Vector, state: State) -> Vector:
        """The part (6,) of a wrench that gives way to the path: none where the attitude has to point the thrust.

        None under a cost limit that takes directions away, either: with only a share of the secondary part the wrench
        would have a component along them again. Where the hull has turned to where the thrusters have enough, that
        attitude is held first, and what is to move it is what gives way.
        """
        if self.force_first or self._rests or (self._holding is not None and self._holding.left_alone):
            return np.zeros(6)
        if self.refuge.taken or (self._held_in is not None and not self.capability.steers_by_attitude):
            still = self.loops.dynamics.steady_wrenches(np.zeros((1, 3)), state.rotation[2:])[0]
            return np.concatenate([wrench[:3] - still[:3], np.zeros(3)])
        secondary = np.zeros(6)
        if self.attitude_yields:
            yield_attitude(self.coupling, wrench, secondary)
        return secondary

    @property
    def force_first(self) -> bool:
        """Whether the force comes before the torque: beside what is stuck, where it is all there in any attitude."""
        left = self.capability
        if left.within_cost_limit is not None or left.authority in (*POINTING, Authority.SAFE):
            return False
        return bool(left.held.any())

    @property
    def keeps_course(self) -> bool:
        """Whether its fins steer it: its heading follows the course, and nothing is pointed."""
        return bool(self.course["steered"][0])

    @property
    def points(self) -> bool:
        """Whether its attitude points the thrust, whatever else."""
        return self.capability.steers_by_attitude and not self.keeps_course

    @property
    def budgeted(self) -> bool:
        """Whether the wrench asked for is compared with what the thrusters make: one that is turned round takes any."""
        known = self.capability.budget is not None and not self.keeps_course
        return known and self.capability.authority is not Authority.TURNED

    @property
    def smeared_time(self) -> float:
        """The time over which what the current is read off is smeared where the hull is turned round [s], else 0."""
        return 0.0 if self.observer is None or self.capability.turned is None else self.observer.time

    @property
    def pressed(self) -> bool:
        """Whether the thrusters have been short for so long that the vehicle turns to where they have more."""
        return bool(self.shortage["pressed"][0]) and self.budgeted

    @property
    def ready(self) -> CompiledParts | None:
        """What one compiled call a tick goes on with as it stands; None where Python has something to say."""
        taken = self.refuge.taken
        balanced = self.points or (self.pressed and not taken)
        if self._goal is not None or (self.balanced is not None) != balanced:
            return None
        if taken and not self.force_first:
            return None  # what is to move the hull gives way to the attitude there
        if self.balanced is not None and self.balanced.stale:
            return None
        return self._compiled

    @property
    def attitude_yields(self) -> bool:
        """Whether the attitude gives way to the path where the thrusters cannot serve both."""
        left = self.capability
        asked = self.path_first and not self.force_first
        return asked and not left.steers_by_attitude and left.within_cost_limit is None

    def _unknowns(self, state: State, applied: Vector, dt: float) -> tuple[Vector, Vector]:
        """The estimated disturbance and current: what the current explains is taken out of the disturbance."""
        observer, flow = self.observer, self.current_observer
        current = np.zeros(3) if flow is None else flow.estimate
        if observer is None:
            return np.zeros(6), current
        disturbance = observer.update(state, applied, current, dt)
        if flow is None:
            return disturbance, current
        return disturbance, flow.update(state, disturbance, dt * told_of_water(tuple(state.rates), self.smeared_time))
