"""What ``cube-sim analyze`` finds of a model's thrusters, as plain data or a picture."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from cube_sim.actuation import Analysis, PathRequirements, Survivability, analyse, survivability
from cube_sim.actuation.attainable.attainable_set import attainable_set
from cube_sim.actuation.attainable.extents import Extent
from cube_sim.actuation.path_following.requirements import SPEEDS_M_S
from cube_sim.actuation.path_following.steady_turn import TurningTrim, turning_trim
from cube_sim.actuation.path_following.trim import CourseAttitudes
from cube_sim.actuation.path_following.verdict import Verdict
from cube_sim.actuation.survivability import LossCase
from cube_sim.commands.as_flown import as_flown, fails_without_fins, left_without, table_as_flown
from cube_sim.commands.fin_faults_flown import FinCase, fin_cases
from cube_sim.commands.lift_of_fins import lift_words
from cube_sim.commands.stuck_flight import ReadModel
from cube_sim.commands.stuck_report import FaultCase, fault_cases
from cube_sim.control.authority import Authority, Capability
from cube_sim.control.critical_speed import CriticalSpeed, critical_speed
from cube_sim.control.foreseen import Foreseen
from cube_sim.control.loop_times import USUAL_PERIOD_S, mean_delay
from cube_sim.control.transient import Transient
from cube_sim.control.turning_limit import turning_of
from cube_sim.errors import ActuationError, ModelError
from cube_sim.mission.parameter_values import parameter_values
from cube_sim.mission.way_of_flying import STEERED_AT_SPEED_ONLY
from cube_sim.scenario.document import parse_value
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.fins import FinsAtSpeed
from cube_sim.vehicle.loading import load_unsaid
from cube_sim.vehicle.mjcf.places import at_its_place
from cube_sim.vehicle.mjcf.unused import kept_words, without_thrusters
from cube_sim.vehicle.mjcf.what_if import parameters_of, read_setting, set_sites
from cube_sim.vehicle.remarks import remarks
from cube_sim.vehicle.unlikely.words import unlikely_words
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.axes import PLANAR, Matrix

MOST_LOSSES = 3
ROUNDING = 1e-12


@dataclass(frozen=True)
class Report:
    """What the command found.

    Attributes:
        model: path of the model.
        title: what to call the vehicle: the model, and its hull when that was asked for by name.
        vehicle: the hull that was analysed.
        analysis: of the thrusters that are left.
        turning: how tightly it turns, where it follows a path; None where it follows none.
        critical: up to which speed it keeps margins, even where it is flown off its course; None where nothing flies
            it, and in the plane, where other laws do.
        stuck: every single thruster dead and stuck; None where that was not asked for.
        stuck_fins: every single fin loose and jammed; None where that was not asked for.
        remarks: on the vehicle left to itself.
        table: every loss of up to the number asked for, on top of the lost ones; None when that was 0 and no picture
            was wanted.
        speed_m_s: of the verdict.
        fins: what the fins do at that speed, the last columns of the matrix; None for none.
    """

    model: Path
    title: str
    vehicle: Vehicle
    analysis: Analysis
    turning: TurningTrim | None
    critical: CriticalSpeed | None
    table: Survivability | None
    speed_m_s: float
    stuck: tuple[FaultCase, ...] | None = None
    fins: FinsAtSpeed | None = None
    remarks: tuple[str, ...] = ()
    stuck_fins: tuple[FinCase, ...] | None = None


def report_on(
    model: Path,
    *,
    hull: str | None = None,
    lost: str = "",
    losses: int = 0,
    planar: bool = False,
    speed_m_s: float | None = None,
    cost_limit: float | None = None,
    picture: Path | None = None,
    stuck: bool = False,
    settings: Sequence[str] = (),
    progress: Callable[[int, int], None] | None = None,
) -> Report:
    """Analyse a model's thrusters, and draw the picture when one is wanted.

    Args:
        model: an MJCF file with a hull in water.
        hull: its name, needed when there are several.
        lost: comma-separated names of dead thrusters.
        losses: tabulate every loss of up to this many thrusters, on top of the lost ones.
        planar: look at Fx, Fy and Mz only, for a vehicle kept at its depth.
        speed_m_s: at which path following is judged; default that of `PathRequirements`.
        cost_limit: drop the directions that cost more than this [N/N], and judge what is left.
        stuck: judge every single thruster dead, and stuck at half of its limits and at its limits, and every single
            fin loose, and jammed at half of its travel and at its ends.
        picture: PNG, SVG or PDF to write; it shows losses of up to three.
        settings: other values than the file's, see `cube_sim.vehicle.mjcf.what_if`.
        progress: called with (cases done, all cases) while losses are tabulated.

    Raises:
        ModelError: the model cannot be read or has no such hull.
        ActuationError: it has no thrusters, a lost one does not exist, or the picture cannot be written.
    """
    from cube_sim.actuation.plots.picture import check_path, save_picture

    if not 0 <= losses <= MOST_LOSSES:
        raise ActuationError(f"--losses {losses}: between 0 and {MOST_LOSSES}")
    if speed_m_s is not None and not SPEEDS_M_S[0] <= speed_m_s <= SPEEDS_M_S[1]:
        raise ActuationError(f"--speed {speed_m_s:g}: between {SPEEDS_M_S[0]:g} and {SPEEDS_M_S[1]:g} m/s")
    if planar and stuck:
        raise ActuationError("--stuck looks at all six components: leave --planar out")
    if picture is not None:
        check_path(picture)
    loaded = _loaded(model, settings)
    try:
        vehicle = Vehicle.from_model(loaded, hull)
    except ModelError as error:
        raise at_its_place(error, model) from None
    A, names = vehicle.actuation_matrix, vehicle.thrusters.names
    if not names:
        raise ActuationError(f"{model}: {without_thrusters(loaded, vehicle.name)}")
    if planar:
        A = _in_plane(A)
    title = model.stem if hull is None else f"{model.stem}, {vehicle.name}"
    gone = _names(lost)
    body = vehicle.dynamics
    requirements = PathRequirements() if speed_m_s is None else PathRequirements(speed_m_s=speed_m_s)
    limits, fins = ahead_limits(vehicle, requirements.speed_m_s), None
    if vehicle.fins is not None:
        fins, requirements = vehicle.fins.at_speed(requirements.speed_m_s), replace(requirements, nose_ahead=True)
        names, limits = (*names, *vehicle.fins.names), np.vstack([limits, fins.limits])
        A = np.column_stack([A, _in_plane(fins.matrix) if planar else fins.matrix])

    def analysis_of(matrix: Matrix) -> Analysis:
        return analyse(
            matrix, limits, names=names, lost=gone, hull=body, requirements=requirements, cost_limit=cost_limit
        )

    analysis = analysis_of(A)
    if not planar and not analysis.verdict.follows and analysis_of(_in_plane(A)).verdict.follows:
        analysis = replace(analysis, verdict=_with_hint(analysis.verdict))
    turning, critical = None, None
    left = _left(analysis, vehicle, fins, requirements.speed_m_s, cost_limit) if analysis.verdict.follows else None
    as_it_is = model if hull is None and not settings and cost_limit is None and fins is None else None
    flown = as_flown(analysis.verdict, left, vehicle, requirements.speed_m_s, as_it_is, gone)
    analysis = replace(analysis, verdict=flown)
    if analysis.verdict.follows:
        turning = _turning(analysis, vehicle.dynamics, names, limits, requirements.speed_m_s, left)
    if left is not None and left.authority is not Authority.SAFE:  # of one that leaves its course, too: it says why
        critical = critical_speed(left, body, mean_delay(vehicle.lag_s, USUAL_PERIOD_S))
    most = MOST_LOSSES if picture is not None else losses
    table = (
        survivability(
            A,
            limits,
            names=names,
            lost=gone,
            hull=body,
            requirements=requirements,
            most=most,
            cost_limit=cost_limit,
            progress=progress,
        )
        if most
        else None
    )
    if table is not None and not planar:
        table = table_as_flown(table, vehicle, fins, requirements.speed_m_s, cost_limit, as_it_is)
    if picture is not None and table is not None:
        save_picture(picture, A, limits, table, names=names, title=title)
    cases, of_fins = None, None
    if stuck:
        asked, read = {"lost": gone, "cost_limit": cost_limit, "progress": progress}, ReadModel(model, loaded)
        cases = fault_cases(vehicle, requirements.speed_m_s, read=read, **asked)
        of_fins = fin_cases(vehicle, requirements.speed_m_s, read, **asked)
    noted = (*kept_words(loaded), *unlikely_words(loaded, vehicle.name), *remarks(loaded, vehicle))
    if fins is not None and not planar and fails_without_fins(vehicle, gone, requirements.speed_m_s, cost_limit):
        noted = (*noted, STEERED_AT_SPEED_ONLY)
    if fins is not None and not planar:
        noted = (*noted, *lift_words(vehicle, fins, requirements.speed_m_s))
    speed = requirements.speed_m_s
    return Report(model, title, vehicle, analysis, turning, critical, table, speed, cases, fins, noted, of_fins)


def ahead_limits(vehicle: Vehicle, speed_m_s: float) -> Matrix:
    """(m,4) limits of its thrusters [N] straight ahead at a speed, where those of propellers follow the inflow."""
    return vehicle.thrusters.limits_at([speed_m_s, 0.0, 0.0, 0.0, 0.0, 0.0])


def _loaded(model: Path, settings: Sequence[str]) -> mujoco.MjModel:
    """A model, with other values than its file's where that is asked."""
    as_it_is = load_unsaid(str(model))
    if not settings:
        return as_it_is
    spec = mujoco.MjSpec.from_file(str(model))
    others = set_sites(spec, [read_setting(text, parse_value) for text in settings])
    relative = {each.key for each in others if each.how != "="}
    known = {key: parameter_values(key, {}, as_it_is) for key in relative}
    try:
        return load_unsaid(spec, parameters_of(others, known))
    except ModelError as error:  # a spec knows the name in its file, and nobody calls a model by that
        if error.element in {each.key for each in others}:
            raise ModelError(error.element, error.reason, str(model)) from None
        raise at_its_place(ModelError(error.element, error.reason), model) from None


