"""Margins of a vehicle at one speed, under every condition asked for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
from flights.ability import ability_of
from flights.forecast import forecast
from support.catalogue.vehicles import Entry

from closed_loop.condition import Condition
from closed_loop.drift import drift
from closed_loop.flown_loop import FlownLoop
from closed_loop.linear_loop import SETTLED, linearised
from closed_loop.stability import all_margins
from cube_sim.control.authority import Authority
from cube_sim.control.critical_speed import surely_uncritical_speed
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.loop_times import USUAL_PERIOD_S, mean_delay
from cube_sim.control.yielding import WaterHold
from cube_sim.errors import ScenarioError
from cube_sim.vehicle.loading import load_model
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.health import Health

THIRDS = (0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0)
"""Speeds looked at: at rest, and three up to the slower of a path's and the critical one."""
BEYOND = 2.0
"""Stands for the speed of a path that is beyond the critical one."""
SHARES = (*THIRDS, BEYOND)
MISSION = 0.6
"""Speed of a path, as a share of that which takes 60 % of the thrusters' force."""
STEERED = (Authority.PLANE, Authority.LINE, Authority.UNICYCLE)
INSIDE = 0.999
"""Share of the critical speed that is not beyond it."""


class Row(NamedTuple):
    """What was found.

    Attributes:
        vehicle: its name.
        speed_m_s: along the path.
        words: what is known wrongly.
        authority: how it flies; empty where it does not.
        beyond: whether that is beyond the critical speed.
        radius: spectral radius over a tick; below 1 it is stable.
        gain_db: least gain margin of any direction.
        phase_deg: least phase margin.
        helped: largest share of a force carrying the hull away that the thrusters add to it.
        why: why there are no figures; empty where there are.
    """

    vehicle: str
    speed_m_s: float
    words: str
    authority: str = ""
    beyond: bool = False
    radius: float = np.nan
    gain_db: float = np.nan
    phase_deg: float = np.nan
    helped: float = np.nan
    why: str = ""

    @property
    def stable(self) -> bool:
        """Whether everything the thrusters move comes back."""
        return self.radius < 1.0


def speed_of(entry: Entry, share: float, known_to: float = 0.0) -> float | None:
    """What a share of `SHARES` is for a vehicle [m/s]; None where the path's speed is not beyond, or there is none.

    Args:
        entry: the vehicle.
        share: of `SHARES`.
        known_to: by which share its added mass and drag may be wrong, see `surely_uncritical_speed`.
    """
    with TemporaryDirectory() as name:
        model = Path(name) / "vehicle.xml"
        model.write_text(entry.make())
        path = MISSION * ability_of(model, entry.lost, entry.planar).top_m_s
        vehicle = Vehicle.from_model(load_model(str(model)))
    if path == 0.0:
        return 0.0 if share == 0.0 else None
    health = Health.whole(len(vehicle.thrusters.names))
    for lost in entry.lost:
        health = health.with_thruster(vehicle.thrusters.names.index(lost), 0.0)
    hull, limits = vehicle.dynamics, vehicle.thrusters.limits
    left = remaining_capability(vehicle.actuation_matrix, limits, health, hold=WaterHold.of(hull, path))
    delay = mean_delay(vehicle.thrusters.lag_s, USUAL_PERIOD_S)
    critical = surely_uncritical_speed(left, hull, delay, known_to)
    if share == BEYOND:
        return path if path > critical else None
    return share * min(path, INSIDE * critical)


def surveyed(entry: Entry, share: float, conditions: Sequence[Condition], known_to: float = 0.0) -> list[Row]:
    """One row for each condition, a single one that says why there is none, or none where there is no such speed.

    Args:
        entry: the vehicle.
        share: its speed, of `SHARES`.
        conditions: what it knows wrongly.
        known_to: by which share added mass and drag may be wrong, for the critical speed.
    """
    speed = speed_of(entry, share, known_to)
    if speed is None:
        return []
    with TemporaryDirectory() as name:
        folder = Path(name)
        model = folder / "vehicle.xml"
        model.write_text(entry.make())
        if entry.planar:  # nothing of it answers water that rises
            conditions = [c for c in conditions if not c.water[2] and not (c.believed and c.believed[2])]
        rows, near = [], None
        for condition in conditions:
            try:
                flown = FlownLoop(entry, speed, condition, folder)
            except (TypeError, ScenarioError):
                return [Row(entry.name, speed, "", why="flown by the planar law")]
            authority = flown.authority
            if authority is Authority.SAFE:
                return [Row(entry.name, speed, "", why=flown.controller.capability.reason)]
            start = Row(entry.name, speed, condition.words, authority.name, flown.too_fast(known_to))
            if not rows and speed > 0.0:
                said = forecast(model, lost=entry.lost, weak={}, stuck={}, speed_m_s=speed, planar=entry.planar)
                if not said.flies:
                    return [Row(entry.name, speed, "", why=f"the analysis says {said.reason}")]
            if speed == 0.0 and authority in STEERED:
                return [
                    Row(entry.name, speed, "", authority.name, why="steers by its attitude: nothing to steer at rest")
                ]
            loop = linearised(flown, near)
            if loop.drift > SETTLED:
                rows.append(start._replace(why="no steady motion"))
                continue
            near = near or loop.point
            margins = all_margins(loop)
            rows.append(
                start._replace(
                    radius=loop.spectral_radius,
                    gain_db=min(m.gain_db for m in margins),
                    phase_deg=min(m.phase_deg for m in margins),
                    helped=max(drift(loop, axis).helped for axis in range(3)),
                )
            )
        return rows
