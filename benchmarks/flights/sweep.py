"""Every vehicle of the catalogue on a level line, at a point and on a helix, against what the analysis says of it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
from support.catalogue.vehicles import catalogue

from flights.ability import ability_of
from flights.flight import Row, fly
from flights.mission import Mission
from flights.paths import CENTRE_M
from flights.plan import Plan

FLIGHTS = ("line", "point", "helix")

JUDGED_S = 20.0
"""How long each flight is judged."""

HELIX_SLOPE = np.radians(8.0)


def swept(vehicle: str, path: str, out: Path, keep: bool) -> Row:
    """One flight of a vehicle in still water, half a metre off at the start, heading along the path."""
    entry = catalogue()[vehicle]
    folder = out / f"{vehicle}_{path}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.xml").write_text(entry.make())
    able = ability_of(folder / "model.xml", entry.lost, entry.planar)
    infante = vehicle.startswith("infante")
    speed = 1.2 if infante else float(np.clip(0.5 * able.top_m_s, 0.1, 0.4))
    plan = Plan(0, vehicle, "catalogue", path, ())
    if path == "point" and not able.stands:
        return {"vehicle": vehicle, "path": path, "flown": False, "asked": False}
    from_s = 40.0 if path == "point" else 20.0 + 10.0 / speed
    scenario = _scenario(path, speed, from_s + JUDGED_S, max(3.0, 2.0 * able.length_m, 9.0 * speed), entry.planar)
    scenario["initial"]["velocity_m_s"] = [0.5 if infante else 0.0, 0.0, 0.0]
    if infante:
        scenario["guidance"] |= {"approach_angle_deg": 45.0, "stop_at_end": False}
    if entry.lost:
        scenario["events"] = [{"kind": "thrusters", "at_s": 0.0, "thrusters": list(entry.lost), "state": "dead"}]
        scenario["control"] = {"faults": "told"}
    (folder / "mission.yaml").write_text(json.dumps(scenario, indent=1))
    through = 0.05 if path == "point" else speed
    mission = Mission(plan, scenario, entry.lost, {}, {}, through, from_s, entry.planar, False)
    row = fly(mission, folder, flown_anyway=True, keep=keep)
    if row["passes"] and not keep:
        shutil.rmtree(folder)
    return row | {"asked": True}


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
        "schema_version": 1,
        "name": f"catalogue_{path}",
        "model": "model.xml",
        "duration_s": float(round(duration)),
        "path": block,
        "initial": {"position_m": start, "attitude_deg": attitude},
        "guidance": {"speed_m_s": speed},
        "checks": [{"kind": "allowed_forces"}],
    }


def verdicts(rows: list[Row]) -> list[tuple[str, bool, bool, str, str]]:
    """What became of each vehicle.

    Returns:
        Name, whether the analysis says yes at every speed flown, whether all its flights pass, what came of each, and
        the reason of the analysis.
    """
    found = []
    for vehicle in sorted({row["vehicle"] for row in rows}):
        own = {row["path"]: row for row in rows if row["vehicle"] == vehicle and row.get("asked", True)}
        said = all(row.get("forecast", False) for row in own.values())
        flies = all(row.get("passes", False) for row in own.values())
        came = ", ".join(f"{path} {_figure(own[path])}" for path in FLIGHTS if path in own)
        reason = next((row.get("forecast_reason", "") for row in own.values()), "")
        found.append((vehicle, said, flies, came, reason))
    return found


def _figure(row: Row) -> str:
    rms = row.get("rms_m")
    text = "no figure" if rms is None else f"{100.0 * rms:.1f} cm"
    return text if row.get("passes") else f"{text} ({row.get('cause', '')})"
