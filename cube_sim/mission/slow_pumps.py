"""Set-points that a pump of ballast is too slow for, told before the flight."""

from __future__ import annotations

from itertools import pairwise

from cube_sim.mission.setpoints import Setpoints
from cube_sim.spatial import Matrix
from cube_sim.vehicle.ballast import Ballast

SHORT = 0.02
"""Share of a pump's travel by which it may lag behind (a choice): what is less, nobody means."""


def slow_pump_words(setpoints: Setpoints | None, ballast: Ballast | None, duration_s: float) -> list[str]:
    """A sentence for each pump that has not come to its volume by the next set-point, or by the end of the run.

    Args:
        setpoints: of the run.
        ballast: of the vehicle.
        duration_s: of the run [s].
    """
    if setpoints is None or ballast is None:
        return []
    said, actuators = [], setpoints.actuators.tolist()
    for i, actuator in enumerate(ballast.actuators.tolist()):
        if actuator not in actuators:
            continue
        k, rate = actuators.index(actuator), float(ballast.rate[i])
        points = setpoints.points[setpoints.starts[k] : setpoints.starts[k + 1]]
        short = _short(points, rate, SHORT * float(ballast.travel[i, 1] - ballast.travel[i, 0]), duration_s)
        if short is not None:
            at, wanted, reached = short
            said.append(
                f"the pump '{ballast.names[i]}' moves {1e3 * rate:.3g} l/s: told to have {1e3 * wanted:.3g} l at"
                f" {at:.2f} s it has {1e3 * reached:.3g} l then"
            )
    return said


def _short(points: Matrix, rate: float, least: float, duration_s: float) -> tuple[float, float, float] | None:
    """When it first falls short by so much [s], what it is told to have then, and what it has [m^3]; None for never."""
    rows = [(float(t), float(volume)) for t, volume in points if t <= duration_s]
    rows = [*rows, (duration_s, rows[-1][1])] if rows else []
    reached = rows[0][1] if rows else 0.0
    for (before, _), (at, wanted) in pairwise(rows):
        if at > before:
            far = wanted - reached
            reached += min(max(far, -rate * (at - before)), rate * (at - before))
            if abs(wanted - reached) > least:
                return at, wanted, reached
    return None
