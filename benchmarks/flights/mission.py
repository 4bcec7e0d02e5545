"""A mission in full: the files of a scenario, and what must be known to forecast and to judge it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from support.catalogue import wrong
from support.catalogue.vehicles import Entry, catalogue

from flights.ability import Ability, ability_of
from flights.asked import LIMIT_M
from flights.files import put
from flights.paths import drawn_path
from flights.plan import LEAST_FOR_A_LOSS, Plan, stream

JUDGED_S = 40.0
"""How long a mission is judged."""

RECOVERY_S = 30.0
"""From the last event to the first moment that counts."""

STEEP, GENTLE = np.radians(30.0), np.radians(12.0)
"""Slopes of paths: for vehicles with every component, and for others, whom the analysis asks about 15 degrees."""


@dataclass(frozen=True)
class Mission:
    """What is flown.

    Attributes:
        plan: in outline.
        model: its vehicle's file.
        scenario: what its file would hold, but for checks.
        lost: thrusters that are dead at the end.
        weak: thruster -> the share of its force it gives at the end.
        stuck: thruster -> the force it holds at the end [N].
        through_water_m_s: the fastest it must move through the water.
        from_s: when the judging begins [s].
        planar: whether the vehicle is asked for the plane at its depth.
        steep: whether the path is steeper than the analysis asks of a vehicle that is steered.
        limit_m: largest error RMS.
    """

    plan: Plan
    model: Path
    scenario: dict[str, Any]
    lost: tuple[str, ...]
    weak: Mapping[str, float]
    stuck: Mapping[str, float]
    through_water_m_s: float
    from_s: float
    planar: bool
    steep: bool
    limit_m: float = LIMIT_M


@dataclass
class _Draft:
    """A mission while it is drawn."""

    plan: Plan
    entry: Entry
    able: Ability
    folder: Path
    nominal: str
    scenario: dict[str, Any] = field(default_factory=dict)
    text: str = ""
    current: float = 0.0
    last_event_s: float = 0.0
    weak: dict[str, float] = field(default_factory=dict)
    stuck: dict[str, float] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)


def written(plan: Plan, folder: Path) -> Mission:
    """Draw all of a mission and write model.xml and what else it takes into a folder.

    The draw depends on the plan, the catalogue and the model's numbers; the analysis and the controller have no part
    in it, so that a seed stays the same mission whatever becomes of these.
    """
    entry = catalogue()[plan.vehicle]
    nominal = entry.make()
    able = ability_of(put(folder / "drawing.xml", nominal), entry.lost, entry.planar)
    draft = _Draft(plan, entry, able, folder, nominal, text=nominal, lost=list(entry.lost))
    path = plan.path if able.stands or plan.path != "point" else "line"
    draft.plan = replace(plan, path=path)
    from_s, speed, steep = _outline(draft)
    for name in plan.ingredients:
        _ADD[name](draft, speed, from_s)
    if entry.lost:
        event = {"kind": "thrusters", "at_s": 0.0, "thrusters": list(entry.lost), "state": "dead"}
        draft.scenario["events"] = [event]
        draft.scenario["control"]["faults"] = "told"
    if draft.last_event_s > 0.0:
        from_s = max(from_s, draft.last_event_s + RECOVERY_S)
    # The mission is drawn as if it converged sooner, and judged later: a long hull that starts stern first is swept
    # metres off while it turns, and has its time to come back.
    from_s = max(from_s, able.converges_s)
    draft.scenario["duration_s"] = float(round(from_s + JUDGED_S))
    through_water = (0.05 if path == "point" else speed) + draft.current
    model = put(folder / "model.xml", draft.text)
    draft.scenario["model"] = str(model)
    weak = {name: share for name, share in draft.weak.items() if name not in draft.lost}
    lost, stuck = tuple(draft.lost), draft.stuck
    return Mission(draft.plan, model, draft.scenario, lost, weak, stuck, through_water, from_s, entry.planar, steep)


def _outline(draft: _Draft) -> tuple[float, float, bool]:
    """Path, speed and initial error; returns when the mission has converged [s], the speed [m/s], and `steep`."""
    plan, able, planar = draft.plan, draft.able, draft.entry.planar
    rng = stream(plan.seed, "outline")
    infante = plan.vehicle.startswith("infante")
    sideways = "attitude" in plan.ingredients
    top = able.any_way_m_s if sideways else able.top_m_s
    share = rng.uniform(0.25, 0.6)
    speed = float(rng.uniform(0.8, 1.6)) if infante else float(np.clip(share * top, 0.1, 0.8))
    steep = able.full and not planar and not draft.entry.lost and rng.random() < 0.25
    slope = 0.0 if planar else STEEP if steep else GENTLE
    off = max(rng.uniform(0.2, 2.0), 0.5 * able.length_m)
    turning = 0.0 if able.full and able.stands else 20.0
    from_s = 10.0 + turning + off / (0.6 * speed) + 4.0 / (0.5 * min(speed, 0.8))
    if plan.path == "point":
        from_s = 30.0 + turning + off / speed
    tightest = max(2.0, 2.0 * able.length_m, speed * (5.0 if able.full else 9.0))
    length = 1.2 * speed * (from_s + JUDGED_S + 30.0)
    block, start, heading, table = drawn_path(rng, plan.path, length, tightest, slope)
    if table:
        block["file"] = str(put(draft.folder / block["file"], table))
    away = rng.normal(size=3) * (1.0, 1.0, 0.0 if planar else 0.7)
    place = start + off * away / np.linalg.norm(away)
    any_attitude = not planar and rng.random() < (0.2 if "navigation" in plan.ingredients else 0.5)
    yaw = heading + (rng.uniform(-1.0, 1.0) * (np.radians(60.0) if infante else np.pi))
    tilt = (rng.uniform(-180.0, 180.0), np.degrees(np.arcsin(rng.uniform(-1.0, 1.0)))) if any_attitude else (0.0, 0.0)
    draft.scenario = {
        "schema_version": 1,
        "name": f"mission_{plan.seed}",
        "description": f"{plan.vehicle}, {plan.kind}: {', '.join((plan.path, *plan.ingredients))}.",
        "seed": plan.seed,
        "duration_s": 0.0,
        "path": block,
        "initial": {
            "position_m": [float(x) for x in place],
            "attitude_deg": [float(tilt[0]), float(tilt[1]), float(np.degrees(yaw))],
            "velocity_m_s": [0.5 if infante else 0.0, 0.0, 0.0],
        },
        "guidance": {"speed_m_s": speed},
        "control": {},
    }
    if infante:
        draft.scenario["guidance"] |= {"approach_angle_deg": 45.0, "stop_at_end": False}
    return float(from_s), speed, bool(steep and slope > 0.0)


def _strength(draft: _Draft, rng: np.random.Generator, speed: float) -> float:
    """A current [m/s] the vehicle can meet beside its own speed."""
    top = draft.able.top_m_s if draft.plan.path != "point" else draft.able.any_way_m_s
    own = 0.0 if draft.plan.path == "point" else speed
    return float(np.clip(rng.uniform(0.2, 1.0) * min(0.5 * speed, 0.75 * top - own), 0.02, 0.35))


def _across(draft: _Draft, rng: np.random.Generator, strength: float) -> np.ndarray:
    """(3,) a current of this strength [m/s], level but for a tenth of it, none of it vertical in the plane."""
    azimuth = rng.uniform(-np.pi, np.pi)
    up = 0.0 if draft.entry.planar else 0.1 * rng.uniform(-1.0, 1.0)
    return strength * np.array([np.cos(azimuth), np.sin(azimuth), up])


def _current(draft: _Draft, speed: float, from_s: float) -> None:
    rng = stream(draft.plan.seed, "current")
    strength = _strength(draft, rng, speed)
    draft.scenario["current_m_s"] = [float(x) for x in _across(draft, rng, strength)]
    draft.current = strength
    if rng.random() < 0.3:  # and it changes once
        at = float(rng.uniform(5.0, from_s))
        event = {"kind": "current", "at_s": at, "current_m_s": [float(x) for x in _across(draft, rng, strength)]}
        draft.scenario.setdefault("events", []).append(event)
        draft.last_event_s = max(draft.last_event_s, at)


def _sheared(draft: _Draft, speed: float, from_s: float) -> None:
    """Water that turns and slackens over 6 m of height and over minutes."""
    rng = stream(draft.plan.seed, "sheared")
    strength = _strength(draft, rng, speed)
    first = _across(draft, rng, strength)
    rows = [
        [t, z, *(first * rng.uniform(0.5, 1.0) if k else first)]
        for k, (t, z) in enumerate((t, z) for t in (0.0, 90.0, 240.0) for z in (-23.0, -20.0, -17.0))
    ]
    draft.text = wrong.with_current(draft.text, rows)
    draft.current = strength


def _attitude(draft: _Draft, speed: float, from_s: float) -> None:
    rng = stream(draft.plan.seed, "attitude")
    mode = str(rng.choice(("fixed", "free", "look_at")))
    block: dict[str, Any] = {"mode": mode}
    if mode == "fixed":
        most = 20.0 if draft.able.full and not draft.entry.planar else 0.0
        block["attitude_deg"] = [*(float(x) for x in rng.uniform(-most, most, 2)), float(rng.uniform(-180.0, 180.0))]
    if mode == "look_at":
        place = np.array(draft.scenario["initial"]["position_m"]) + rng.normal(size=3) * (8.0, 8.0, 0.0)
        block["point_m"] = [float(x) for x in place]
    draft.scenario["control"]["attitude"] = block


def _knowledge(draft: _Draft, speed: float, from_s: float) -> None:
    rng = stream(draft.plan.seed, "knowledge")
    factors = {name: float(rng.uniform(0.7, 1.3)) for name in ("drag", "added_mass", "thrust")}
    draft.scenario.setdefault("knowledge", {}).update(factors | {"mass": float(rng.uniform(0.95, 1.05))})


def _navigation(draft: _Draft, speed: float, from_s: float) -> None:
    rng = stream(draft.plan.seed, "navigation")
    block: dict[str, Any] = {"dvl": {"rate_hz": float(rng.choice([2.0, 5.0])), "noise_m_s": 0.01}}
    if rng.random() < 0.7:
        block["position"] = {"rate_hz": float(rng.choice([0.2, 0.5])), "noise_m": float(rng.uniform(0.2, 0.6))}
    draft.scenario["navigation"] = block


def _fault(draft: _Draft, speed: float, from_s: float) -> None:
    """One to three events, at any time; their last state is what the forecast and the judging look at."""
    rng = stream(draft.plan.seed, "fault")
    names, m = draft.able.names, len(draft.able.names)
    what = ("dead", "two", "stuck", "weak", "weak_and_stuck", "recovers") if m >= LEAST_FOR_A_LOSS else ("weak",)
    chosen = str(rng.choice(what))
    order = [int(i) for i in rng.permutation(m)]
    times = sorted(float(t) for t in rng.uniform(8.0, from_s + 10.0, 3))
    events = []

    def add(at: float, index: int, state: str, **more: float) -> None:
        events.append({"kind": "thrusters", "at_s": at, "thrusters": [names[index]], "state": state, **more})

    def sticks(at: float, index: int) -> None:
        low, _, _, high = draft.able.limits[index]
        force = float(rng.choice([-1.0, 1.0]))
        force *= float(rng.uniform(0.1, 1.0)) * (high if force > 0.0 else -low)
        add(at, index, "stuck", force_N=force)
        draft.stuck[names[index]] = force

    if chosen in ("dead", "two"):
        for at, index in zip(times, order[: 1 if chosen == "dead" or m < 8 else 2], strict=False):
            add(at, index, "dead")
            draft.lost.append(names[index])
    elif chosen == "stuck":
        sticks(times[0], order[0])
    elif chosen == "recovers":
        add(times[0], order[0], "dead")
        add(times[1], order[0], "recovered")
    else:
        share = float(rng.uniform(0.3, 0.9))
        add(times[0], order[0], "weak", efficiency=share)
        draft.weak[names[order[0]]] = share
        if chosen == "weak_and_stuck":
            sticks(times[1], order[1])
    draft.scenario.setdefault("events", []).extend(events)
    draft.last_event_s = max([draft.last_event_s, *(event["at_s"] for event in events)])
    draft.scenario["control"]["faults"] = str(rng.choice(("diagnosed", "diagnosed", "told")))


def _allocator(draft: _Draft, speed: float, from_s: float) -> None:
    rng = stream(draft.plan.seed, "allocator")
    m, most = len(draft.able.names), float(np.abs(draft.able.limits).max())
    methods = ["search", "search+proxqp", "clipped_pseudo_inverse", *(["enumerate"] if m <= 4 else [])]
    block: dict[str, Any] = {"method": str(rng.choice(methods))}
    if block["method"] != "clipped_pseudo_inverse":
        block["objective"] = str(rng.choice(("energy", "energy", "target", "reactivity", "reactivity_by_side")))
        if block["objective"] == "target":
            block["target_N"] = [float(x) for x in 0.1 * most * rng.uniform(-1.0, 1.0, m)]
        block["unattainable"] = str(rng.choice(("closest", "scaled")))
        for key in ("reversal_penalty_N2", "switching_penalty_N2"):
            block[key] = float(rng.choice([0.0, (0.2 * most) ** 2]))
    draft.scenario["allocation"] = block


def _misbuilt(draft: _Draft, speed: float, from_s: float) -> None:
    """The vehicle is not as drawn, and the controller knows how it is, or reckons with the drawing."""
    rng = stream(draft.plan.seed, "misbuilt")
    known = rng.random() < 0.6
    what = str(rng.choice(("scattered", "buoyancy", "lift", "reaction")))
    if draft.entry.planar and what == "lift":
        what = "scattered"  # nothing there would hold it at its depth
    if what == "scattered":
        distance = float(rng.uniform(0.0, 0.05 if known else 0.01))
        draft.text = wrong.thrusters_scattered(draft.text, distance, draft.plan.seed)
    elif what == "buoyancy":
        direction = rng.normal(size=3)
        draft.text = wrong.buoyancy_moved(draft.text, (0.01 * direction / np.linalg.norm(direction)).tolist())
    elif what == "lift":
        draft.text = wrong.lift_changed(draft.text, float(rng.choice([-1.0, 1.0]) * rng.uniform(0.005, 0.02)))
    else:
        draft.text = wrong.with_reaction(draft.text, float(rng.choice([-1.0, 1.0]) * rng.uniform(0.005, 0.03)))
    if not known:
        draft.scenario.setdefault("knowledge", {})["model"] = str(draft.folder / "drawing.xml")


def _tick(draft: _Draft, speed: float, from_s: float) -> None:
    period = float(stream(draft.plan.seed, "tick").choice([0.01, 0.02, 0.04, 0.05, 0.08, 0.1]))
    draft.scenario["control_period_s"] = period


_ADD = {
    "current": _current,
    "sheared": _sheared,
    "attitude": _attitude,
    "knowledge": _knowledge,
    "navigation": _navigation,
    "fault": _fault,
    "allocator": _allocator,
    "misbuilt": _misbuilt,
    "tick": _tick,
}
