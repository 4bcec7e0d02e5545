"""A loaded scenario turned into the objects the loop drives."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import mujoco
import numpy as np

from cube_sim.allocation import FaultTolerant
from cube_sim.control.authority import Capability
from cube_sim.control.controller import Controller
from cube_sim.control.path_follower import PathFollower
from cube_sim.guidance.path import Path
from cube_sim.mission.ability import Ability, speed_at_a_point
from cube_sim.mission.allocation import allocator_of
from cube_sim.mission.channels import PATH_POINTS, polyline, recorded_channels
from cube_sim.mission.control import controller_of
from cube_sim.mission.copying import packed, unpacked
from cube_sim.mission.drop_weight import DropWeight
from cube_sim.mission.events import Events
from cube_sim.mission.fault_finding import FaultFinding
from cube_sim.mission.fin_finding import FinFinding
from cube_sim.mission.fins import FinSteering, believed_fins, fins_at
from cube_sim.mission.hull import CompiledHull, believed_hull, flown_hull, initial_state
from cube_sim.mission.knowledge import believed_dynamics
from cube_sim.mission.moment import inflow_of
from cube_sim.mission.navigation import StateEstimation, motion_of
from cube_sim.mission.own.code import Codes, codes_of, refused
from cube_sim.mission.own.compiled_law import CompiledLaw
from cube_sim.mission.own.others import NOBODY, Others
from cube_sim.mission.own.sensor import own_sensors
from cube_sim.mission.path import path_of
from cube_sim.mission.phases import Phases, phases_of
from cube_sim.mission.refusals import require_a_value_per_thruster, require_possible_events, require_signals
from cube_sim.mission.sensor_faults import sensor_faults
from cube_sim.mission.setpoints import Setpoints, setpoints_of
from cube_sim.mission.stopping import Stops
from cube_sim.mission.supply import supply_of
from cube_sim.mission.water import initial_currents
from cube_sim.recording.channels import Channel
from cube_sim.scenario import Loaded, Scenario
from cube_sim.scenario.attitude_blocks import AlongPathBlock
from cube_sim.scenario.path_blocks import PythonPathBlock
from cube_sim.spatial import Matrix
from cube_sim.vehicle.carried_joints import CarriedJoints, carried_joints
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.fins import Fins
from cube_sim.vehicle.laws.inflow import Inflow
from cube_sim.vehicle.power_supply import PowerSupply
from cube_sim.vehicle.state import read_state
from cube_sim.vehicle.vehicle import Vehicle


@dataclass(frozen=True)
class Mission:
    """Everything a run needs, ready at time 0.

    Attributes:
        scenario: what was asked for.
        model: the compiled model with water.
        data: its state, at the scenario's initial condition.
        vehicle: the hull that follows the path.
        path: the path.
        ability: what its thrusters can do.
        controller: state to wrench.
        allocator: wrench to thruster forces.
        fins: wrench to deflections; None for a vehicle that has none.
        supply: what feeds the thrusters.
        events: what happens on the way.
        fault_finding: finds thruster faults; None when the scenario tells the controller, or lets it ignore them.
        fin_finding: finds faults of fins; None for a vehicle without, and as for those of thrusters.
        drop_weight: ballast that can be let go.
        estimation: makes the state the controller gets of sensors; None when it gets the true one.
        channels: what will be recorded.
        outline: (n,3) points on the whole path, evenly spaced [m], world axes.
        stops: what ends the flight before its time.
        phases: the legs of the mission; none where it has one path.
        setpoints: what the scenario tells other actuators; None where it tells none.
        joints: of what the hull carries; None where it carries nothing that moves.
        codes: code of the user's own, by the value in whose place it stands.
        inflow: what the thrusters can hold as the moment has it; see `cube_sim.mission.moment`.
    """

    scenario: Scenario
    model: mujoco.MjModel
    data: mujoco.MjData
    vehicle: Vehicle
    path: Path
    ability: Ability
    controller: Controller
    allocator: FaultTolerant
    fins: FinSteering | None
    supply: PowerSupply
    events: Events
    fault_finding: FaultFinding | None
    fin_finding: FinFinding | None
    drop_weight: DropWeight
    estimation: StateEstimation | None
    channels: tuple[Channel, ...]
    outline: Matrix
    stops: Stops
    phases: Phases
    inflow: Inflow
    setpoints: Setpoints | None = None
    joints: CarriedJoints | None = None
    codes: Codes = field(default_factory=dict)

    @property
    def fixed(self) -> dict[str, Any]:
        """What parts of it refer to and that never changes, by name."""
        fixed = {name: getattr(self, name) for name in ("scenario", "model", "data", "vehicle", "path", "ability")}
        sensors = self.estimation.own if self.estimation is not None else ()
        fixed |= {f"sensor {sensor.name}": sensor for sensor in sensors}
        if isinstance(self.controller, CompiledLaw):
            fixed["compiled law"] = self.controller.function
        return fixed | {f"code {key}": code for key, code in self.codes.items()}

    @property
    def force_ratio(self) -> float:
        """Share of the allocation's limits that the supply leaves the thrusters: all, where these follow the supply."""
        ratio = self.supply.force_ratio
        return 1.0 if self.inflow.varies and ratio > 0.0 else ratio

    def too_fast(self, left: Capability) -> str | None:
        """Words for a path beyond the critical speed of what is left of the vehicle; None for one that is not.

        That is the critical speed of the law for all axes, nose ahead.
        """
        nose_ahead = isinstance(self.scenario.control.attitude, AlongPathBlock)
        flown = nose_ahead and isinstance(self.controller, PathFollower)
        return self.ability.too_fast(left) if flown else None


