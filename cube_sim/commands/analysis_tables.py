"""The analysis of a vehicle's thrusters on a terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np
from rich.table import Table

from cube_sim.actuation import Analysis, PathRequirements, Survivability
from cube_sim.actuation.path_following.controllable_trim import FURTHEST
from cube_sim.actuation.path_following.steady_turn import TIGHTEST_M
from cube_sim.commands.analysis_report import Report, ahead_limits
from cube_sim.commands.output import console_for_tables
from cube_sim.commands.stuck_tables import faults_in_words, faults_table, fins_in_words, fins_table
from cube_sim.control.critical_speed import FASTEST_M_S, CriticalSpeed
from cube_sim.wrench.axes import PLANAR, SPATIAL

NOSE_AHEAD_DEG = 3.0
"""Angles of less than this are not worth a word."""


def print_report(report: Report) -> None:
    """Print everything a designer asks first, the verdict last."""
    console = console_for_tables()
    a = report.analysis
    s = a.subspaces

    def line(text: str) -> None:
        console.print(text, markup=False, highlight=False, soft_wrap=True)

    lost = f", without {', '.join(a.lost)}" if a.lost else ""
    fins = () if report.vehicle.fins is None else report.vehicle.fins.names
    beside = f" and {len(fins)} fin{'s' * (len(fins) != 1)}" if fins else ""
    count = sum(name not in a.lost for name in report.vehicle.thrusters.names)
    word = "thruster" if count == 1 else "thrusters"
    line(f"{report.title}: {count} {word}{beside}{lost}; torques divided by {s.length_m:.3g} m")
    line(f"rank {a.rank} of {len(s.axes.names)}, {a.redundancy} redundant")
    for remark in report.remarks:
        line(f"  {remark}")
    if s.axes is PLANAR:
        line("  looked at are Fx, Fy and Mz only: depth, roll and pitch are taken to be kept by other means")
    for combination in a.unreachable:
        line(f"  {combination}")
    if a.unreachable:
        forces, torques = s.pure_forces.shape[1], s.pure_torques.shape[1]
        line(f"  isolated: {forces} force{'s' * (forces != 1)} and {torques} torque{'s' * (torques != 1)}")
    for text in (*_propellers(report), *_fins(report)):
        line(f"  {text}")
    console.print(_components(a))
    console.print(_directions(a))
    for why in sorted(set(a.dropped) - {""}):
        line(_reason(a, why))
    line(_indices(a))
    if report.table is not None:
        console.print(_losses(report.table))
        for losses in range(1, report.table.most + 1):
            line(_count(report.table, losses))
    if report.stuck is not None:
        console.print(faults_table(report.stuck))
        for text in faults_in_words(report.stuck):
            line(text)
    if report.stuck_fins:
        console.print(fins_table(report.stuck_fins))
        for text in fins_in_words(report.stuck_fins, report.speed_m_s):
            line(text)
    line(f"path following: {'yes' if a.verdict.follows else 'no'} ({a.verdict.outcome.value}). {a.verdict.reason}")
    if a.verdict.follows:
        line(f"turning: {_turning(report)}")
    if report.critical is not None:
        line(f"margins: {_margins(report.critical)}")


def _propellers(report: Report) -> Iterator[str]:
    """What the inflow leaves of propellers, and at which speed."""
    thrusters = report.vehicle.thrusters
    turns = thrusters.propellers.turns
    if not turns.any():
        return
    yield f"propellers count by what they make at {report.speed_m_s:g} m/s straight ahead (--speed) [N]:"
    there, rest = ahead_limits(report.vehicle, report.speed_m_s), thrusters.limits
    for i in np.flatnonzero(turns).tolist():
        (low, below, above, high), (least, _, _, most) = there[i].tolist(), rest[i].tolist()
        yield (
            f"  {thrusters.names[i]}: {low:.3g} to {high:.3g}, none between {below:.3g} and {above:.3g}; at rest "
            f"{least:.3g} to {most:.3g}"
        )


def _fins(report: Report) -> Iterator[str]:
    """What the fins do, and at which speed."""
    fins, at = report.vehicle.fins, report.fins
    if fins is None or at is None:
        return
    yield f"fins count by what they make at {at.speed_m_s:g} m/s straight ahead (--speed), at most [N, N m]:"
    for name, column, (low, _, _, high) in zip(fins.names, at.matrix.T, at.limits, strict=True):
        wrench = max(-low, high) * column
        parts = [f"{axis} {value:.3g}" for axis, value in zip(SPATIAL.names, wrench, strict=True) if abs(value) > 1e-9]
        yield f"  {name}: {', '.join(parts) or 'nothing'}"


def _turning(report: Report) -> str:
    """Which level turns are kept, and how the hull lies on its course for them."""
    turning = report.turning
    if turning is None or np.isinf(turning.radius_m):
        return "no; straight courses only"
    tilt, ahead = np.degrees(np.arccos(np.clip(turning.attitude[2, 2], -1.0, 1.0))), np.degrees(turning.heading_rad)
    side = "left" if ahead > 0.0 else "right"
    nose = "nose ahead" if abs(ahead) < NOSE_AHEAD_DEG else f"nose {abs(ahead):.0f} deg to the {side} of the course"
    lies = f"{nose}, tilted by {tilt:.0f} deg" if tilt >= NOSE_AHEAD_DEG else nose
    tighter = " or less" if turning.radius_m <= TIGHTEST_M else ""
    return f"yes, to both sides within {turning.radius_m:.2g} m{tighter}; ready to turn, it flies straight on {lies}"


def _margins(critical: CriticalSpeed) -> str:
    """How fast it may go, level and nose ahead."""
    if np.isinf(critical.speed_m_s):
        return f"at every speed through the water up to {FASTEST_M_S:g} m/s"
    return f"up to {critical.speed_m_s:.2g} m/s through the water, level and nose ahead; there {critical.reason}"


def _components(a: Analysis) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    for header in ("component", "isolated", "unconstrained", "smallest nonzero", "cost [N/N]"):
        table.add_column(header, justify="left" if header == "component" else "right")
    for i, (name, cost) in enumerate(zip(a.subspaces.axes.names, a.component_costs, strict=True)):
        e = a.extents[i] if a.extents is not None else None
        unit = "N" if i < a.subspaces.axes.forces else "N m"
        if e is None:
            table.add_row(name, "", "", "", _number(cost))
            continue
        least = e.smallest_nonzero
        smallest = "not computed" if least is None else " / ".join(_number(value) for value in least)
        table.add_row(
            f"{name} [[{unit}]]".replace("[[", "\\[").replace("]]", "]"),
            f"{_number(e.isolated[0])} .. {_number(e.isolated[1])}",
            f"{_number(e.unconstrained[0])} .. {_number(e.unconstrained[1])}",
            smallest,
            _number(cost),
        )
    return table


def _directions(a: Analysis) -> Table:
    names = a.subspaces.axes.names
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("direction")
    for name in names:
        table.add_column(name, justify="right")
    table.add_column("cost [N/N]", justify="right")
    if any(a.dropped):
        table.add_column("dropped by")
    for j, (wrench, cost, why) in enumerate(zip(a.directions.wrenches.T, a.directions.costs, a.dropped, strict=True)):
        table.add_row(f"v{j + 1}", *(_number(x) for x in wrench), _number(cost), *([why] if any(a.dropped) else []))
    return table


def _reason(a: Analysis, why: str) -> str:
    threshold = a.subspaces.threshold
    if why == "cost":
        return f"dropped by cost: above {threshold.cost_limit:g} N/N"
    times = 1.0 / threshold.rank_tolerance
    return f"dropped by rank: more than {times:.4g} times as costly as the cheapest; --cost-limit decides instead"


def _indices(a: Analysis) -> str:
    i = a.indices
    if a.rank < len(a.subspaces.axes.names):
        return "design indices: none, the layout has lost a component"
    weakest = "" if i.weakest is None else f", every wrench up to {_number(i.weakest)} N"
    return (
        f"manipulability {_number(i.manipulability)}, isotropy {_number(i.isotropy)}, energy {_number(i.energy)}, "
        f"reactivity {_number(i.reactivity)}, robustness {_number(i.robustness)}, "
        f"{_tolerated(a)}{weakest}"
    )


def _tolerated(a: Analysis) -> str:
    names = " ".join(a.subspaces.axes.names)
    match a.indices.tolerated_losses:
        case 0:
            return f"some single loss costs one of {names}"
        case 1:
            return f"keeps {names} after any single loss"
        case losses:
            return f"keeps {names} after any {losses} losses"


def _losses(survived: Survivability) -> Table:
    more = "lost too" if survived.already else "lost"
    table = Table(box=None, pad_edge=False, header_style="dim")
    for header in (more, "rank", "pure F/M", "force [N]", "torque [N m]", "side step [m]", "follows"):
        text = header in (more, "follows")
        table.add_column(header.replace("[", "\\["), justify="left" if text else "right", no_wrap=text)
    for case in survived.cases:
        steps = [steered.side_step_m for steered in case.verdict.trims]
        table.add_row(
            " ".join(case.lost) or "none",
            str(case.rank),
            f"{case.pure_forces}/{case.pure_torques}",
            f"{case.strongest_force:.0f}",
            f"{case.strongest_torque:.1f}",
            _step(min(steps)) if steps else "",
            ("yes, " if case.verdict.follows else "no, ") + case.verdict.outcome.value,
        )
    return table


def _count(survived: Survivability, losses: int) -> str:
    cases = survived.of(losses)
    ranks = Counter(case.rank for case in cases)
    split = ", ".join(f"{count} keep rank {rank}" for rank, count in sorted(ranks.items(), reverse=True))
    follows = sum(case.verdict.follows for case in cases)
    return f"{losses} {'more ' if survived.already else ''}lost: {follows} of {len(cases)} can follow a path; {split}"


def _step(metres: float) -> str:
    """A side step. The command requires the default one, and none is looked for that is much longer."""
    furthest = FURTHEST * PathRequirements().side_step_m
    return f">= {furthest:g}" if metres >= furthest else _number(metres)


def _number(value: float) -> str:
    if np.isinf(value):
        return "-"
    return f"{0.0 if abs(value) < 1e-9 else value:.3g}"
