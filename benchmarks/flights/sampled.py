"""A mission as a generator of samples gives it: what it changes in the scenario, and notes for its row."""

from __future__ import annotations

from typing import Any

from flights.asked import checks
from flights.forecast import forecast
from flights.mission import Mission

Sample = tuple[dict[str, Any], dict[str, Any]]


def sampled(mission: Mission) -> Sample:
    """The overrides of a mission, its checks among them, and its notes, among them what the analysis says of it."""
    expected = forecast(
        mission.model,
        lost=mission.lost,
        weak=mission.weak,
        stuck=mission.stuck,
        speed_m_s=mission.through_water_m_s,
        planar=mission.planar,
        steep=mission.steep,
    )
    overrides = {key: value for key, value in mission.scenario.items() if key != "schema_version"}
    plan = mission.plan
    notes = {
        "seed": plan.seed,
        "vehicle": plan.vehicle,
        "kind": plan.kind,
        "path": plan.path,
        "ingredients": list(plan.ingredients),
        "faults": _faults(mission),
        "forecast": expected.flies,
        "forecast_reason": expected.reason,
        "speed_m_s": mission.scenario["guidance"]["speed_m_s"],
        "through_water_m_s": mission.through_water_m_s,
    }
    return overrides | {"checks": checks(mission.scenario, mission.from_s, mission.planar, mission.limit_m)}, notes


def _faults(mission: Mission) -> str:
    """What is wrong with the thrusters at the end, in words."""
    said = [f"{name} dead" for name in mission.lost]
    said += [f"{name} weak {share:.2f}" for name, share in mission.weak.items()]
    said += [f"{name} stuck {force:.0f} N" for name, force in mission.stuck.items()]
    return ", ".join(said)