def _turning(
    analysis: Analysis,
    hull: Dynamics,
    names: tuple[str, ...],
    limits: Matrix,
    speed_m_s: float,
    left: Capability | None,
) -> TurningTrim | None:
    """How tightly what is left of a vehicle turns, as a run judges it; in the plane by the matrix alone."""
    known = next(t.condition for t in analysis.verdict.trims if not t.condition.inclination_rad)
    if analysis.subspaces.axes is PLANAR:
        works = [name not in analysis.lost for name in names]
        allowed = AllowedForces.from_limits(limits[works], len(analysis.names), dead_zones=False)
        straight = CourseAttitudes.on(hull, analysis.subspaces, speed_m_s, 0.0)
        return turning_trim(straight, attainable_set(analysis.subspaces, allowed), known)
    return None if left is None else turning_of(left, hull, speed_m_s, known)


def _left(
    analysis: Analysis, vehicle: Vehicle, fins: FinsAtSpeed | None, speed_m_s: float, cost_limit: float | None
) -> Capability | None:
    """What a run judges to be left; None in the plane, judged by the matrix alone."""
    if analysis.subspaces.axes is PLANAR:
        return None
    return left_without(vehicle, fins, analysis.lost, speed_m_s, cost_limit)


def _in_plane(A: Matrix) -> Matrix:
    """(3,m) what thrusters A (6,m) do in the plane.

    A thruster that stands across it does nothing there: rounding is taken out.
    """
    rows = A[list(PLANAR.rows)]
    return np.where(np.abs(rows) > ROUNDING * np.max(np.abs(A), axis=0), rows, 0.0)