def prepare(loaded: Loaded) -> Mission:
    """Build a mission; nothing is written.

    Raises:
        ScenarioError: the model does not fit the scenario; with position.
    """
    flown = flown_hull(loaded)
    return mission_of(loaded, flown, flown, initial_state(*flown, loaded.scenario))


def mission_of(
    loaded: Loaded, alone: CompiledHull, flown: CompiledHull, data: mujoco.MjData, others: Others = NOBODY
) -> Mission:
    """Build a mission of a hull that is compiled.

    Args:
        loaded: its scenario.
        alone: the hull in the model of its file.
        flown: the same in the model that flies, where others may be beside it.
        data: of that model, every hull at its initial condition.
        others: what code of the user's own sees of the vehicles beside it.

    Raises:
        ScenarioError: the model does not fit the scenario; with position.
    """
    scenario, codes = loaded.scenario, codes_of(loaded)
    safe_mode = scenario.control.safe_mode
    believed = believed_hull(loaded, alone)
    model, vehicle = flown
    path, outline = _path(loaded, codes)
    channels = recorded_channels(scenario, model, vehicle)
    require_signals(loaded, vehicle, channels)
    require_possible_events(loaded, vehicle)
    require_a_value_per_thruster(loaded, vehicle)
    finds = scenario.control.faults == "diagnosed"
    fins = believed_fins(believed.vehicle, scenario.knowledge)
    allocator = allocator_of(loaded, believed.vehicle, codes)
    dynamics = believed_dynamics(believed.vehicle.dynamics, scenario.knowledge, believed.vehicle.lift)
    ability = _ability(loaded, allocator, dynamics, path, believed.vehicle)
    phases = phases_of(loaded, believed, allocator, codes)
    if phases:
        outline = phases.outline(PATH_POINTS)
    supply = supply_of(loaded, model, vehicle)
    inflow = inflow_of(believed.vehicle.thrusters, supply)
    mujoco.mj_kinematics(model, data)
    start = motion_of(read_state(vehicle, data))
    faults = sensor_faults(scenario)
    events = Events(scenario, model, vehicle, faults)
    mission = Mission(
        scenario=scenario,
        model=model,
        data=data,
        vehicle=vehicle,
        path=path,
        ability=ability,
        controller=controller_of(loaded, believed, path, ability, codes, others),
        allocator=allocator,
        fins=FinSteering.of(vehicle, believed.vehicle, allocator, scenario),
        supply=supply,
        events=events,
        fault_finding=FaultFinding(flown, scenario, inflow) if finds else None,
        fin_finding=_fin_finding(fins, scenario, events) if finds else None,
        drop_weight=DropWeight(safe_mode.drop_weight_N, vehicle),
        estimation=StateEstimation.of(scenario, vehicle, path, own_sensors(loaded, codes, start), faults),
        channels=channels,
        outline=outline,
        stops=Stops(scenario, channels),
        phases=phases,
        inflow=inflow,
        setpoints=setpoints_of(scenario, model, vehicle),
        joints=carried_joints(model, vehicle.body, vehicle.thrusters.prefix),
        codes=codes,
    )
    if mission.phases:
        mission.phases.begin(mission.stops, 0.0)
    if codes.keys() & {"control.law", "control.attitude", "guidance.law"}:
        tried(loaded, mission)
    return mission


def _fin_finding(fins: Fins | None, scenario: Scenario, events: Events) -> FinFinding | None:
    return None if fins is None else FinFinding(fins, scenario.control_period_s, events.fins_told)


def _path(loaded: Loaded, codes: Codes) -> tuple[Path, Matrix]:
    """The path, and points on it; shared by flights along one of cube_sim's own."""

    def made() -> tuple[Path, Matrix]:
        path = path_of(loaded, codes)
        return path, polyline(path)

    block = loaded.scenario.path
    if loaded.shared is None or isinstance(block, PythonPathBlock):
        return made()
    return loaded.shared.get(("path", block.model_dump_json()), made)


def _ability(loaded: Loaded, allocator: FaultTolerant, dynamics: Dynamics, path: Path, believed: Vehicle) -> Ability:
    """What the vehicle can do, shared by flights of one vehicle along one path, whatever the current of each."""
    scenario, lag_s, fins = loaded.scenario, believed.lag_s, fins_at(believed, loaded.scenario)
    if loaded.shared is None or isinstance(scenario.path, PythonPathBlock):
        return Ability.of(allocator, dynamics, scenario, path, lag_s, fins)
    arrays = (
        allocator.A,
        allocator.limits,
        lag_s,
        *(fins or ()),
        *(getattr(dynamics, each.name) for each in fields(dynamics)),
    )
    at_a_point = speed_at_a_point(scenario) if path.length <= 0.0 else None
    asked = scenario.guidance.speed_m_s, at_a_point, scenario.control_period_s, scenario.control.cost_limit
    key = "ability", scenario.path.model_dump_json(), asked, tuple(np.asarray(each).tobytes() for each in arrays)
    ability = loaded.shared.get(
        key, lambda: Ability.of(allocator, dynamics, scenario, path, lag_s, fins).of_many_flights()
    )
    return ability.in_currents(initial_currents(scenario))


def tried(loaded: Loaded, mission: Mission) -> None:
    """Ask a copy of the controller at the start, so that own code without an answer is found before the flight.

    One that cannot be copied is taken as it is.

    Raises:
        ScenarioError: it has no answer; with position.
    """
    try:
        controller = unpacked(packed(mission.controller, mission.fixed), mission.fixed)
    except Exception:
        return
    mujoco.mj_kinematics(mission.model, mission.data)
    with refused(loaded):
        controller.decide(read_state(mission.vehicle, mission.data), np.zeros(6), mission.scenario.control_period_s)
