"""The controller a scenario asks for."""

from __future__ import annotations

import copy
from math import inf

import mujoco
import numpy as np

from cube_sim.actuation.directions.selection_criteria import final_approach
from cube_sim.control.authority import OUT_OF_PLANE, Authority, Capability
from cube_sim.control.controller import Controller
from cube_sim.control.course_keeping import turning_diameter
from cube_sim.control.current import CurrentObserver
from cube_sim.control.disturbance import DisturbanceObserver
from cube_sim.control.loop_times import LoopTimes, angular_acceleration, mean_delay
from cube_sim.control.loops import MotionLoops
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.safe_mode import SafeMode
from cube_sim.errors import ScenarioError
from cube_sim.guidance.path import Path
from cube_sim.mission.ability import Ability, with_fins
from cube_sim.mission.attitude import attitude_of, is_path_first
from cube_sim.mission.ceiling import ceiling_of
from cube_sim.mission.guidance import guidance_of
from cube_sim.mission.hull import CompiledHull
from cube_sim.mission.knowledge import believed_dynamics
from cube_sim.mission.moment import limits_move
from cube_sim.mission.own.code import NO_CODES, Codes
from cube_sim.mission.own.controller import own_controller
from cube_sim.mission.own.law import LawSetup
from cube_sim.mission.own.others import NOBODY, Others
from cube_sim.mission.own.parts import PartSetup, own_attitude, own_motion
from cube_sim.mission.path import is_level
from cube_sim.mission.planar import planar_follower
from cube_sim.mission.refusals import too_slow_period, wrong_depth
from cube_sim.scenario import Loaded, Scenario
from cube_sim.scenario.attitude_blocks import PythonAttitudeBlock
from cube_sim.spatial import Matrix
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.floating import floating_height, weighs_less
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.health import Health
from cube_sim.wrench.matrix import lever_arm

REST = 3.0
"""How many times the force at which the widest dead zone ends is asked for again where it could not be made; and the
torque that it makes on the thrusters' rms arm."""
LIMIT_M, LIMIT_DIAMETERS = 10.0, 2.0
"""How far from its target a vehicle is that has lost it, where nothing is said: no less than that many diameters of the
tightest turn that fins hold, in which such a hull comes back (choices)."""
BY_FINS = (
    "the planar law has a torque that pushes nothing aside, and leaves depth to the water; fins steer this vehicle, and"
    " hold its depth: leave control.law out, motion_6dof follows the path by them"
)
"""Why a vehicle that its fins steer does not fly the planar law."""


def controller_of(
    loaded: Loaded,
    believed: CompiledHull,
    path: Path,
    ability: Ability,
    codes: Codes = NO_CODES,
    others: Others = NOBODY,
) -> Controller:
    """The law from states to wrenches, for the vehicle the controller believes to fly.

    Args:
        loaded: the scenario.
        believed: the vehicle.
        path: the path.
        ability: what its thrusters can do.
        codes: code of the user's own.
        others: what that sees of other vehicles.

    Raises:
        ScenarioError: the law does not fit the path or the vehicle; with position.
    """
    scenario = loaded.scenario
    control = scenario.control
    dynamics = believed_dynamics(believed.vehicle.dynamics, scenario.knowledge, believed.vehicle.lift)
    time, flow = control.disturbance_time_s, control.current_time_s
    whole, within_limit = ability.whole, ability.within_limit
    in_plane = whole.authority is Authority.UNICYCLE and ability.steered_by is None
    if control.law == "planar_lapierre_2007" and ability.steered_by is not None:
        raise ScenarioError([loaded.mistake("control.law", BY_FINS)])
    if control.law == "planar_lapierre_2007" or (control.law is None and in_plane):
        return planar_follower(loaded, believed, path)
    times = _times(scenario, believed.vehicle, dynamics, ability)
    target, approach = guidance_of(scenario, path, times.lateral)
    part = PartSetup(scenario, path, dynamics, within_limit, times, others)
    if (code := codes.get("guidance.law")) is not None:
        approach = own_motion(loaded, code, part)
    block = control.attitude
    if isinstance(block, PythonAttitudeBlock):
        attitude = own_attitude(loaded, codes["control.attitude"], part)
    else:
        attitude = attitude_of(block, dynamics, times.attitude)
    if (code := codes.get("control.law")) is not None:
        setup = LawSetup(
            scenario=scenario,
            period_s=scenario.control_period_s,
            model=_in_place(believed, scenario),
            vehicle=believed.vehicle,
            dynamics=dynamics,
            A=ability.A,
            limits=ability.limits,
            capability=within_limit,
            times=times,
            path=path,
            target=target,
            motion=approach,
            attitude=attitude,
            others=others,
        )
        return own_controller(loaded, code, setup)
    mistakes = too_slow_period(loaded, _loop_times(scenario, times))
    if any(scenario.knowledge.current_m_s):
        text = "only the planar law takes a current that is known, the law for all axes estimates it: leave it out"
        mistakes.append(loaded.mistake("knowledge.current_m_s", text))
    if within_limit.authority is Authority.SAFE and whole.authority is not Authority.SAFE:
        costs = _costs(ability.A, whole)
        text = f"what is left of this vehicle at {ability.cost_limit:g} N/N follows no path; {costs}"
        mistakes.append(loaded.mistake("control.cost_limit", text, because="model"))
    if within_limit.level:
        if not is_level(path):
            text = "this path climbs or sinks, and the vehicle has thrusters for a level plane only"
            mistakes.append(loaded.mistake("path", text))
        mistakes += wrong_depth(loaded, path)
    if mistakes:
        raise ScenarioError(mistakes)
    widest = float(np.abs(believed.vehicle.thrusters.limits[:, 1:3]).max(initial=0.0))
    return PathFollower(
        target=target,
        approach=approach,
        attitude=attitude,
        loops=MotionLoops(dynamics, times.velocity, times.attitude, times.rate, times.turn),
        pointing_time=times.pointing,
        observer=None if time is None else DisturbanceObserver(dynamics, time),
        current_observer=None if flow is None or time is None else CurrentObserver(dynamics, flow),
        safe_mode=_safe_mode(scenario, believed, within_limit, dynamics),
        most_rest=REST * widest * np.array([1.0, lever_arm(believed.vehicle.actuation_matrix, SPATIAL)]),
        speed=scenario.guidance.speed_m_s if control.attitude_time_s is None else 0.0,
        radius=ability.radius_m,
        waits=scenario.guidance.wait_for_thrusters and ability.steered_by is None,  # slower, fins make less
        capability=within_limit,
        path_first=is_path_first(control),
        ceiling=ceiling_of(believed, scenario),
        limits_move=limits_move(believed.vehicle.thrusters, believed.model, scenario.battery is not None),
        fins_speed=0.0 if ability.fins is None else scenario.guidance.speed_m_s,
    )


