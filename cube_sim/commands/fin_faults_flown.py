"""What becomes of a vehicle when one of its fins jams or comes loose: flown, fault by fault.

What a fin does goes with the flow, so nothing less than a flight says whether the others keep a course. It flies
straight ahead and level in still water until it is settled. Then the fault comes, and the controller is told of it, as
it is told of a servo that reports where it stands.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from cube_sim.commands.stuck_flight import DEEP_M, SETTLED_S, ReadModel, straight_ahead, where_stuck
from cube_sim.control.authority import Authority
from cube_sim.control.pace import LEAST_PACE
from cube_sim.control.turned_round import NEAR_M
from cube_sim.flight import Loop
from cube_sim.flight.start import prepared_hull
from cube_sim.recording.signal_store import SignalStore
from cube_sim.scenario.loading import load_mapping
from cube_sim.vehicle.fin_health import FinHealth
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.health import Health

FLOWN_S = 60.0
"""So long it flies on with the fault (a choice)."""
JUDGED_S = 15.0
"""At the end of that it has to be on its course for so long (a choice)."""


class FinFault(NamedTuple):
    """A fin that is jammed at an angle [rad], or loose."""

    fin: str
    angle_rad: float | None = None


@dataclass(frozen=True)
class FinCase:
    """A vehicle beside one fault of a fin.

    Attributes:
        fault: it.
        authority: how the vehicle goes on.
        left: what is left, in words.
        keeps: whether it is on its course again, within `NEAR_M`, and goes on along it.
        reason: why not; empty where it is.
        farthest_m: how far it has been off its course.
        off_m: how far it is in the last `JUDGED_S`, at most.
        speed_m_s: along its course there, in the mean.
    """

    fault: FinFault
    authority: Authority
    left: str
    keeps: bool
    reason: str
    farthest_m: float
    off_m: float
    speed_m_s: float


def every_fin_fault(vehicle: Vehicle, gone: tuple[str, ...] = ()) -> list[FinFault]:
    """Each fin loose, and jammed at half of its travel either way and at its ends."""
    faults: list[FinFault] = []
    if vehicle.fins is not None:
        for name, (low, high) in zip(vehicle.fins.names, vehicle.fins.travel.tolist(), strict=True):
            if name not in gone:
                faults += [FinFault(name), *(FinFault(name, angle) for angle in where_stuck(low, high))]
    return faults


def fin_cases(
    vehicle: Vehicle,
    speed_m_s: float,
    read: ReadModel,
    *,
    faults: list[FinFault] | None = None,
    lost: tuple[str, ...] = (),
    cost_limit: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[FinCase, ...]:
    """Fly beside single faults of fins.

    Args:
        vehicle: whose fins fail.
        speed_m_s: of the course.
        read: the model that the vehicle is of.
        faults: to fly beside; default `every_fin_fault`.
        lost: names of thrusters that are dead already, and of fins that are loose.
        cost_limit: see `cube_sim.control.judged_capability.capability`.
        progress: called with (cases done, all cases).
    """
    asked, cases = every_fin_fault(vehicle, lost) if faults is None else faults, list[FinCase]()
    for fault in asked:
        cases.append(_flown(vehicle, speed_m_s, read, fault, lost, cost_limit))
        if progress is not None:
            progress(len(cases), len(asked))
    return tuple(cases)


def _flown(
    vehicle: Vehicle,
    speed_m_s: float,
    read: ReadModel,
    fault: FinFault,
    lost: tuple[str, ...],
    cost_limit: float | None,
) -> FinCase:
    assert vehicle.fins is not None
    scenario = straight_ahead(read.file, speed_m_s, cost_limit) | {
        "vehicle": vehicle.name,
        "duration_s": SETTLED_S + FLOWN_S,
        "initial": {"position_m": [0.0, 0.0, DEEP_M], "velocity_m_s": [speed_m_s, 0.0, 0.0]},
        "events": [*_gone(vehicle, lost), _event(fault)],
    }
    scenario["control"] |= {"faults": "told"}
    mission = prepared_hull(load_mapping(scenario), read.model, vehicle.name)
    store = SignalStore(mission.channels)
    loop = Loop(mission, store)
    loop.fly_to_its_end()
    index, known = vehicle.fins.names.index(fault.fin), FinHealth.whole(len(vehicle.fins.names))
    health = Health.whole(len(vehicle.thrusters.names))
    for name in lost:
        if name in vehicle.thrusters.names:
            health = health.with_thruster(vehicle.thrusters.names.index(name), 0.0)
        else:
            known = known.with_fin(vehicle.fins.names.index(name), loose=True)
    loose, angle = fault.angle_rad is None, np.nan if fault.angle_rad is None else fault.angle_rad
    left = mission.ability.left(health, known.with_fin(index, jammed=not loose, angle=angle, loose=loose))
    times, off = store.signals["path_error.cross_track"].T
    along = store.signals["pose.position"][:, 1]
    beside, judged = times >= SETTLED_S, times >= SETTLED_S + FLOWN_S - JUDGED_S
    far = float(off[judged].max(initial=0.0)) if judged.any() else np.inf
    speed = float(along[-1] - along[judged][0]) / JUDGED_S if judged.any() else 0.0
    reason = loop.ended or loop.given_up
    if not reason and far > NEAR_M:
        reason = f"it is {far:.2g} m off its course after {FLOWN_S:g} s"
    if not reason and speed < LEAST_PACE * speed_m_s:
        reason = f"it goes on at {speed:.2g} m/s"
    farthest = float(off[beside].max(initial=0.0))
    return FinCase(fault, left.authority, left.reason, not reason, reason, farthest, far, speed)


def _event(fault: FinFault) -> dict[str, Any]:
    event = {"kind": "fins", "at_s": SETTLED_S, "fins": [fault.fin], "state": "loose"}
    if fault.angle_rad is None:
        return event
    return event | {"state": "jammed", "angle_deg": float(np.degrees(fault.angle_rad))}


def _gone(vehicle: Vehicle, lost: tuple[str, ...]) -> list[dict[str, Any]]:
    """What has failed before."""
    thrusters = [name for name in lost if name in vehicle.thrusters.names]
    fins = [name for name in lost if name not in thrusters]
    events: list[dict[str, Any]] = []
    if thrusters:
        events.append({"kind": "thrusters", "at_s": 0.0, "thrusters": thrusters, "state": "dead"})
    if fins:
        events.append({"kind": "fins", "at_s": 0.0, "fins": fins, "state": "loose"})
    return events
