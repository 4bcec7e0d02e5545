"""Missions drawn by seed in which thrusters fail, once the vehicle is settled: in a corner, at any tick, on sensors."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from support.catalogue.drawn import LEAST, MOST, drawn_layout
from support.catalogue.mjcf import mjcf
from support.catalogue.vehicles import catalogue

from flights.ability import Ability, ability_of
from flights.paths import CENTRE_M, drawn_path

SETTLED_S = {True: 15.0, False: 35.0}
"""When the first fault comes: after less time where all components are the vehicle's own."""
FLOWN_S = 45.0
"""From the first fault on."""
APART_S = 5.0
"""Between the first fault and the second."""
Row = dict[str, Any]

PATHS = ("square", "square", "line", "point", "circle", "helix", "sinusoid")
SHARP_M = 0.2
"""Radius of the corners of a square."""
PERIODS_S = (0.01, 0.02, 0.05, 0.1)
SHARES = (0.3, 0.6, 1.0)
"""Of its limits at which a thruster sticks."""
KINDS = ("dead", "weak", "stuck", "stuck", "two", "weak_and_stuck")
MODES = ("along_path", "along_path", "fixed", "free", "look_at")
SAID = (
    (re.compile(r"transient at most (\S+) m, (\S+) m foreseen"), 1, 2),
    (re.compile(r"transient at most (\S+) m"), 1, None),
    (re.compile(r"transient foreseen (\S+) m, (\S+) m with a margin"), 2, 1),
    (re.compile(r"transient foreseen (\S+) m in"), None, 1),
)
"""Words of the log: where in them it stands how far at most, and how far is foreseen."""
OTHER_LAW = ("infante",)
"""They are flown by the planar law, which foresees nothing."""


def drawn_faults(seed: int, folder: Path) -> dict[str, Any]:
    """The scenario of a mission; its model stands in a folder of its own."""
    rng = np.random.default_rng([43, seed])
    names = [name for name, entry in catalogue().items() if not entry.lost and name not in OTHER_LAW]
    name, planar = str(rng.choice(names)), False
    if seed % 3 == 0:
        m = int(rng.integers(LEAST, MOST + 1))
        name, text = f"fresh{m}_{seed}", mjcf(f"fresh{m}_{seed}", drawn_layout(2000 + seed, m))
    else:
        planar, text = catalogue()[name].planar, catalogue()[name].make()
    model = folder / f"{seed}_{name}.xml"
    folder.mkdir(parents=True, exist_ok=True)
    model.write_text(text)
    able = ability_of(model, (), planar)
    settled = SETTLED_S[able.full and able.stands]
    speed = float(np.clip(rng.uniform(0.2, 0.5) * able.top_m_s, 0.1, 0.6))
    path, start, heading = _path(rng, able, speed, settled, planar)
    azimuth, strength = rng.uniform(-np.pi, np.pi), rng.uniform(0.0, 0.3) * min(speed, able.any_way_m_s)
    moving = 0.0 if path["type"] == "point" else speed
    scenario: dict[str, Any] = {
        "schema_version": 1,
        "name": f"faulted_{seed}",
        "seed": seed,
        "model": str(model.resolve()),
        "duration_s": settled + FLOWN_S + 1.0,
        "control_period_s": float(rng.choice(PERIODS_S)),
        "path": path,
        "initial": {
            "position_m": [float(x) for x in start],
            "attitude_deg": [0.0, 0.0, float(np.degrees(heading))],
            "velocity_m_s": [moving, 0.0, 0.0],
        },
        "current_m_s": [float(strength * np.cos(azimuth)), float(strength * np.sin(azimuth)), 0.0],
        "guidance": {"speed_m_s": speed},
        "events": _events(rng, able, settled),
        "checks": [{"kind": "allowed_forces"}],
    }
    mode = str(rng.choice(MODES))
    if mode != "along_path":
        scenario["control"] = {"attitude": _attitude(rng, mode, able, start, planar)}
    if rng.random() < 0.25:
        block: dict[str, Any] = {"dvl": {"rate_hz": 5.0, "noise_m_s": 0.01}}
        if rng.random() < 0.7:
            block["position"] = {"rate_hz": 0.5, "noise_m": float(rng.uniform(0.2, 0.5))}
        scenario["navigation"] = block
    if rng.random() < 0.2:
        scenario["knowledge"] = {key: float(rng.uniform(0.8, 1.2)) for key in ("drag", "added_mass", "thrust")}
    return scenario


