"""What a flight is made of, as the compiled loop reads it: arrays in the memory of the objects in Python."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.fin_shares import FinParts
from cube_sim.control.diagnosis import Window
from cube_sim.control.moment_budget import MomentBudget
from cube_sim.control.probing import ProbeMemory
from cube_sim.guidance.path_record import Parts as PathParts
from cube_sim.guidance.speed import Parts as SpeedParts
from cube_sim.navigation.estimating import NavigationMemory, NavigationParameters
from cube_sim.spatial import Matrix, Record, Vector
from cube_sim.vehicle.laws.inflow import Inflow
from cube_sim.vehicle.laws.propeller_power import DrivenPropellers
from cube_sim.vehicle.laws.voltage_law import VoltageTables

Indices = NDArray[np.int_]


class Engine(NamedTuple):
    """MuJoCo's model and data.

    Attributes:
        model: address of the mjModel.
        data: address of the mjData.
        text: (`TEXT_BYTES`,) of `cube_sim.vehicle.plugin.guard`, MuJoCo's words when it cannot go on.
        time: (1,) of it [s].
        warnings: (w,) how often it has warned of each kind.
        qpos: MuJoCo's, like all that follow but the last three.
        qvel: of it.
        qacc: of it.
        xpos: of it.
        xmat: of it.
        xquat: of it.
        geom_xpos: of it.
        geom_xmat: of it.
        ctrl: of it.
        act: of it.
        actuator_force: of it.
        hull: (3,) where the hull's pose and its velocity begin, and its body.
        steps: of the physics per tick.
        classical: whether they are Runge-Kutta's of fourth order.
        period: of a tick [s].
        shared: whether others fly in the same data: whoever flies all of them calls `forward` before, and steps.
    """

    model: int
    data: int
    text: NDArray[np.uint8]
    time: Vector
    warnings: NDArray[np.int32]
    qpos: Vector
    qvel: Vector
    qacc: Vector
    xpos: Matrix
    xmat: Matrix
    xquat: Matrix
    geom_xpos: Matrix
    geom_xmat: Matrix
    ctrl: Vector
    act: Vector
    actuator_force: Vector
    hull: Indices
    steps: int
    classical: bool
    period: float
    shared: bool


class Hull(NamedTuple):
    """What is seen of the hull beside its motion.

    Attributes:
        geoms: (g,) of `top_of`, like the next three.
        radii: (g,) of it.
        centres: (g,3) of it.
        halves: (g,3) of it.
        surface: of it.
        wind: (3,) the steady current [m/s], world axes.
        sheared: whether there is a table of currents.
        times: (n_t,) of `velocity_at`, like the next two.
        heights: (n_z,) of it.
        velocities: (n_t n_z,3) of it.
        pushed: whether something pushes it.
        pushes: (n,k) of `push_wrench`.
        number: of the hull among them.
    """

    geoms: Indices
    radii: Vector
    centres: Matrix
    halves: Matrix
    surface: float
    wind: Vector
    sheared: bool
    times: Vector
    heights: Vector
    velocities: Matrix
    pushed: bool
    pushes: Matrix
    number: float


class Feed(NamedTuple):
    """The thrusters and what feeds them.

    Attributes:
        actuators: (m,) indices into ctrl and actuator_force.
        activations: (m,) indices into act.
        curves: table of `cube_sim.vehicle.laws.curve_table`, like the next.
        starts: (m,) of it.
        packed: of `drawn_power`, like the next three.
        efficiency_at: of it.
        stuck_at: of it.
        coefficients: of it.
        power: (m,) [W] at the tick before; moved on.
        supply: record of `cube_sim.vehicle.laws.supply_law.SUPPLY`, moved on.
        supply_at: (m,) of `feed_at`.
        searched: of `cube_sim.vehicle.power_supply.PowerSupply`.
        tables: curves that follow the voltage, moved on.
        driven: what propellers draw by their torques, moved on.
        efficiency: (m,) true share of its force that each gives.
    """

    actuators: Indices
    activations: Indices
    curves: Vector
    starts: NDArray[np.int64]
    packed: Vector
    efficiency_at: NDArray[np.int64]
    stuck_at: NDArray[np.int64]
    coefficients: Matrix
    power: Vector
    supply: Record
    supply_at: NDArray[np.int64]
    searched: bool
    tables: VoltageTables
    driven: DrivenPropellers
    efficiency: Vector


class FinServos(NamedTuple):
    """The fins that servos turn.

    Attributes:
        steered: whether there are any.
        actuators: (n,) indices into ctrl.
        activations: (n,) indices into act.
        parts: of `cube_sim.allocation.fin_shares.steer_fins`.
        deflections: (n,) scratch, like all that follow.
        wanted: (n,) deflections asked for [rad].
        made: (6,) what they make [N, N m].
        rest: (6,) what is left of the wrench for the thrusters.
    """

    steered: bool
    actuators: Indices
    activations: Indices
    parts: FinParts
    deflections: Vector
    wanted: Vector
    made: Vector
    rest: Vector


class FaultWatch(NamedTuple):
    """What thruster faults are found by.

    Attributes:
        watched: whether they are looked for.
        window: of the forces, moved on.
        probes: of the thrusters, moved on.
        telemetry_gain: (m,) measured forces are the true ones times these,
        noise: (n,m) and these [N] beside, a row each tick; (0,m) for none.
    """

    watched: bool
    window: Window
    probes: ProbeMemory
    telemetry_gain: Vector
    noise: Matrix


class Sensing(NamedTuple):
    """What the controller's state is estimated by.

    Attributes:
        navigated: whether it is.
        parameters: of `cube_sim.navigation.estimating.estimate`, like the next.
        memory: of it, moved on.
        answers: (n,) of `ESTIMATE`, filled, like all that follow.
        errors: (n,) of `ERROR`.
        inertial: (n,9) readings of the inertial unit.
        arrived: (n,k) of `cube_sim.navigation.reading.READING`.
        counts: (n,) how many of these there are.
    """

    navigated: bool
    parameters: NavigationParameters
    memory: NavigationMemory
    answers: Record
    errors: Record
    inertial: Matrix
    arrived: Record
    counts: NDArray[np.int64]


class Course(NamedTuple):
    """The target on its path.

    Attributes:
        path: arguments of `cube_sim.guidance.path_record.path_row`.
        target: record of `cube_sim.guidance.target_record.TARGET`.
        plan: of `speed_at`, the speed of a clocked target.
        loss: record of `cube_sim.control.safe_mode.LOSS`, moved on.
        shortage: record of `cube_sim.control.shortage.SHORTAGE`, moved on.
        steers: whether the attitude is balanced in any case.
        arc_length: (1,) of the target [m], moved on.
    """

    path: PathParts
    target: Record
    plan: SpeedParts
    loss: Record
    shortage: Record
    steers: bool
    arc_length: Vector


class Answering(NamedTuple):
    """Which law it is, and what comes after it.

    Attributes:
        in_plane: whether it is the planar one.
        coupling: (3,3) of `yield_attitude`.
        yields: whether the attitude gives way to the path.
        authority: code of how the vehicle flies.
        applied: (6,) wrench allocated over the tick before [N, N m]; moved on.
        quaternion: (4,) the attitude wanted at the last tick, out.
        state: (22,) known at the last tick, out.
    """

    in_plane: bool
    coupling: Matrix
    yields: bool
    authority: float
    applied: Vector
    quaternion: Vector
    state: Vector


class Moment(NamedTuple):
    """What follows the limits of the thrusters where these move.

    Attributes:
        inflow: at them, moved on.
        budget: of the controller, moved on.
        margin: share by which the allocation takes dead zones to be wider.
    """

    inflow: Inflow
    budget: MomentBudget
    margin: float


class Notes(NamedTuple):
    """What is looked at after the ticks, a row each.

    Attributes:
        answers: of `answer_of`; one row alone, written again and again, where nobody looks at them.
        demands: (n,6) that the search was asked for.
        pace: (n,) share of the speed along the path.
        force_ratio: (n,) share of their force that the thrusters gave.
        limits: (n,m,4) of whole thrusters [N], where they move; none else.
        effort: (2,) nodes looked at and answers not proven, counted on.
        told: (3,) of `cube_sim.native.published`: how many ticks are flown, for whoever looks meanwhile; whether
            to fly no more, for whoever flies; and which condition has stopped the flight.
    """

    answers: Matrix
    demands: Matrix
    pace: Vector
    force_ratio: Vector
    limits: NDArray[np.float64]
    effort: NDArray[np.int64]
    told: NDArray[np.int64]
