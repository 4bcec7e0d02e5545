"""What becomes of a vehicle when one of its thrusters dies or sticks: what ``cube-sim analyze --stuck`` finds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cube_sim.actuation import PathRequirements, analyse
from cube_sim.commands.stuck_flight import BesideFaults, ReadModel, where_stuck
from cube_sim.control.authority import Authority, Capability
from cube_sim.control.force_first import LITTLE_TORQUE
from cube_sim.control.foreseen import Foreseen
from cube_sim.control.holding import LOOKED_AHEAD_S, carried_off_m
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.left_alone import carried_m
from cube_sim.control.loop_times import USUAL_PERIOD_S, LoopTimes, angular_acceleration, mean_delay
from cube_sim.control.pace import LEAST_PACE
from cube_sim.control.resting import nearest_rest
from cube_sim.control.thrown import LoopSpeeds, share_asked, thrown_by
from cube_sim.control.transient import Transient, keeps, transient
from cube_sim.control.turned_round import LOOKED_AHEAD_S as TURNED_FOR_S
from cube_sim.control.turned_round import NEAR_M, wanders_m
from cube_sim.control.yielding import WaterHold
from cube_sim.mission.ability import with_fins
from cube_sim.mission.fault_finding import found_within_s
from cube_sim.spatial import Vector
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.health import Health

OBSERVER_S = 1.0
"""Time of the observer of the disturbance in a scenario that does not say."""
UP = np.array([0.0, 0.0, 1.0])


class Fault(NamedTuple):
    """A thruster that is dead, or stuck at a force [N]."""

    thruster: str
    force_N: float | None = None  # noqa: N815 - N is the newton


@dataclass(frozen=True)
class FaultCase:
    """A vehicle beside one fault.

    Attributes:
        fault: it.
        authority: how the vehicle goes on.
        left: what is left, in words.
        follows: whether it still follows a path at the speed asked for, or slower down to a quarter of it.
        reason: why not; empty where it does.
        tilt_rad: of the attitude in which it is held, or least is missing.
        rest_m_s: at what speed it is carried off where it is to stay in a place: 0 where it is held.
        alone_m_s: the same with all thrusters off but what is stuck.
        found_s: by when the fault is found, at the speed asked for [s].
        transient: of a flight at that speed, level and nose ahead.
        transient_at_rest: of one that stays in a place, level.
        foreseen: how far the first leaves its path, by its law flown ahead; None where it is not.
        foreseen_at_rest: the same of the other.
    """

    fault: Fault
    authority: Authority
    left: str
    follows: bool
    reason: str
    tilt_rad: float
    rest_m_s: float
    alone_m_s: float
    found_s: float
    transient: Transient
    transient_at_rest: Transient
    foreseen: Foreseen | None = None
    foreseen_at_rest: Foreseen | None = None


def every_fault(vehicle: Vehicle, gone: tuple[str, ...] = ()) -> list[Fault]:
    """Each thruster dead, and stuck at half of either of its limits and at the limits."""
    faults = []
    for name, (low, _, _, high) in zip(vehicle.thrusters.names, vehicle.thrusters.limits.tolist(), strict=True):
        if name not in gone:
            faults += [Fault(name), *(Fault(name, force) for force in where_stuck(low, high))]
    return faults


def fault_cases(
    vehicle: Vehicle,
    speed_m_s: float,
    *,
    faults: list[Fault] | None = None,
    lost: tuple[str, ...] = (),
    cost_limit: float | None = None,
    read: ReadModel | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[FaultCase, ...]:
    """Judge single faults, in still water.

    Args:
        vehicle: whose thrusters fail.
        speed_m_s: of the path.
        faults: to judge; default `every_fault`.
        lost: names of thrusters that are dead already.
        cost_limit: see `cube_sim.control.judged_capability.capability`.
        read: the model that the vehicle is of, to fly it ahead; None not to.
        progress: called with (cases done, all cases).
    """
    asked = every_fault(vehicle, lost) if faults is None else faults
    beside, cases = _Beside(vehicle, speed_m_s, lost, cost_limit, read), []
    for fault in asked:
        cases.append(beside.case(fault))
        if progress is not None:
            progress(len(cases), len(asked))
    return tuple(cases)


class _Beside:
    """A vehicle on its way, and what is the same of it beside every fault."""

    def __init__(
        self,
        vehicle: Vehicle,
        speed_m_s: float,
        lost: tuple[str, ...],
        cost_limit: float | None,
        read: ReadModel | None,
    ) -> None:
        thrusters, hull = vehicle.thrusters, vehicle.dynamics
        self._vehicle, self._hull, self._names = vehicle, hull, thrusters.names
        self._A, self._limits, self._lost, self._cost_limit = (
            vehicle.actuation_matrix,
            thrusters.limits,
            lost,
            cost_limit,
        )
        self._fins = None if vehicle.fins is None else vehicle.fins.at_speed(speed_m_s)
        self._hold, self._speed = WaterHold.of(hull, speed_m_s, None if self._fins is None else (0.0,)), speed_m_s
        self._velocity = np.array([speed_m_s, 0.0, 0.0])
        self._health = Health.whole(len(self._names))
        for name in lost:
            if name in self._names:
                self._health = self._health.with_thruster(self._names.index(name), 0.0)
            elif vehicle.fins is not None and self._fins is not None:
                self._fins.limits[vehicle.fins.names.index(name)] = 0.0
        self._whole = self._left(self._health)
        delay = mean_delay(vehicle.lag_s, USUAL_PERIOD_S)
        A, limits, _ = with_fins(self._A, self._limits, self._health, self._fins)
        turning = angular_acceleration(A, limits, hull.total_mass[3:, 3:], hull.righting_moment)
        times = LoopTimes.behind(delay, turning, self._whole.authority in (Authority.PLANE, Authority.LINE))
        self._loops = LoopSpeeds(times.velocity, times.attitude, times.rate, OBSERVER_S, delay)
        self._verdicts: dict[str, tuple[bool, str]] = {}
        self._on_its_way, self._in_place = (
            None if read is None else BesideFaults(read, vehicle, self._whole, speed_m_s, in_place, cost_limit)
            for in_place in (False, True)
        )

    def case(self, fault: Fault) -> FaultCase:
        """What becomes of it beside a fault."""
        index, stuck = self._names.index(fault.thruster), np.nan if fault.force_N is None else fault.force_N
        left = self._left(self._health.with_thruster(index, 0.0, stuck))
        found, on_its_way = self._transient(left, index, fault, self._velocity)
        tilt, rest, alone = self._at_rest(left)
        if left.turned is not None:
            far = max(left.turned.wanders_m, left.turned.level_m)
            rest = 0.0 if far <= NEAR_M else far / TURNED_FOR_S
        follows, reason = self._follows(left, fault)
        given = 0.0 if fault.force_N is None else fault.force_N
        resting, at_rest = self._transient(left, index, fault, np.zeros(3))
        return FaultCase(
            fault=fault,
            authority=left.authority,
            left=left.reason,
            follows=follows,
            reason=reason,
            tilt_rad=tilt,
            rest_m_s=rest,
            alone_m_s=alone,
            found_s=found,
            transient=on_its_way,
            transient_at_rest=at_rest,
            foreseen=None if self._on_its_way is None else self._on_its_way.foreseen(index, given, left, found),
            foreseen_at_rest=None if self._in_place is None else self._in_place.foreseen(index, given, left, resting),
        )

    def _left(self, health: Health) -> Capability:
        judged = with_fins(self._A, self._limits, health, self._fins)
        return remaining_capability(*judged, self._cost_limit, self._hold)

    def _transient(self, left: Capability, index: int, fault: Fault, velocity: Vector) -> tuple[float, Transient]:
        """By when the fault is found, and the bound of the transient, level and nose ahead."""
        given = 0.0 if fault.force_N is None else fault.force_N
        A, limits = self._A * self._health.responsive, self._limits[:, (0, 3)]
        wrench = self._whole.project_onto_range(self._hull.steady_wrenches(velocity[None], UP[None])[0])
        steady = float(share_asked(A)[index] @ wrench)
        # What a dead zone makes of a small force lies on either side of it.
        zone = 2.0 * float(np.abs(self._limits[:, 1:3]).max(initial=0.0))
        slowest, worst = 0.0, None
        for asked in (steady - zone, steady + zone):
            found = found_within_s(self._vehicle.thrusters, asked, given, USUAL_PERIOD_S)
            time = found + self._loops.delay  # until the others have made up for it
            made, mass = self._whole.onto_range[0], self._hull.total_mass
            thrown = thrown_by(mass, A, limits, made, index, (asked, given), self._loops, time)
            each = transient(left, self._hull, self._loops, thrown, np.eye(3), velocity, np.zeros(3))
            worst = each if worst is None or each.bound_m > worst.bound_m else worst
            slowest = max(slowest, found)
        assert worst is not None
        return slowest, worst

    def _at_rest(self, left: Capability) -> tuple[float, float, float]:
        """The tilt where it is held or nearly so [rad], the speed at which it is carried off, and that left alone."""
        nu, still = np.zeros(6), np.zeros(3)
        alone = float(carried_m(self._hull.record, left.held, np.eye(3), nu, still, LOOKED_AHEAD_S)[-1])
        if keeps(left, self._hull, np.eye(3), still):
            return 0.0, 0.0, alone / LOOKED_AHEAD_S
        if left.budget is None:
            return 0.0, alone / LOOKED_AHEAD_S, alone / LOOKED_AHEAD_S
        rest = nearest_rest(self._hull.record, left.budget, 1.0, still, np.eye(3))
        carried = 0.0 if rest.held else carried_off_m(self._hull, left.budget, rest, LOOKED_AHEAD_S)
        if carried > 0.0 and left.authority in (Authority.HOLONOMIC, Authority.TRIM):
            # The force comes first: it may stay where it is, turned about.
            near = wanders_m(self._hull, left.budget, LITTLE_TORQUE) <= NEAR_M
            carried = 0.0 if near else carried
        tilt = float(np.arccos(np.clip(rest.attitude[2, 2], -1.0, 1.0)))
        return tilt, carried / LOOKED_AHEAD_S, alone / LOOKED_AHEAD_S

    def _follows(self, left: Capability, fault: Fault) -> tuple[bool, str]:
        """Whether the path is followed without the thruster, and what it holds is made up for on the way."""
        if left.turned is not None:
            kept = left.turned.wanders_m <= NEAR_M
            return kept, "" if kept else left.turned.words
        if fault.thruster not in self._verdicts:
            fins = () if self._vehicle.fins is None else self._vehicle.fins.names
            A, limits, _ = with_fins(self._A, self._limits, self._health, self._fins)
            verdict = analyse(
                A,
                limits,
                names=(*self._names, *fins),
                lost=(*self._lost, fault.thruster),
                hull=self._hull,
                requirements=PathRequirements(speed_m_s=self._speed, nose_ahead=bool(fins)),
                cost_limit=self._cost_limit,
            ).verdict
            self._verdicts[fault.thruster] = verdict.follows, verdict.reason
        follows, reason = self._verdicts[fault.thruster]
        if not follows or fault.force_N is None:
            return follows, "" if follows else reason
        if left.authority is Authority.SAFE or left.budget is None:
            return False, left.reason
        flow = LEAST_PACE * self._velocity
        if keeps(left, self._hull, np.eye(3), flow):
            return True, ""
        if nearest_rest(self._hull.record, left.budget, 1.0, flow, np.eye(3)).held:
            return True, ""
        return False, "in no attitude can the others make up for what is stuck"
