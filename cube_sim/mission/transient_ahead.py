"""How far a vehicle will leave its path now that a fault of its thrusters is known, in words for the log."""

from __future__ import annotations

from math import inf

import numpy as np

from cube_sim.control.authority import Authority
from cube_sim.control.foreseen import AHEAD_S, Ahead, Foreseen, carried_along, coasts_m, foreseen
from cube_sim.control.left_thrusters import LeftThrusters
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.safe_mode import LossOfTargetMonitor, SafeMode
from cube_sim.control.thrown import Thrown
from cube_sim.control.transient import transient
from cube_sim.mission.copying import packed, unpacked
from cube_sim.mission.moment import forces_of
from cube_sim.mission.prepare import Mission
from cube_sim.spatial import State, Vector, conjugate, multiply
from cube_sim.vehicle.state import read_state

SIGMAS = 3.0
"""Standard deviations by which a vehicle on sensors may be elsewhere than it believes."""
ASKED_IN_PYTHON = {"control.attitude", "guidance.law", "path"}
"""Code of the user's own that is not asked for what is not flown: it may remember what it was asked."""


def transient_ahead(mission: Mission, known: State | None) -> str | None:
    """Words for how far the vehicle leaves its path; None where nothing can be said.

    Args:
        mission: whose controller goes on with what is left, thrown off as far as its motion shows.
        known: the state that the controller saw at the tick before; None where it has seen none.
    """
    follower, health = mission.controller, mission.allocator.health
    healthy = health.responsive & (health.efficiency == 1.0)
    if not isinstance(follower, PathFollower) or healthy.all():
        return None
    state = read_state(mission.vehicle, mission.data) if known is None or mission.estimation is None else known
    less_known = 0.0 if mission.estimation is None else SIGMAS * mission.estimation.position_sigma_m
    hull, R = follower.loops.dynamics, state.rotation
    off = multiply(conjugate(follower.desired), state.quaternion)
    wanted, thrusters = follower.memory[0]["velocity"], mission.vehicle.thrusters
    thrown = Thrown(
        off_m=_off_m(mission, follower, state),
        velocity=state.velocity - R.T @ wanted,
        turned=2.0 * float(np.copysign(1.0, off[0])) * off[1:],
        rates=state.rates,
        learned=follower.disturbance,
    )
    # It pushes on until the others have made up for it.
    loops, ratio = follower.loop_speeds(mission.ability.delay_s), mission.force_ratio
    expected = forces_of(mission, mission.data.act[thrusters.activations])
    given = mission.data.actuator_force[thrusters.actuators]
    wrench = mission.ability.A @ np.where(healthy, 0.0, given - expected)
    push = np.asarray(np.linalg.solve(hull.total_mass, wrench), dtype=np.float64)
    thrown = thrown.pushed_on(push, loops.delay)
    bound = transient(follower.capability, hull, loops, thrown, R, wanted, follower.current, ratio)
    return bound.known_within(less_known).words_with(_foreseen(mission, follower, state, given, less_known))


def _in_place(mission: Mission) -> bool:
    return mission.path.length <= 0.0


def _off_m(mission: Mission, follower: PathFollower, state: State) -> float:
    error = follower.view(state).error
    return float(np.linalg.norm(error if _in_place(mission) else error[1:]))


def _foreseen(
    mission: Mission, follower: PathFollower, state: State, given: Vector, less_known_m: float
) -> Foreseen | None:
    """Where the law leads by the equations it knows; None where it is not flown ahead."""
    left, m = follower.capability, len(mission.vehicle.thrusters.names)
    budget, off_m = left.budget, _off_m(mission, follower, state)
    if budget is None or budget.which is None or np.any(budget.which >= m) or mission.codes.keys() & ASKED_IN_PYTHON:
        return None  # what fins make goes with the flow
    if left.authority is Authority.SAFE and left.held.any():
        return carried_along(follower, state, off_m, less_known_m)
    lag_s, ratio, wrench = mission.vehicle.lag_s[budget.which], mission.force_ratio, mission.ability.A @ given
    thrusters = LeftThrusters.of(budget, lag_s, ratio, mission.scenario.allocation.torque_weight)
    content = packed(follower, mission.fixed)

    def flown(unknown: Vector, until_back: bool) -> Vector:
        law: PathFollower = unpacked(content, mission.fixed)
        law.monitor = LossOfTargetMonitor(SafeMode(limit=inf))  # to give the path up is no way of keeping to it
        at = state, given[budget.which], wrench, mission.scenario.control_period_s
        return Ahead(law, thrusters, *at, ratio, _in_place(mission), unknown).fly(AHEAD_S, until_back)

    ahead = foreseen(flown(np.zeros(6), False), flown(follower.disturbance, True), less_known_m)
    if left.authority is not Authority.SAFE:
        return ahead
    coasts = off_m + coasts_m(follower, state) + less_known_m  # little is left that would keep it from that
    return ahead._replace(with_margin_m=max(ahead.with_margin_m, coasts))
