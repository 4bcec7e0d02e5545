"""The controller learns of the faults of fins, told or by what is found of them, and goes on with the others.

Where its fins stand the controller sees at every tick, whatever it believes.
"""

from __future__ import annotations

import numpy as np

from cube_sim.control.authority import Authority
from cube_sim.mission.fin_finding import NoUse
from cube_sim.mission.fins import FinSteering
from cube_sim.mission.prepare import Mission
from cube_sim.recording.signal_store import SignalStore
from cube_sim.spatial import State

NOT_MADE_UP = 0.05
"""Share of what a jammed fin makes that the others may leave and still make up for it (a choice)."""


def learn_of_fins(mission: Mission, recorder: SignalStore, t: float) -> bool:
    """Hand what is now believed of the fins to the controller; not what is found and leaves it no way to follow a path.

    Args:
        mission: whose MuJoCo data are up to date at t.
        recorder: gets a row and a sentence when the belief changes.
        t: simulated time [s].

    Returns:
        Whether it has changed.
    """
    events, fins = mission.events, mission.fins
    believed = events.fin_health if mission.scenario.control.faults == "told" else events.fins_told
    if mission.fin_finding is not None:
        believed = mission.fin_finding.found
    if fins is None or believed is events.fins_told:
        return False
    finding, health = mission.fin_finding, mission.allocator.health
    if finding is not None and finding.of_no_use.fins is believed and finding.of_no_use.thrusters is health:
        return False  # judged before
    left = mission.ability.left(health, believed)
    text = believed.describe(fins.fins.names) or "all fins whole"
    if finding is not None and left.authority is Authority.SAFE:
        # It may come back, and what it still makes steers better than nothing.
        told, finding.of_no_use = finding.of_no_use.fins, NoUse(believed, health)
        if believed is not told:
            without = "without it the path cannot be followed, so it flies on as if all were whole"
            recorder.log(t, "WARNING", f"{text}, it seems; {without}")
        return False
    events.fins_told = believed
    record_fin_health(mission, recorder, t)
    mission.controller.reconfigure(left)
    missed = _held_by_others(mission, fins)
    recorder.log(t, "WARNING", "; ".join(filter(None, (text, f"{left.authority.name}: {left.reason}", missed))))
    return True


def _held_by_others(mission: Mission, fins: FinSteering) -> str:
    """Words for what jammed fins make that the others do not make up for, straight ahead at the speed; "" for none."""
    known, speed = mission.events.fins_told, mission.scenario.guidance.speed_m_s
    if not known.jammed.any():
        return ""
    there = np.where(np.isnan(known.angle), mission.data.act[fins.fins.activations], known.angle)
    deflections = np.where(known.jammed, there, 0.0)
    parts = fins.parts(mission.allocator, known)
    ahead = State(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]), np.eye(3), np.array([speed, 0.0, 0.0]), np.zeros(3))
    parts = parts._replace(reach=np.where(known.steers, np.inf, 0.0))  # given the time to turn
    answer = fins.share(parts, np.zeros(6), ahead, np.zeros(3), deflections, mission.force_ratio)
    alone = fins.believed.wrench(deflections, np.r_[speed, np.zeros(5)])
    alone -= fins.believed.wrench(np.zeros(len(deflections)), np.r_[speed, np.zeros(5)])
    made = float(np.linalg.norm(parts.scale * alone))
    if answer.missed <= NOT_MADE_UP * made:
        return ""
    share = 100.0 * (1.0 - min(answer.missed / made, 1.0))
    return f"straight ahead at {speed:g} m/s the others make up for {share:.0f} % of what it makes"


def record_fin_health(mission: Mission, recorder: SignalStore, t: float) -> None:
    """Record what is wrong with the fins, and what the controller believes of them, where a scenario has them fail.

    Args:
        mission: whose fins they are.
        recorder: gets the row.
        t: simulated time [s].
    """
    if any(channel.name == "fin_health" for channel in mission.channels):
        recorder.append("fin_health", t, mission.events.fin_health.codes, mission.events.fins_told.codes)
