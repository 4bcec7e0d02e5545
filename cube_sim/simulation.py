"""The loop, and nothing else.

One tick: state (MuJoCo, or an estimate of it) -> path error and desired motion (guidance) -> wrench (control) ->
thruster forces (allocation) -> thruster commands -> one row per channel (recording) -> MuJoCo steps with water.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation import Allocation
from cube_sim.checks import evaluate
from cube_sim.control.controller import Decision
from cube_sim.errors import RecordingError, RunInterrupted
from cube_sim.mission import PATH_POINTS, Mission, prepare
from cube_sim.mission.divergence import divergence
from cube_sim.mission.fault_response import record_actuation, respond_to_faults
from cube_sim.mission.pace_log import PaceLog
from cube_sim.mission.run_header import header, versions
from cube_sim.mission.supply import allocate_at
from cube_sim.mission.surface_watch import SurfaceWatch, path_above_surface
from cube_sim.mission.unattainable_log import UnattainableLog
from cube_sim.recording.recorder import Recorder
from cube_sim.run_directory import claim, require_writable
from cube_sim.run_log import LogLine
from cube_sim.scenario import Loaded, load
from cube_sim.spatial import angle_between, quaternion_from_rotation
from cube_sim.vehicle.current import water_velocity
from cube_sim.vehicle.plugin.warnings import collect_warnings
from cube_sim.vehicle.state import read_state
from cube_sim.verdict import CheckResult, EarlyEnd, Flown, Verdict, overall, to_json

Progress = Callable[[float, float], None]


class _NotANumberError(Exception):
    """The controller has no answer to the state it sees."""


@dataclass(frozen=True)
class Run:
    """What a run leaves in memory; the same stands in its directory.

    Attributes:
        verdict: PASS, FAIL or ERROR (could not be judged).
        checks: one result per check of the scenario.
        signals: "channel.field" -> (n, 1 + width), column 0 the time [s].
        directory: where run.mcap, run.rrd, resolved.yaml and verdict.json are.
        real_time_factor: simulated time over the wall-clock time of the loop, its recording included.
        versions: of the packages that took part.
        simulated_s: simulated time from the start to the end [s].
        ended_early: when and why the run ended before its time; None if it did not.
        log: what was said at the level WARNING or above, in the order of time; all of it is in the recording's log.
    """

    verdict: Verdict
    checks: tuple[CheckResult, ...]
    signals: Mapping[str, NDArray[np.float64]]
    directory: Path
    real_time_factor: float
    versions: Mapping[str, str]
    simulated_s: float
    ended_early: EarlyEnd | None
    log: tuple[LogLine, ...]


def run(
    scenario: str | Path,
    overrides: Mapping[str, Any] | None = None,
    out: str | Path | None = None,
    progress: Progress | None = None,
) -> Run:
    """Fly a scenario file, record it and judge its checks.

    Args:
        scenario: YAML file.
        overrides: dotted path -> value in place of the file's, e.g. ``{"guidance.speed_m_s": 0.3}``.
        out: directory to write into: new, empty, or an earlier run's, which is replaced. Default: a new one in logs/.
        progress: called about once per simulated second with (simulated time, whole time) [s].

    Raises:
        ScenarioError: the scenario cannot be run; one line per mistake, nothing is written.
        DirectoryError: `out` holds something else, cannot be written, or another run is writing there.
        RecordingError: the disk is full, or gone.
        RunInterrupted: Ctrl-C; what was flown is recorded.
    """
    return fly(load(scenario, overrides), out, progress)


def fly(loaded: Loaded, out: str | Path | None = None, progress: Progress | None = None) -> Run:
    """Fly a scenario that is loaded already; arguments, result and errors are those of `run`."""
    wanted = None if out is None else Path(out)
    if wanted is not None:
        require_writable(wanted)
    mission = prepare(loaded)
    with claim(wanted, loaded.scenario.name) as directory:
        try:
            return _record_and_judge(loaded, mission, directory, progress)
        except OSError as error:
            raise RecordingError(f"{directory}: cannot be written: {error.strerror or error}") from error
        except RunInterrupted:
            raise
        except KeyboardInterrupt:
            raise RunInterrupted(directory) from None


def _record_and_judge(loaded: Loaded, mission: Mission, directory: Path, progress: Progress | None) -> Run:
    """Fly and judge, into a folder that is ours."""
    (directory / "resolved.yaml").write_text(loaded.resolved_yaml(directory), encoding="utf-8")
    with (
        Recorder(directory, header(loaded), mission.channels, mission.model, vehicle=mission.vehicle.name) as recorder,
        collect_warnings() as warnings,
    ):
        started = time.perf_counter()
        try:
            ended_early = _run_ticks(mission, recorder, warnings, progress)
        except KeyboardInterrupt:
            raise RunInterrupted(directory, recorder.warnings) from None
        elapsed_s = time.perf_counter() - started
        signals = recorder.signals

    scenario = mission.scenario
    simulated_s = ended_early.time_s if ended_early else scenario.ticks * scenario.control_period_s
    flown = Flown(simulated_s, ended_early, recorder.warnings)
    results = evaluate(scenario.checks, signals, duration_s=scenario.duration_s)
    verdict = overall(results, complete=ended_early is None)
    factor = simulated_s / elapsed_s
    text = to_json(verdict, results, factor, versions(), flown)
    (directory / "verdict.json").write_text(text, encoding="utf-8")
    return Run(verdict, results, signals, directory, factor, versions(), simulated_s, ended_early, flown.log)


def _run_ticks(mission: Mission, recorder: Recorder, warnings: list[str], progress: Progress | None) -> EarlyEnd | None:
    """All ticks of a run; the last row is the state at its end.

    Args:
        mission: at time 0.
        recorder: gets rows and sentences.
        warnings: where MuJoCo's arrive; they are moved to the log.
        progress: see `run`.

    Returns:
        When and why the run ended before its time; None if it did not.
    """
    scenario = mission.scenario
    model, data = mission.model, mission.data
    steps, ticks = scenario.steps_per_tick, scenario.ticks
    ticks_per_second = max(1, round(1.0 / scenario.control_period_s))
    _describe(mission, recorder)
    applied, unattainable, logged_reason = np.zeros(6), UnattainableLog(recorder), ""
    pace = PaceLog(recorder, scenario.guidance.speed_m_s)
    surface, t, failure = SurfaceWatch(recorder, model, mission.vehicle), 0.0, None
    for k in range(ticks + 1):
        t = k * scenario.control_period_s
        for message in mission.events.apply_due(t):
            recorder.log(t, "WARNING", message)
        mujoco.mj_forward(model, data)
        while warnings:
            recorder.log(t, "WARNING", f"MuJoCo: {warnings.pop(0)}")
        failure = divergence(model, data)
        if failure is not None:
            break
        surface.note(t, data)
        other_voltage = _feed_thrusters(mission, recorder, t)
        if respond_to_faults(mission, recorder, t) or other_voltage or k == 0:
            record_actuation(mission, recorder, t)
        try:
            decision, allocation = _tick(mission, recorder, t, applied)
        except _NotANumberError as error:
            failure = str(error)
            break
        applied = allocation.wrench
        unattainable.note(t, allocation.status)
        pace.note(t, decision.pace)
        if decision.given_up != logged_reason:
            _log_given_up(mission, recorder, t, decision.given_up)
            logged_reason = decision.given_up
        mission.drop_weight.lift(data)
        if k < ticks:
            mujoco.mj_step(model, data, nstep=steps)
        if progress is not None and k % ticks_per_second == 0:
            progress(t, scenario.duration_s)
    surface.finish(t)
    if failure is None:
        return None
    recorder.log(t, "ERROR", f"{failure}: the run ends here")
    return EarlyEnd(t, failure)


def _feed_thrusters(mission: Mission, recorder: Recorder, t: float) -> bool:
    """Update the supply by what the thrusters draw; returns whether its voltage, and so their limits, have changed."""
    supply, before = mission.supply, mission.supply.force_ratio
    if supply.update(mission.data):
        recorder.log(t, "WARNING", "the battery is empty: the thrusters stand still")
    recorder.append("power", t, supply.power, supply.energy, supply.voltage, supply.charge)
    return supply.force_ratio != before


def _tick(mission: Mission, recorder: Recorder, t: float, applied: NDArray[np.float64]) -> tuple[Decision, Allocation]:
    """One control period up to the thruster commands.

    Returns what the controller decided and what was allocated for it.

    Args:
        mission: whose MuJoCo data are up to date at t.
        recorder: gets one row per channel.
        t: simulated time [s].
        applied: (6,) wrench commanded over the tick before.
    """
    vehicle, data, allocator = mission.vehicle, mission.data, mission.allocator
    state = read_state(vehicle, data)
    known = state if mission.estimation is None else mission.estimation.estimate(state, data, recorder, t)
    decision = mission.controller.decide(known, applied, mission.scenario.control_period_s, mission.supply.force_ratio)
    if not all(np.isfinite(values).all() for values in (decision.wrench, decision.quaternion, decision.view.error)):
        raise _NotANumberError("the controller's answer is not a number")
    allocation, thruster_force = allocate_at(mission.supply.force_ratio, allocator, decision.wrench, decision.secondary)
    if mission.fault_finding is not None:
        thruster_force = mission.fault_finding.probed(thruster_force)
    commands = vehicle.thrusters.command(thruster_force)
    data.ctrl[vehicle.thrusters.actuators] = commands
    if mission.fault_finding is not None:
        mission.fault_finding.commanded(commands)

    recorder.append("pose", t, state.position, state.quaternion)
    recorder.append("velocity", t, state.velocity, state.rates)
    point, error, attitude_error = decision.view.point, decision.view.error, decision.attitude_error
    if known is not state:
        # The errors recorded are those of the true state, not of the estimate.
        error = (state.position - point.position) @ point.rotation
        attitude_error = angle_between(decision.quaternion, state.quaternion)
    s1, y1, z1 = error
    orientation = quaternion_from_rotation(point.rotation)
    recorder.append("target", t, decision.view.arc_length, decision.remaining, point.position, orientation)
    recorder.append("path_error", t, s1, (y1, z1), hypot(y1, z1), attitude_error)
    recorder.append("reference", t, decision.velocity, decision.rates, decision.quaternion)
    recorder.append("wrench", t, decision.wrench, allocation.wrench, decision.disturbance)
    recorder.append("allocation", t, allocation.residual, allocation.cost, allocation.status, allocation.subset)
    produced = data.actuator_force[vehicle.thrusters.actuators]
    recorder.append("thrusters", t, allocation.force, commands, produced)
    believed = allocator.health.efficiency
    recorder.append("health", t, mission.events.health.efficiency, believed, decision.authority)
    water = water_velocity(mission.model, t, state.position[2])
    recorder.append("water", t, water, decision.current)
    return decision, allocation


def _log_given_up(mission: Mission, recorder: Recorder, t: float, reason: str) -> None:
    """Log that the path is given up, and why, or that it is followed again; drop the ballast where that is asked."""
    recorder.log(t, "WARNING", f"the path is given up: {reason}" if reason else "the path is followed again")
    if reason and mission.scenario.control.safe_mode.action == "surface" and mission.drop_weight.drop():
        recorder.log(t, "WARNING", "the ballast is dropped")


def _describe(mission: Mission, recorder: Recorder) -> None:
    """What a reader of the recording must know before the first row."""
    points = np.array([mission.path.at(s).position for s in np.linspace(0.0, mission.path.length, PATH_POINTS)])
    recorder.append("path", 0.0, points.ravel())
    if (warning := path_above_surface(points)) is not None:
        recorder.log(0.0, "WARNING", warning)
    length = mission.path.length
    recorder.log(0.0, "INFO", f"{mission.scenario.name}: {f'{length:.2f} m of path' if length else 'a point to hold'}")
    limit, able = mission.ability.cost_limit, mission.ability.within_limit
    if able.within_cost_limit is not None:
        dear = "costs too much" if limit is None else f"costs more than {limit:g} N/N"
        recorder.log(0.0, "INFO", f"what {dear} is left alone; {able.authority.name}: {able.reason}")
