"""What single faults make of a vehicle, on a terminal."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from rich.table import Table

from cube_sim.commands.fin_faults_flown import FLOWN_S, FinCase
from cube_sim.commands.stuck_report import FaultCase
from cube_sim.control.foreseen import AHEAD_S, Foreseen, in_metres
from cube_sim.control.transient import Transient
from cube_sim.control.turned_round import NEAR_M

HEADERS = {
    "thruster": "left",
    "holds [N]": "right",
    "flies": "left",
    "tilt [deg]": "right",
    "follows": "left",
    "carried off [m/s]": "right",
    "leaves its path [m]": "right",
    "its place [m]": "right",
}
"""Of the table, and to which side each stands."""
FIN_HEADERS = {
    "fin": "left",
    "jammed at [deg]": "right",
    "flies": "left",
    "keeps its course": "left",
    "off at most [m]": "right",
    "off at the end [m]": "right",
    "speed [m/s]": "right",
}
"""Of that of fins."""


def faults_table(cases: tuple[FaultCase, ...]) -> Table:
    """Every single fault; why there is no bound stands below."""
    table = _headed(HEADERS)
    notes = _notes(cases)
    for case in cases:
        force = case.fault.force_N
        table.add_row(
            case.fault.thruster,
            "dead" if force is None else f"{force:.1f}",
            case.authority.name,
            f"{np.degrees(case.tilt_rad):.0f}",
            "yes" if case.follows else "no",
            "held" if case.rest_m_s == 0.0 else f"{min(case.rest_m_s, case.alone_m_s):.2g}",
            _far(case.transient, case.foreseen, notes),
            _far(case.transient_at_rest, case.foreseen_at_rest, notes),
        )
    return table


def fins_table(cases: tuple[FinCase, ...]) -> Table:
    """Every single fault of a fin."""
    table = _headed(FIN_HEADERS)
    for case in cases:
        angle = case.fault.angle_rad
        table.add_row(
            case.fault.fin,
            "loose" if angle is None else f"{np.degrees(angle):.1f}",
            case.authority.name,
            "yes" if case.keeps else "no",
            f"{case.farthest_m:.2g}",
            f"{case.off_m:.2g}",
            f"{case.speed_m_s:.2f}",
        )
    return table


def _headed(headers: Mapping[str, str]) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    for header, side in headers.items():
        table.add_column(header.replace("[", "\\["), justify="left" if side == "left" else "right", no_wrap=True)
    return table


def fins_in_words(cases: tuple[FinCase, ...], speed_m_s: float) -> list[str]:
    """The sum of them, and with which fin lost the course is kept at all.

    Args:
        cases: of all faults.
        speed_m_s: at which they are flown.
    """
    held = sum(case.keeps for case in cases)
    flown = f"flown straight ahead at {speed_m_s:g} m/s for {FLOWN_S:g} s, the controller told of it"
    said = [f"single faults of fins: {held} of {len(cases)} keep the course; {flown}"]
    for fin in dict.fromkeys(case.fault.fin for case in cases):
        of_it = [case for case in cases if case.fault.fin == fin]
        lost = [case for case in of_it if not case.keeps]
        if lost:
            where = ", ".join(
                "loose" if case.fault.angle_rad is None else f"at {np.degrees(case.fault.angle_rad):.1f} deg"
                for case in lost
            )
            # One of those that differ in numbers alone.
            kinds = {re.sub(r"[\d.]+", "", case.reason): case.reason for case in reversed(lost)}
            said.append(f"  {fin} {where}: {'; '.join(reversed(kinds.values()))}")
    return said


def faults_in_words(cases: tuple[FaultCase, ...]) -> list[str]:
    """The sum of them, and why there are no bounds."""
    held = sum(case.follows for case in cases)
    bounded = sum(not case.transient.reason for case in cases)
    turn = any(transient.turns_rad > 0.0 for transient in _transients(cases))
    wander = any(transient.wanders_m > 0.0 for transient in _transients(cases))
    far = any(transient.wanders_m > NEAR_M for transient in _transients(cases))
    level = "; as long as it stays level it may be carried off instead" * far
    ahead = any(case.foreseen is not None for case in cases)
    return [
        f"single faults: {held} of {len(cases)} follow the path; how far it is left at most is known for {bounded}",
        *(
            [
                f"  m / m: foreseen by the law flown ahead on the equations of motion for {AHEAD_S:g} s / at most; "
                "+: farther later; ~: with a margin, where no bound is known"
            ]
            * ahead
        ),
        *(f"  {note}: {reason}" for reason, note in _notes(cases).items()),
        *([f"  wanders: turned round by what is stuck, by its equations of motion, which is no bound{level}"] * wander),
        *(["  turns: it first has to turn so far, to where the others have enough, and no bound is known"] * turn),
    ]


def _transients(cases: tuple[FaultCase, ...]) -> list[Transient]:
    return [transient for case in cases for transient in (case.transient, case.transient_at_rest)]


def _notes(cases: tuple[FaultCase, ...]) -> dict[str, str]:
    """Reason why there is no bound -> what stands for it in the table."""
    said = [transient for transient in _transients(cases) if transient.turns_rad == 0.0 and transient.wanders_m == 0.0]
    reasons = dict.fromkeys(transient.reason for transient in said if transient.reason)
    return {reason: f"none ({k})" for k, reason in enumerate(reasons, start=1)}


def _far(transient: Transient, ahead: Foreseen | None, notes: dict[str, str]) -> str:
    """How far is foreseen, and at most, or with a margin where there is no bound, and why."""
    if ahead is None:
        return _bound(transient, notes)
    foreseen = in_metres(ahead.farthest_m) + "+" * ahead.going_on
    if not transient.reason:
        return f"{foreseen} / {max(transient.bound_m, ahead.with_margin_m):.2g}"
    return f"{foreseen} / ~{ahead.with_margin_m:.2g} {_bound(transient, notes)}"


def _bound(transient: Transient, notes: dict[str, str]) -> str:
    """The bound of a transient, or what stands for the reason why there is none."""
    if transient.turns_rad > 0.0:
        return f"turns {np.degrees(transient.turns_rad):.0f} deg"
    if transient.wanders_m > 0.0:
        return f"wanders {transient.wanders_m:.2g}"
    return notes[transient.reason] if transient.reason else f"{transient.bound_m:.2g}"
