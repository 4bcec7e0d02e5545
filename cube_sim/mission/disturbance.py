"""The scenario's `force` events as pushes of the model that flies."""

from __future__ import annotations

from math import inf

import mujoco

from cube_sim.errors import ScenarioError
from cube_sim.scenario import Loaded, Scenario
from cube_sim.scenario.event_blocks import ForceEventBlock
from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.pushes import Push, Triple, push_table, set_push
from cube_sim.vehicle.vehicle import Vehicle


def force_events(scenario: Scenario) -> list[tuple[int, ForceEventBlock]]:
    """Those that push the vehicle, with their places among the events."""
    return [(i, event) for i, event in enumerate(scenario.events) if isinstance(event, ForceEventBlock)]


def pushes_of(scenario: Scenario, model: mujoco.MjModel) -> Matrix | None:
    """The model's table of pushes, for a vehicle that something pushes; others beside it may be pushed."""
    return push_table(model) if force_events(scenario) else None


def set_pushes(loaded: Loaded, model: mujoco.MjModel, vehicle: Vehicle, first: int = 0) -> None:
    """Let the events push the vehicle when their time has come.

    Args:
        loaded: the scenario.
        model: with room for them; changed here.
        vehicle: that flies.
        first: row of its first push, behind those of other vehicles.

    Raises:
        ScenarioError: an event names a site that is not the hull's; with position.
    """
    mistakes = []
    for row, (i, event) in enumerate(force_events(loaded.scenario), first):
        point = event.point_m if event.site is None else _site(model, vehicle, event.site)
        if point is None and event.site is not None:
            own = [model.site(k).name for k in range(model.nsite) if model.site_bodyid[k] == vehicle.body]
            there = ", ".join(filter(None, own)) or "none"
            text = f"the hull '{vehicle.name}' has no site '{event.site}'; it has {there}"
            mistakes.append(loaded.mistake(f"events.{i}.site", text))
            continue
        push = Push(
            force=event.force_N,
            torque=event.torque_N_m,
            point=_triple(model.body_ipos[vehicle.body]) if point is None else point,
            in_body=event.axes == "body",
            start_s=event.at_s,
            ramp_s=event.over_s,
            end_s=inf if event.for_s is None else event.at_s + event.for_s,
        )
        set_push(model, row, vehicle.body, push)
    if mistakes:
        raise ScenarioError(mistakes)


def _site(model: mujoco.MjModel, vehicle: Vehicle, name: str) -> Triple | None:
    """A site of the hull in body axes [m]; None where the hull has no such site."""
    site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, f"{vehicle.thrusters.prefix}{name}")
    return _triple(model.site_pos[site]) if site >= 0 and model.site_bodyid[site] == vehicle.body else None


def _triple(vector: Vector) -> Triple:
    x, y, z = vector.tolist()
    return (x, y, z)