def _in_place(believed: CompiledHull, scenario: Scenario) -> mujoco.MjModel:
    """A copy of a model, whose reference position is where the mission begins: at its own, a hull may be half dry."""
    model, at = copy.copy(believed.model), believed.vehicle.qpos_address
    model.qpos0[at : at + 3] = scenario.initial.position_m
    return model


def _costs(A: Matrix, whole: Capability) -> str:
    """What the directions cost that a whole vehicle has, in words."""
    costs = final_approach(A[~OUT_OF_PLANE] if whole.level else A).costs
    return f"its directions cost {', '.join(f'{cost:.3g}' for cost in costs)} N/N"


def _times(scenario: Scenario, vehicle: Vehicle, dynamics: Dynamics, ability: Ability) -> LoopTimes:
    """How fast each loop of the law for all axes is."""
    control, whole, m = scenario.control, ability.whole, len(vehicle.thrusters.names)
    delay = mean_delay(vehicle.lag_s, scenario.control_period_s)
    A = scenario.knowledge.thrust * vehicle.actuation_matrix
    A, limits, _ = with_fins(A, vehicle.thrusters.limits, Health.whole(m), ability.steered_by)
    turning = angular_acceleration(A, limits, dynamics.total_mass[3:, 3:], dynamics.righting_moment)
    pointing = whole.authority in (Authority.PLANE, Authority.LINE)
    default = LoopTimes.behind(delay, turning, pointing, whole.level)
    velocity = default.velocity if control.velocity_time_s is None else control.velocity_time_s
    return LoopTimes(
        lateral=4.0 * velocity,
        velocity=velocity,
        attitude=default.attitude if control.attitude_time_s is None else control.attitude_time_s,
        rate=default.rate if control.rate_time_s is None else control.rate_time_s,
        pointing=default.pointing if control.attitude_time_s is None else control.attitude_time_s,
        turn=default.turn,
    )


def _loop_times(scenario: Scenario, times: LoopTimes) -> dict[str, float]:
    """How fast each loop of the law for all axes is, by the value that says so [s]."""
    guidance = scenario.guidance
    stated = {
        "control.velocity_time_s": times.velocity,
        "control.attitude_time_s": times.attitude,
        "control.rate_time_s": times.rate,
    }
    if guidance.law == "path_following":
        stated["guidance.target_gain_per_s"] = 1.0 / guidance.target_gain_per_s
    return stated


def _safe_mode(scenario: Scenario, believed: CompiledHull, left: Capability, hull: Dynamics) -> SafeMode:
    block = scenario.control.safe_mode
    limit, rises_to = block.distance_limit_m, block.surface_m
    if limit == 0.0:
        limit = max(LIMIT_M, LIMIT_DIAMETERS * turning_diameter(left, hull, scenario.guidance.speed_m_s))
    floats = False
    if scenario.surface_m is not None:  # a vehicle that would rise above its draught drives its thrusters dry
        floats_at = scenario.surface_m + floating_height(*believed, block.drop_weight_N)
        floats = rises_to >= floats_at and weighs_less(believed.vehicle, block.drop_weight_N)
        rises_to = min(rises_to, floats_at)
    return SafeMode(
        surface=rises_to if block.action == "surface" else None,
        speed=block.speed_m_s,
        limit=inf if limit is None else limit,
        patience=block.patience_s,
        floats=floats,
    )
