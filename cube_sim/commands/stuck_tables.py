"""What single faults make of a vehicle, on a terminal."""

from __future__ import annotations

import numpy as np
from rich.table import Table

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


def faults_table(cases: tuple[FaultCase, ...]) -> Table:
    """Every single fault; why there is no bound stands below."""
    table = Table(box=None, pad_edge=False, header_style="dim")
    for header, side in HEADERS.items():
        table.add_column(header.replace("[", "\\["), justify="left" if side == "left" else "right", no_wrap=True)
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
