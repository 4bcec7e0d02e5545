"""The verdict of the analysis, once the run has been asked what it makes of the same thrusters.

The analysis asks for courses, limits and small motions; the law that flies has its own way of using what is left. Where
it gives up, or can point its thrust only badly, the answer is no, in the run's words.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from cube_sim.actuation import Survivability
from cube_sim.actuation.path_following.verdict import Outcome, Verdict
from cube_sim.actuation.survivability import LossCase
from cube_sim.commands.flown_course import is_doubtful, leaves_course
from cube_sim.control.authority import Authority, Capability
from cube_sim.control.badly_pointed import badly_pointed
from cube_sim.control.judged_capability import capability, remaining_capability
from cube_sim.control.yielding import WaterHold
from cube_sim.mission.ability import with_fins
from cube_sim.spatial import Matrix
from cube_sim.vehicle.fins import FinsAtSpeed
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.health import Health

IN_SPACE = 6
"""Components of a wrench in space."""
POINTED = (Authority.PLANE, Authority.LINE)
"""Ways of flying that have to be asked how well they point the thrust."""


class _Whole(NamedTuple):
    """A vehicle with all its thrusters and fins: A (6,m), limits (m,4), health, names (m,), what the water holds."""

    A: Matrix
    limits: Matrix
    health: Health
    names: tuple[str, ...]
    hold: WaterHold

    @classmethod
    def of(cls, vehicle: Vehicle, fins: FinsAtSpeed | None, speed_m_s: float) -> _Whole:
        thrusters = vehicle.thrusters
        judged = with_fins(vehicle.actuation_matrix, thrusters.limits, Health.whole(len(thrusters.names)), fins)
        names = thrusters.names if vehicle.fins is None else (*thrusters.names, *vehicle.fins.names)
        return cls(*judged, names, WaterHold.of(vehicle.dynamics, speed_m_s, None if fins is None else (0.0,)))

    def left(self, lost: Sequence[str], cost_limit: float | None) -> Capability:
        health = self.health
        for name in lost:
            health = health.with_thruster(self.names.index(name), 0.0)
        return remaining_capability(self.A, self.limits, health, cost_limit, self.hold)


def left_without(
    vehicle: Vehicle, fins: FinsAtSpeed | None, lost: Sequence[str], speed_m_s: float, cost_limit: float | None
) -> Capability:
    """What a run judges to be left of a vehicle without some of its thrusters.

    Args:
        vehicle: as it is.
        fins: what its fins do at that speed; None for none.
        lost: names of thrusters that are dead.
        speed_m_s: of its missions.
        cost_limit: as a scenario's `control.cost_limit` [N/N].
    """
    return _Whole.of(vehicle, fins, speed_m_s).left(lost, cost_limit)


def fails_without_fins(vehicle: Vehicle, lost: Sequence[str], speed_m_s: float, cost_limit: float | None) -> bool:
    """Whether its thrusters alone follow no path, as for a vehicle at rest; arguments as for `left_without`."""
    thrusters = [name for name in lost if name in vehicle.thrusters.names]
    return left_without(vehicle, None, thrusters, speed_m_s, cost_limit).authority is Authority.SAFE


def as_flown(
    verdict: Verdict,
    left: Capability | None,
    vehicle: Vehicle,
    speed_m_s: float,
    model: Path | None = None,
    lost: Sequence[str] = (),
) -> Verdict:
    """The same verdict, or a no with the reason that the run gives, or the flight of a level line.

    Args:
        verdict: of the analysis.
        left: what the run judges to be left; None where it was not asked.
        vehicle: the hull.
        speed_m_s: at which path following is judged.
        model: its file; None where it cannot be flown.
        lost: names of its dead thrusters.
    """
    if left is None or not verdict.follows:
        return verdict
    if left.authority is Authority.SAFE:
        return replace(verdict, outcome=Outcome.ADRIFT, reason=left.reason)
    doubts = badly_pointed(left, vehicle.dynamics, speed_m_s) or ""
    if model is not None and left.authority in POINTED and (doubts or is_doubtful(left, vehicle, speed_m_s)):
        leaves = leaves_course(model, lost, speed_m_s)
        doubts = "" if leaves is None else "; ".join(filter(None, (doubts, leaves)))
    return replace(verdict, outcome=Outcome.WEAK, reason=f"{verdict.reason}; {doubts}") if doubts else verdict


def table_as_flown(
    table: Survivability,
    vehicle: Vehicle,
    fins: FinsAtSpeed | None,
    speed_m_s: float,
    cost_limit: float | None,
    model: Path | None = None,
) -> Survivability:
    """The same for every case of a table in space; arguments as for `left_without` and `as_flown`."""
    whole = _Whole.of(vehicle, fins, speed_m_s)

    def case_as_flown(case: LossCase) -> LossCase:
        lost = (*table.already, *case.lost)
        if not case.verdict.follows or case.rank == IN_SPACE:
            return case
        A = whole.A[:, [name not in lost for name in whole.names]]
        if capability(A, cost_limit=cost_limit, whole=whole.A, hold=whole.hold).authority not in POINTED:
            return case
        left = whole.left(lost, cost_limit)
        return replace(case, verdict=as_flown(case.verdict, left, vehicle, speed_m_s, model, lost))

    return replace(table, cases=tuple(case_as_flown(case) for case in table.cases))