def _names(listed: str) -> tuple[str, ...]:
    """The names in a comma-separated list; none in an empty one."""
    names = tuple(part.strip() for part in listed.split(",")) if listed else ()
    if not all(names) or len(set(names)) < len(names):
        raise ActuationError(f"--lost {listed}: give each thruster once, with one comma between two, as in T1,T4")
    return names


def _with_hint(verdict: Verdict) -> Verdict:
    """The verdict in space, with a word on the plane, where a path can be followed."""
    hint = "kept at its depth by other means it follows planar paths (--planar)"
    return replace(verdict, reason=f"{verdict.reason}; {hint}")


def to_dict(report: Report) -> dict[str, Any]:
    """The report as JSON-ready values; what is infinite or unknown is null.

    The keys are those of files on users' disks; docs/actuation.md says which names of the code they stand for.
    """
    a = report.analysis
    s = a.subspaces
    content = {
        "model": str(report.model),
        "hull": report.vehicle.name,
        "remarks": report.remarks,
        "thrusters": a.names,
        "fins": _fins_at(report),
        "propellers": _propellers_at(report),
        "lost": a.lost,
        "components": s.axes.names,
        "actuation_matrix": a.matrix,
        "torque_length_m": s.length_m,
        "singular_values": s.singular_values,
        "rank": a.rank,
        "rank_tolerance": s.threshold.rank_tolerance,
        "cost_limit": s.threshold.cost_limit,
        "redundancy": a.redundancy,
        "range_basis": s.range_basis,
        "kernel_basis": s.kernel_basis,
        "projector": s.projector,
        "pseudo_inverse": s.pseudo_inverse,
        "pure_forces": s.pure_forces.shape[1],
        "pure_torques": s.pure_torques.shape[1],
        "unreachable": [{"coefficients": c.coefficients, "gain": c.gain, "text": c.text} for c in a.unreachable],
        "costs": {
            "first_approach_gains": a.gains,
            "second_approach": dict(zip(s.axes.names, a.component_costs, strict=True)),
            "final_approach": [
                {"wrench": wrench, "cost": cost, "kept": not why, "dropped": why or None}
                for wrench, cost, why in zip(a.directions.wrenches.T, a.directions.costs, a.dropped, strict=True)
            ],
        },
        "extents": [_extent(e) for e in a.extents or ()],
        "indices": asdict(a.indices),
        "verdict": _verdict(a.verdict),
        "turning": _turning_trim(report.turning),
        "critical_speed": None if report.critical is None else report.critical._asdict(),
        "stuck": None if report.stuck is None else [_fault_case(case) for case in report.stuck],
        "stuck_fins": None if report.stuck_fins is None else [_fin_case(case) for case in report.stuck_fins],
        "losses": None if report.table is None else [_case(case) for case in report.table.cases],
    }
    return _plain(content)


