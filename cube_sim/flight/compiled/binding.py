"""From the objects of a flight to the compiled loop, and back."""

from __future__ import annotations

from functools import cache

import mujoco
import numpy as np

from cube_sim.allocation.flown import FlownAllocator, SearchCodes
from cube_sim.control.diagnosis import Diagnosis
from cube_sim.control.path_follower import PathFollower
from cube_sim.flight.compiled.callees import ESTIMATING, SHARING, no_fins, nothing_sensed
from cube_sim.flight.compiled.loop import fly
from cube_sim.flight.compiled.parts import (
    Answering,
    Course,
    Engine,
    FaultWatch,
    Feed,
    FinServos,
    Hull,
    Moment,
    Notes,
    Sensing,
)
from cube_sim.flight.compiled.steering import Steering
from cube_sim.flight.compiled.stretch import FlyArguments, Stretch
from cube_sim.flight.rows import rows_for
from cube_sim.guidance.target_record import RunningParts
from cube_sim.mission import Mission
from cube_sim.mission.disturbance import pushes_of
from cube_sim.mission.moment import budget_of
from cube_sim.mission.setpoints import parts_of
from cube_sim.mission.surface_watch import Boxes
from cube_sim.native.compiled import prepare
from cube_sim.navigation.estimating import ERROR, ESTIMATE, NavigationMemory, NavigationParameters
from cube_sim.navigation.imu import INERTIAL
from cube_sim.navigation.reading import READING
from cube_sim.spatial import Vector
from cube_sim.vehicle.ballast import ballast_rows
from cube_sim.vehicle.carried_joints import places_of
from cube_sim.vehicle.current import current_table
from cube_sim.vehicle.laws.ballast import DENSITY
from cube_sim.vehicle.laws.push import COLUMNS
from cube_sim.vehicle.plugin import structs
from cube_sim.vehicle.plugin.guard import TEXT_BYTES, guards
from cube_sim.vehicle.plugin.packing import force_records, packed_parameters
from cube_sim.vehicle.pushes import hull_number

NO_PUSHES = np.zeros((0, COLUMNS))
NO_TABLE = np.zeros(1), np.zeros(1), np.zeros((1, 3))
LEAST_ARENA_BYTES = 1_000_000
"""With less, contacts may need more memory than there is; MuJoCo ends the process then, where nothing guards it."""
NO_CODES = 0, 0, 0, SearchCodes(0, 0, 0), 0, 0
NOTHING_WATCHED = Diagnosis(1.0, 1.0, 1.0, np.zeros(1))


def begin_ticks(
    mission: Mission, engine: Engine, tick: int, count: int, applied: Vector, boxes: Boxes, moving: bool = True
) -> Stretch | None:
    """Make ready to fly up to so many ticks, none of which has an event.

    Args:
        mission: whose parts are moved on.
        engine: of its physics.
        tick: number of the first one.
        count: how many.
        applied: (6,) wrench allocated over the tick before [N, N m].
        boxes: of the hull, which is under water.
        moving: whether the physics goes on after each.

    Returns:
        None where a part of it is of a kind that only Python flies.
    """
    found = _arguments(mission, engine, tick, count, applied, boxes, moving)
    if found is None:
        return None
    given, by, allocator = found
    navigating = estimating_address() if given.sensing.navigated else 0
    sharing = sharing_address() if given.fins.steered else 0
    codes = *by.addresses, allocator.codes(), navigating, sharing
    return Stretch(mission, allocator, by.target, given._replace(codes=codes))


def compile_loop(mission: Mission, boxes: Boxes) -> None:
    """Have the code of the loop alone, not of what it calls by its address.

    Args:
        mission: at its beginning, which compiled code can fly.
        boxes: of its hull.
    """
    found = _arguments(mission, engine_of(mission), 0, 1, np.zeros(6), boxes, True)
    if found is not None:
        prepare(fly, *found[0])


def _arguments(
    mission: Mission, engine: Engine, tick: int, count: int, applied: Vector, boxes: Boxes, moving: bool
) -> tuple[FlyArguments, Steering, FlownAllocator] | None:
    """Arguments of `fly` but for the addresses, and who knows these; None where only Python flies a part of it."""
    supply = mission.supply
    if supply.force_ratio == 0.0 or mission.drop_weight.dropped:
        return None
    if mission.inflow.varies and not mission.allocator.follows_limits:
        return None
    if mission.model.narena < LEAST_ARENA_BYTES and not guards():
        return None
    by = Steering.of(mission.controller)
    running: RunningParts | None = None if by is None else getattr(by.target, "parts", None)
    if by is None or running is None:
        return None
    path, evidence = getattr(by.target.path, "parts", None), _evidence(mission, count)  # type: ignore[attr-defined]
    flown = mission.allocator.flown(by.yields)
    sensing = _sensing(mission, count)
    if path is None or evidence is None or flown is None or sensing is None:
        return None
    allocator, thrusters = flown
    arc_length = np.array([by.target.arc_length])
    course = Course(path, *running, by.loss, by.shortage, by.steers, arc_length)
    answering = Answering(by.in_plane, by.coupling, by.yields, by.authority, applied.copy(), np.zeros(4), np.zeros(22))
    notes = Notes(
        answers=np.zeros((count if allocator.confirms else 1, allocator.answer_size)),
        demands=np.zeros((count, 6)),
        pace=np.zeros(count),
        force_ratio=np.zeros(count),
        limits=np.zeros((count if mission.inflow.varies else 0, len(mission.vehicle.thrusters.names), 4)),
        effort=np.zeros(2, np.int64),
        told=np.zeros(3, np.int64),
    )
    given = FlyArguments(
        NO_CODES,
        0,
        count,
        tick,
        engine if moving else engine._replace(steps=0),
        _hull(mission, boxes),
        _feed(mission),
        _fins(mission),
        parts_of(mission.setpoints, mission.data),
        places_of(mission.joints),
        evidence,
        sensing,
        course,
        by.law,
        by.planar,
        answering,
        thrusters,
        Moment(mission.inflow, budget_of(mission.controller), mission.scenario.allocation.dead_zone_margin),
        rows_for(mission.channels, count),
        notes,
        mission.stops.records,
    )
    return given, by, allocator