def _path(
    rng: np.random.Generator, able: Ability, speed: float, settled: float, planar: bool
) -> tuple[dict[str, Any], np.ndarray, float]:
    kinds = [kind for kind in PATHS if (able.stands or kind != "point") and not (planar and kind == "helix")]
    kind, centre = str(rng.choice(kinds)), np.array(CENTRE_M)
    if kind == "square":  # the fault comes within two seconds of a corner
        leg, side = speed * (settled + rng.uniform(-2.0, 2.0)), max(3.0, 15.0 * speed)
        turns = np.array([[leg, 0, 0], [0, side, 0], [side, 0, 0], [0, -side, 0], [3.0 * side, 0, 0]])
        points = np.vstack([centre, centre + np.cumsum(turns, axis=0)])
        return {"type": "polyline", "points_m": points.tolist(), "corner_radius_m": SHARP_M}, centre, 0.0
    radius = max(2.0, 2.0 * able.length_m, 9.0 * speed)
    slope = 0.0 if planar else 0.15
    block, start, heading, _ = drawn_path(rng, kind, 1.4 * speed * (settled + FLOWN_S), radius, slope)
    return block, start, heading


def _attitude(rng: np.random.Generator, mode: str, able: Ability, start: np.ndarray, planar: bool) -> dict[str, Any]:
    block: dict[str, Any] = {"mode": mode}
    if mode == "fixed":
        most = 20.0 if able.full and not planar else 0.0
        block["attitude_deg"] = [*(float(x) for x in rng.uniform(-most, most, 2)), float(rng.uniform(-180.0, 180.0))]
    if mode == "look_at":
        block["point_m"] = [float(x) for x in start + rng.normal(size=3) * (8.0, 8.0, 0.0)]
    return block


def _events(rng: np.random.Generator, able: Ability, at: float) -> list[dict[str, Any]]:
    kind = str(rng.choice(KINDS))
    first, second = (int(i) for i in rng.permutation(len(able.names))[:2])

    def event(at: float, index: int, state: str) -> dict[str, Any]:
        block = {"kind": "thrusters", "at_s": float(at), "thrusters": [able.names[index]], "state": state}
        if state == "weak":
            block["efficiency"] = float(rng.uniform(0.3, 0.7))
        if state == "stuck":
            ends = [float(x) for x in able.limits[index][[0, 3]] if x != 0.0]
            block["force_N"] = float(rng.choice(SHARES)) * float(rng.choice(ends))
        return block

    at += float(rng.uniform(0.0, 1.0))
    if kind == "weak_and_stuck":
        return [event(at, first, "weak"), event(at, second, "stuck")]
    if kind == "two":
        return [event(at + k * APART_S, i, str(rng.choice(["dead", "stuck"]))) for k, i in enumerate((first, second))]
    return [event(at, first, kind)]


def said_and_flown(seed: int, folder: Path) -> list[Row]:
    """What the log of a mission says of each fault that is found, and how far the vehicle leaves its path then."""
    from cube_sim.control.foreseen import AHEAD_S
    from cube_sim.flight import Flight

    scenario = drawn_faults(seed, folder)
    flight = Flight(scenario)
    flight.fly(flight.mission.scenario.ticks)
    signals, rows = flight.signals, []
    t, error = np.abs(signals["path_error.cross_track"]).T
    if scenario["path"]["type"] == "point":
        error = np.hypot(error, signals["path_error.along"][:, 1])
    lines = [line for line in flight.log if "transient" in line.text]
    for k, line in enumerate(lines):
        after = lines[k + 1].t if k + 1 < len(lines) else np.inf
        during = (t >= line.t) & (t <= min(after, line.t + AHEAD_S))
        at_most, foreseen = said_of(line.text)
        flown = float(np.max(error[during]))
        rows.append({
            "seed": seed,
            "vehicle": Path(scenario["model"]).stem,
            "path": scenario["path"]["type"],
            "mode": scenario.get("control", {}).get("attitude", {}).get("mode", "along_path"),
            "period_s": scenario["control_period_s"],
            "navigated": "navigation" in scenario,
            "known_wrongly": "knowledge" in scenario,
            "authority": line.text.split("; ")[1].split(":")[0],
            "found_s": line.t,
            "start_m": float(error[during][0]),
            "flown_m": flown,
            "at_most_m": at_most,
            "foreseen_m": foreseen,
            "bounded": "transient at most" in line.text,
            "beyond": at_most is not None and flown > at_most,
            "said": line.text,
        })  # fmt: skip
    return rows


def said_of(text: str) -> tuple[float | None, float | None]:
    """How far at most and how far is foreseen, in the words of the log [m]; None where it does not say."""
    for pattern, most, foreseen in SAID:
        if (found := pattern.search(text)) is not None:
            numbers = [None if group is None else float(found[group]) for group in (most, foreseen)]
            return numbers[0], numbers[1]
    return None, None