def _fins_at(report: Report) -> dict[str, Any] | None:
    if report.fins is None or report.vehicle.fins is None:
        return None
    return {
        "names": report.vehicle.fins.names,
        "speed_m_s": report.fins.speed_m_s,
        "limits": report.fins.limits[:, [0, 3]],
    }


def _propellers_at(report: Report) -> dict[str, Any] | None:
    thrusters = report.vehicle.thrusters
    turns = thrusters.propellers.turns
    if not turns.any():
        return None
    return {
        "names": [name for name, turning in zip(thrusters.names, turns, strict=True) if turning],
        "speed_m_s": report.speed_m_s,
        "limits": ahead_limits(report.vehicle, report.speed_m_s)[turns],
        "limits_at_rest": thrusters.limits[turns],
    }


def _extent(e: Extent) -> dict[str, Any]:
    return {
        "component": e.name,
        "at_most": e.unconstrained,
        "alone": e.isolated,
        "alone_with_dead_zones": e.isolated_with_dead_zones,
        "finest": e.smallest_nonzero,
    }


def _verdict(verdict: Verdict) -> dict[str, Any]:
    return {
        "follows": verdict.follows,
        "outcome": verdict.outcome.value,
        "reason": verdict.reason,
        "courses": [
            {
                "inclination_rad": trim.condition.inclination_rad,
                "velocity": trim.condition.velocity,
                "up": trim.condition.up,
                "forces": trim.condition.forces,
                "share": trim.share,
                "within_limits": trim.within_limits,
                "loose": trim.uncontrolled_modes,
                "side_step_m": trim.side_step_m,
            }
            for trim in verdict.trims
        ],
    }


def _turning_trim(turning: TurningTrim | None) -> dict[str, Any] | None:
    if turning is None:
        return None
    return {"radius_m": turning.radius_m, "heading_rad": turning.heading_rad, "up": turning.attitude[2]}


def _case(case: LossCase) -> dict[str, Any]:
    return {
        "lost": case.lost,
        "rank": case.rank,
        "pure_forces": case.pure_forces,
        "pure_torques": case.pure_torques,
        "unreachable": case.unreachable,
        "strongest_force": case.strongest_force,
        "strongest_torque": case.strongest_torque,
        "extents": [_extent(e) for e in case.extents],
        "verdict": _verdict(case.verdict),
    }


def _fault_case(case: FaultCase) -> dict[str, Any]:
    return {
        "thruster": case.fault.thruster,
        "force_N": case.fault.force_N,
        "state": "dead" if case.fault.force_N is None else "stuck",
        "authority": case.authority.name,
        "left": case.left,
        "follows": case.follows,
        "reason": case.reason or None,
        "tilt_rad": case.tilt_rad,
        "rest_m_s": case.rest_m_s,
        "alone_m_s": case.alone_m_s,
        "found_s": case.found_s,
        "transient": _transient(case.transient, case.foreseen),
        "transient_at_rest": _transient(case.transient_at_rest, case.foreseen_at_rest),
    }


def _fin_case(case: FinCase) -> dict[str, Any]:
    return {
        "fin": case.fault.fin,
        "angle_rad": case.fault.angle_rad,
        "state": "loose" if case.fault.angle_rad is None else "jammed",
        "authority": case.authority.name,
        "left": case.left,
        "follows": case.keeps,
        "reason": case.reason or None,
        "farthest_m": case.farthest_m,
        "off_m": case.off_m,
        "speed_m_s": case.speed_m_s,
    }


def _transient(transient: Transient, ahead: Foreseen | None) -> dict[str, Any]:
    return {
        "foreseen_m": None if ahead is None else ahead.farthest_m,
        "with_margin_m": None if ahead is None else ahead.with_margin_m,
        "going_on": None if ahead is None else ahead.going_on,
        "bound_m": transient.bound_m,
        "no_bound": transient.reason or None,
        "turns_rad": transient.turns_rad,
        "wanders_m": transient.wanders_m,
    }


def _plain(value: Any) -> Any:
    """Arrays and tuples to lists, numpy scalars to Python's, infinities to None."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