@cache
def estimating_address() -> int:
    """Where the code of the navigation lies; it is compiled only for those who navigate."""
    return ESTIMATING.address()


@cache
def sharing_address() -> int:
    """Where the code lies that shares wrenches with fins; it is compiled only for those who have some."""
    return SHARING.address()


def _fins(mission: Mission) -> FinServos:
    if mission.fins is None:
        return _no_fins()
    fins = mission.fins.fins
    n = len(fins.names)
    room = np.zeros(n), np.zeros(n), np.zeros(6), np.zeros(6)
    steer = isinstance(mission.controller, PathFollower) and mission.controller.keeps_course
    parts = mission.fins.parts(mission.allocator, mission.events.fins_told, steer)
    return FinServos(True, fins.actuators, fins.activations, parts, *room)


def _no_fins() -> FinServos:
    """Those of a vehicle that has none."""
    none, room = np.zeros(0, np.int_), (np.zeros(0), np.zeros(0), np.zeros(6), np.zeros(6))
    return FinServos(False, none, none, no_fins(), *room)


def _sensing(mission: Mission, count: int) -> Sensing | None:
    """What the state is estimated by; None before its first estimate."""
    estimation = mission.estimation
    if estimation is None:
        return _no_sensing()
    stage = estimation.stage(count)
    return None if stage is None else _sensing_by(stage, True, count)


@cache
def _no_sensing() -> Sensing:
    """That of a flight whose controller sees the true state."""
    return _sensing_by(nothing_sensed(), False, 0)


def _sensing_by(stage: tuple[NavigationParameters, NavigationMemory], navigated: bool, count: int) -> Sensing:
    k = len(stage[0].aids)
    return Sensing(
        navigated,
        *stage,
        np.zeros(count, ESTIMATE),
        np.zeros(count, ERROR),
        np.zeros((count, INERTIAL)),
        np.zeros((count, k), READING),
        np.zeros(count, np.int64),
    )


def engine_of(mission: Mission) -> Engine:
    """A mission's physics as compiled code sees it, which stays where it is as long as its data."""
    data, vehicle = mission.data, mission.vehicle
    return Engine(
        model=mission.model._address,
        data=data._address,
        text=np.zeros(TEXT_BYTES, np.uint8),
        time=structs.number(data, "time"),
        warnings=data.warning.number,
        qpos=data.qpos,
        qvel=data.qvel,
        qacc=data.qacc,
        xpos=data.xpos,
        xmat=data.xmat,
        xquat=data.xquat,
        geom_xpos=data.geom_xpos,
        geom_xmat=data.geom_xmat,
        ctrl=data.ctrl,
        act=data.act,
        actuator_force=data.actuator_force,
        hull=np.array([vehicle.qpos_address, vehicle.dof_address, vehicle.body]),
        steps=mission.scenario.steps_per_tick,
        classical=is_classical(mission.model),
        period=mission.scenario.control_period_s,
        shared=False,
    )


def is_classical(model: mujoco.MjModel) -> bool:
    """Whether a step is Runge-Kutta's of fourth order, and goes on from what `mj_forward` has found.

    What sees commands, an own force or a tank that is being filled, is not what it was when that ran: the tick's were
    not given yet.
    """
    compared = model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_FWDINV
    packed = packed_parameters(model)
    seen = any(force.sees for force in force_records(packed)) or any(ballast_rows(packed)[:, DENSITY] > 0.0)
    return model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4 and not compared and not seen


def _hull(mission: Mission, boxes: Boxes) -> Hull:
    table, pushes = current_table(mission.model), pushes_of(mission.scenario, mission.model)
    number = 0.0 if pushes is None else float(hull_number(mission.model, mission.vehicle.body))
    from_outside = pushes is not None, NO_PUSHES if pushes is None else pushes, number
    current = NO_TABLE if table is None else table
    return Hull(*boxes, mission.model.opt.wind, table is not None, *current, *from_outside)


def _feed(mission: Mission) -> Feed:
    supply, thrusters = mission.supply, mission.vehicle.thrusters
    return Feed(
        thrusters.actuators,
        thrusters.activations,
        *thrusters.curve_table,
        *supply.drawing,
        supply.power.copy(),
        supply.record,
        supply.supply_at,
        supply.searched,
        supply.tables,
        supply.driven,
        mission.events.health.efficiency,
    )


def _evidence(mission: Mission, count: int) -> FaultWatch | None:
    """What faults are found by; None where that takes Python at every tick."""
    found = mission.fault_finding
    if found is None:
        assert NOTHING_WATCHED.window is not None
        return FaultWatch(False, NOTHING_WATCHED.window, NOTHING_WATCHED.probes, np.zeros(1), np.zeros((0, 1)))
    evidence = found.evidence(count)
    return None if evidence is None else FaultWatch(True, *evidence)
