"""Every vehicle in still water: on a level line, at a point, on a helix, or without two of its thrusters."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from support.catalogue.drawn import drawn_layout
from support.catalogue.mjcf import mjcf
from support.catalogue.steered import steered_by_fins
from support.catalogue.vehicles import Entry, catalogue

from flights.ability import Ability, ability_of
from flights.asked import LIMIT_M
from flights.files import put
from flights.mission import Mission
from flights.paths import CENTRE_M
from flights.plan import Plan

FLIGHTS = ("line", "point", "helix")

JUDGED_S = 20.0
"""How long each flight is judged."""

LATE_S, LATE_M, LATE_JUDGED_S = 100.0, 20.0, 30.0
"""Without two thrusters a flight is judged once it has been under way for a time and a length, and for how long."""

HELIX_SLOPE = np.radians(8.0)

OF_LENGTH = 0.05
"""Largest error RMS of such a vehicle, in its lengths; `LIMIT_M` at least."""

WIDE = 15.0
"""Radius of the helix of a vehicle that its fins steer, in its lengths."""


def every_vehicle() -> dict[str, Entry]:
    """Name -> vehicle: the catalogue, and those that their fins steer."""
    return catalogue() | steered_by_fins()


def trials(vehicles: Sequence[str], files: Path) -> list[tuple[str, str]]:
    """Each vehicle with each of `FLIGHTS` that it is asked for: at a point only who can stay there.

    Args:
        vehicles: names of `every_vehicle`.
        files: folder under which the models go.
    """
    found = []
    for name in vehicles:
        stands = _able(name, files / f"trial_{name}_line")[1].stands
        found += [(name, path) for path in FLIGHTS if path != "point" or stands]
    return found


def trial_of(vehicle: str, path: str, folder: Path) -> Mission:
    """One flight of a vehicle in still water, half a metre off at the start, heading along the path."""
    entry = every_vehicle()[vehicle]
    model, able = _able(vehicle, folder)
    infante = vehicle.startswith("infante")
    speed = 1.2 if infante else entry.speed_m_s or float(np.clip(0.5 * able.top_m_s, 0.1, 0.4))
    plan = Plan(0, vehicle, "catalogue", path, ())
    from_s = 40.0 if path == "point" else 20.0 + 10.0 / speed
    radius, way_on = max(3.0, 2.0 * able.length_m, 9.0 * speed), 0.5 if infante else 0.0
    if entry.speed_m_s is not None:
        from_s, radius, way_on = 60.0 + 20.0 * able.length_m / speed, WIDE * able.length_m, speed
    scenario = _scenario(path, speed, from_s + JUDGED_S, radius, entry.planar)
    scenario |= {"name": f"trial_{path}", "model": str(model)}
    scenario["initial"]["velocity_m_s"] = [way_on, 0.0, 0.0]
    if path == "helix" and entry.speed_m_s is not None:
        scenario["path"]["pitch_m"] *= -1.0  # it is flown so far that it would rise out of the water
        scenario["initial"]["attitude_deg"][1] = float(np.degrees(HELIX_SLOPE))  # along it
    if infante:
        scenario["guidance"] |= {"approach_angle_deg": 45.0, "stop_at_end": False}
    if entry.lost:
        scenario["events"] = [{"kind": "thrusters", "at_s": 0.0, "thrusters": list(entry.lost), "state": "dead"}]
        scenario["control"] = {"faults": "told"}
    through = 0.05 if path == "point" else speed
    limit = LIMIT_M if entry.speed_m_s is None else max(LIMIT_M, OF_LENGTH * able.length_m)
    return Mission(plan, model, scenario, entry.lost, {}, {}, through, from_s, entry.planar, False, limit)


def pairs(vehicles: Sequence[str], files: Path) -> list[tuple[str, tuple[str, ...]]]:
    """Each vehicle with each two of its thrusters.

    Args:
        vehicles: names of the catalogue, or "fresh<m>_<seed>" for layouts of m thrusters drawn anew.
        files: folder under which the models go.
    """
    found = []
    for name in vehicles:
        model = put(files / f"pair_{name}" / "model.xml", layout(name).make())
        found += [(name, lost) for lost in combinations(ability_of(model, (), False).names, 2)]
    return found


def layout(name: str) -> Entry:
    """A vehicle of the catalogue, or one drawn anew."""
    if not name.startswith("fresh"):
        return catalogue()[name]
    m, seed = (int(part) for part in name.removeprefix("fresh").split("_"))
    return Entry(name, lambda: mjcf(name, drawn_layout(seed, m)))


def line_without(vehicle: str, lost: tuple[str, ...], speed_m_s: float | None, folder: Path) -> Mission:
    """A level line in still water, half a metre off at the start, two thrusters dead from the beginning.

    Args:
        vehicle: as for `pairs`.
        lost: names of the dead thrusters.
        speed_m_s: along the line; None for what a trial of the vehicle so would be told.
        folder: for the model.
    """
    model = put(folder / "model.xml", layout(vehicle).make())
    top_m_s = ability_of(model, lost, False).top_m_s
    speed = float(np.clip(0.5 * top_m_s, 0.1, 0.4)) if speed_m_s is None else speed_m_s
    from_s = LATE_S + LATE_M / speed
    scenario = _scenario("line", speed, from_s + LATE_JUDGED_S, 1.0, False)
    scenario |= {"name": "trial_without_two", "model": str(model), "control": {"faults": "told"}}
    scenario["events"] = [{"kind": "thrusters", "at_s": 0.0, "thrusters": list(lost), "state": "dead"}]
    plan = Plan(0, f"{vehicle}-{''.join(lost)}", "without two", "line", ())
    return Mission(plan, model, scenario, lost, {}, {}, speed, from_s, False, False)


def _able(vehicle: str, folder: Path) -> tuple[Path, Ability]:
    entry = every_vehicle()[vehicle]
    model = put(folder / "model.xml", entry.make())
    return model, ability_of(model, entry.lost, entry.planar)


def _scenario(path: str, speed: float, duration: float, radius: float, planar: bool) -> dict[str, Any]:
    x, y, z = CENTRE_M
    start, attitude = [x, y + 0.5, z], [0.0, 0.0, 0.0]
    if path == "point":
        block: dict[str, Any] = {"type": "point", "position_m": [x, y, z], "heading_deg": 30.0}
        start = [x + 0.5, y - 0.5, z if planar else z - 0.5]
    elif path == "line":
        block = {"type": "line", "start_m": [x, y, z], "end_m": [x + 1.5 * speed * duration, y, z]}
    else:
        turn = 2.0 * np.pi * radius
        rise = 0.0 if planar else float(turn * np.tan(HELIX_SLOPE))
        block = {
            "type": "helix",
            "centre_m": [x, y, z],
            "radius_m": radius,
            "pitch_m": rise,
            "turns": 1.5 * speed * duration / turn,
        }
        start, attitude = [x + radius + 0.5, y, z], [0.0, 0.0, 90.0]
    return {
        "duration_s": float(round(duration)),
        "path": block,
        "initial": {"position_m": start, "attitude_deg": attitude},
        "guidance": {"speed_m_s": speed},
    }
