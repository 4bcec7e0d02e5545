"""What the analysis says of a mission beforehand: what `cube-sim analyze` says, at the mission's own speed."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from support.catalogue import wrong

from flights.files import put

MOST_USED = 0.9
"""Share of their limits that the other thrusters may need to hold against one that is stuck."""

LEAST_M_S = 0.05
"""A vehicle that stays where it is must still correct itself."""


class Forecast(NamedTuple):
    """Whether a mission should be flown as asked, and why."""

    flies: bool
    reason: str


def forecast(
    model: Path,
    *,
    lost: tuple[str, ...],
    weak: Mapping[str, float],
    stuck: Mapping[str, float],
    speed_m_s: float,
    planar: bool,
    steep: bool = False,
) -> Forecast:
    """Ask the analysis.

    Weak thrusters are asked about as a model with as much less thrust. The analysis knows no stuck thruster: it is
    asked about its loss, and the rest must also be able to cancel what it holds, with drag in some direction and
    within `MOST_USED` of their limits.

    Args:
        model: of the vehicle as it flies.
        lost: its dead thrusters.
        weak: thruster -> share of its force.
        stuck: thruster -> force it holds [N].
        speed_m_s: through the water.
        planar: ask for the plane.
        steep: the path is steeper than the analysis asks of a steered vehicle: any course must be its own.
    """
    from cube_sim.actuation.path_following.verdict import Outcome
    from cube_sim.commands.analysis_report import report_on

    if weak:
        model = put(model.with_name("weakened.xml"), wrong.with_efficiency(model.read_text(), weak))
    gone = (*lost, *stuck)
    report = report_on(model, lost=",".join(gone), planar=planar, speed_m_s=max(speed_m_s, LEAST_M_S))
    verdict = report.analysis.verdict
    flies, reason = verdict.follows, f"{verdict.outcome.value}: {verdict.reason}"
    if flies and steep and verdict.outcome is not Outcome.HOLONOMIC:
        flies, reason = False, f"{reason}; this path is steeper than was asked"
    if flies and stuck:
        held = _share_to_hold(report.vehicle, gone, stuck, speed_m_s)
        if held > MOST_USED:
            flies, reason = False, f"{reason}; to cancel what is stuck takes {100.0 * held:.0f} % of the others"
    return Forecast(flies, reason)


def _share_to_hold(vehicle, gone: tuple[str, ...], stuck: Mapping[str, float], speed_m_s: float) -> float:
    """Smallest share of their limits by which the others cancel the stuck forces and the drag in the best direction."""
    from scipy.optimize import linprog

    names = list(vehicle.thrusters.names)
    rest = [i for i, name in enumerate(names) if name not in gone]
    A, limits = vehicle.actuation_matrix, vehicle.thrusters.limits
    pushed = sum((A[:, names.index(name)] * force for name, force in stuck.items()), np.zeros(6))
    shares = []
    for direction in _directions():
        nu = speed_m_s * np.concatenate([direction, np.zeros(3)])
        drag = (vehicle.linear_damping + vehicle.quadratic_damping * np.abs(nu)) @ nu
        # minimise s over (f, s) with A f = drag - pushed and s F_max- <= f <= s F_max+
        k = len(rest)
        above = np.hstack([np.eye(k), -limits[rest, 3:4]])
        below = np.hstack([-np.eye(k), limits[rest, 0:1]])
        found = linprog(
            np.r_[np.zeros(k), 1.0],
            A_ub=np.vstack([above, below]),
            b_ub=np.zeros(2 * k),
            A_eq=np.hstack([A[:, rest], np.zeros((6, 1))]),
            b_eq=drag - pushed,
            bounds=[(None, None)] * k + [(0.0, None)],
        )
        shares.append(float(found.x[-1]) if found.success else np.inf)
    return min(shares)


def _directions() -> np.ndarray:
    """(26, 3) towards faces, edges and corners of a cube."""
    grid = np.array(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3)).reshape(3, -1).T
    grid = grid[np.any(grid != 0.0, axis=1)]
    return grid / np.linalg.norm(grid, axis=1)[:, None]
