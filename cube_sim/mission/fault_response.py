"""The controller learns of faults the way the scenario says, and goes on with the thrusters and fins left."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.control.authority import Authority
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.roomiest_attitude import has_enough_somewhere
from cube_sim.mission.fin_response import learn_of_fins
from cube_sim.mission.prepare import Mission
from cube_sim.mission.transient_ahead import transient_ahead
from cube_sim.mission.way_of_flying import depth_not_kept
from cube_sim.recording.signal_store import SignalStore
from cube_sim.spatial import Matrix, State
from cube_sim.vehicle.state import read_state


def respond_to_faults(
    mission: Mission, recorder: SignalStore, t: float, judged: bool = False, known: State | None = None
) -> bool:
    """Hand what is now believed of thrusters and fins to allocation and controller.

    Args:
        mission: whose MuJoCo data are up to date at t.
        recorder: gets a sentence when the belief changes.
        t: simulated time [s].
        judged: whether the forces of this tick have been entered into the evidence already, or say nothing: those of
            a vehicle that is out of the water.
        known: the state the controller saw at the tick before; None where it has seen none.

    Returns:
        Whether the health believed in has changed.
    """
    of_fins = learn_of_fins(mission, recorder, t)
    return _learn_of_thrusters(mission, recorder, t, judged, known) or of_fins


def _learn_of_thrusters(mission: Mission, recorder: SignalStore, t: float, judged: bool, known: State | None) -> bool:
    """Hand what is now believed of the thrusters to allocation and controller; whether that has changed."""
    allocator = mission.allocator
    if mission.fault_finding is not None:
        found, ratio = mission.fault_finding, mission.force_ratio
        health = found.conclude(ratio) if judged else found.judge(mission.data, ratio, mission.supply.force_ratio)
    elif mission.scenario.control.faults == "told":
        health = mission.events.health
    else:
        return False
    if health is allocator.told:
        return False
    if health.equals(allocator.health):
        allocator.told = health  # the same news: told from now on by the object alone
        return False
    allocator.set_health(health)
    left = mission.ability.left(health, mission.events.fins_told)
    mission.controller.reconfigure(left)
    text = health.describe(mission.vehicle.thrusters.names)
    level = (
        "heave, roll and pitch are left to the water" if left.level and not mission.ability.within_limit.level else ""
    )
    depth = depth_not_kept(mission.ability, left, mission.outline) if level else None
    able = mission.ability
    slower = able.badly_pointed(left), able.too_tight(left), mission.too_fast(left)
    more = filter(None, (level, depth, *slower, overpowered(mission), transient_ahead(mission, known)))
    recorder.log(t, "WARNING", "; ".join((text, f"{left.authority.name}: {left.reason}", *more)))
    return True


def overpowered(mission: Mission) -> str | None:
    """Words for thrusters stuck at forces that the others make up for in no attitude; None where they do in one.

    Args:
        mission: whose controller goes on with what is left.
    """
    follower = mission.controller
    if not isinstance(follower, PathFollower):
        return None
    left, attitude = follower.capability, read_state(mission.vehicle, mission.data).rotation
    if left.authority is not Authority.HOLONOMIC or left.budget is None or not left.held.any():
        return None
    if has_enough_somewhere(*follower.kept(mission.force_ratio), attitude):
        return None
    return "in no attitude can the others make up for what is stuck: it will be turned about, or carried off"


def record_actuation(
    mission: Mission, recorder: SignalStore, times: ArrayLike, force_ratios: ArrayLike, limits: Matrix | None = None
) -> None:
    """Record A and the limits as the controller believes them.

    A weak thruster has narrower limits; those of a dead or stuck one are all the one force it gives.

    Args:
        mission: whose allocation it is.
        recorder: gets the rows.
        times: one or (n,) simulated times [s], of `SignalStore.ticks_at_once`; none for no row.
        force_ratios: the share of their force that the supply leaves the thrusters at each.
        limits: (n, m, 4) of whole thrusters at each [N], where they move; None for those of their characteristics.
    """
    t = np.atleast_1d(np.asarray(times, dtype=np.float64))
    if not len(t):
        return
    vehicle, health = mission.vehicle, mission.allocator.health
    whole = vehicle.thrusters.limits if limits is None else limits
    weak = whole * health.efficiency[:, None]
    stuck = ~np.isnan(health.stuck)
    weak[..., stuck, :] = health.stuck[stuck, None]
    matrix = np.broadcast_to(mission.allocator.A.ravel(), (len(t), mission.allocator.A.size))
    rows = np.column_stack([t, matrix, weak.reshape(-1, 4 * len(stuck)) * np.atleast_1d(force_ratios)[:, None]])
    recorder.extend(float(t[0]), float(t[-1]), [("actuation", rows)])
