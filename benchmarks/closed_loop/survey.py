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
from cube_sim.errors import ScenarioError
from cube_sim.spatial import rotation_about
from cube_sim.vehicle.dynamics import Dynamics

SHARES = (0.0, 0.2, 0.4, 0.6)
"""Speeds, as shares of that which takes 60 % of the thrusters' force: at rest, and three as missions have them."""
STEERED = (Authority.PLANE, Authority.LINE, Authority.UNICYCLE)
WATER_HOLDS = 0.5
"""Share of its righting moment that a hull at trim must keep for its loops to be nearly what they are at rest."""
TILT = 1e-5
"""Of the differences [rad]."""


class Row(NamedTuple):
    """What was found.

    Attributes:
        vehicle: its name.
        speed_m_s: along the path.
        words: what is known wrongly.
        authority: how it flies; empty where it does not.
        upright: share of its righting moment that the flow ahead leaves it, in roll or pitch, the less.
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
    upright: float = 1.0
    radius: float = np.nan
    gain_db: float = np.nan
    phase_deg: float = np.nan
    helped: float = np.nan
    why: str = ""

    @property
    def held(self) -> bool:
        """Whether nothing is steered: what the thrusters do not make, the water holds as well as nearly at rest."""
        return self.authority == "HOLONOMIC" or (self.authority in ("LEVEL", "TRIM") and self.upright >= WATER_HOLDS)

    @property
    def stable(self) -> bool:
        """Whether everything the thrusters move comes back."""
        return self.radius < 1.0


def surveyed(entry: Entry, share: float, conditions: Sequence[Condition], held_only: bool = False) -> list[Row]:
    """One row for each condition, or a single one that says why there is none.

    Args:
        entry: the vehicle.
        share: its speed, as a share of its top speed.
        conditions: what it knows wrongly.
        held_only: look only at what the thrusters and the water hold, see `Row.held`.
    """
    with TemporaryDirectory() as name:
        folder = Path(name)
        model = folder / "vehicle.xml"
        model.write_text(entry.make())
        speed = share * ability_of(model, entry.lost, entry.planar).top_m_s
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
            upright = uprightness(flown.hull, float(np.linalg.norm(np.subtract((speed, 0.0, 0.0), condition.water))))
            start = Row(entry.name, speed, condition.words, authority.name, upright)
            if held_only and not start.held:
                rows.append(start._replace(why="left out"))
                continue
            if not rows and share > 0.0:
                said = forecast(model, lost=entry.lost, weak={}, stuck={}, speed_m_s=speed, planar=entry.planar)
                if not said.flies:
                    return [Row(entry.name, speed, "", why=f"the analysis says {said.reason}")]
            if share == 0.0 and authority in STEERED:
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


def uprightness(hull: Dynamics, speed_m_s: float) -> float:
    """Share of its righting moment a level hull keeps at a speed through the water; negative where it turns over.

    A hull tilted against its course is turned further by the Munk moment wherever it has more added mass aside.
    """
    left = []
    for axis in (0, 1):
        slopes = []
        for speed in (speed_m_s, 0.0):
            turned = [rotation_about(np.eye(3)[axis], angle) for angle in (TILT, -TILT)]
            ahead, up = np.array([R.T @ [speed, 0.0, 0.0] for R in turned]), np.array([R[2] for R in turned])
            moments = hull.steady_wrenches(ahead, up)[:, 3 + axis]
            slopes.append((moments[0] - moments[1]) / (2.0 * TILT))
        left.append(slopes[0] / slopes[1] if slopes[1] > 0.0 else 0.0)
    return float(min(left))
