"""A vehicle flown on beside a fault of its thrusters, before it has ever flown: by its law and its equations of motion.

It flies straight ahead in still water, or stays at a point, until it is settled. Then a thruster gives another force
than it is asked for, and nobody knows; once that is found, the law goes on with the thrusters that are left.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import mujoco
import numpy as np

from cube_sim.control.authority import Authority, Capability
from cube_sim.control.foreseen import AHEAD_S, Ahead, Foreseen, foreseen
from cube_sim.control.left_thrusters import LeftThrusters
from cube_sim.control.loop_times import USUAL_PERIOD_S
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.safe_mode import LossOfTargetMonitor, SafeMode
from cube_sim.mission.ability import Ability
from cube_sim.mission.allocation import allocator_of
from cube_sim.mission.control import controller_of
from cube_sim.mission.copying import packed, unpacked
from cube_sim.mission.hull import CompiledHull
from cube_sim.mission.path import path_of
from cube_sim.scenario.loading import load_mapping
from cube_sim.spatial import State, Vector
from cube_sim.vehicle.vehicle import Vehicle

SETTLED_S = 20.0
"""It flies so long before the fault (a choice)."""
DEEP_M = -20.0
"""So deep that the surface is of no matter."""
SHARES = (0.5, 1.0)
"""Of what it can do at which a thruster, or a fin, sticks."""


class ReadModel(NamedTuple):
    """A model that a vehicle is of: its file, and what is compiled of it."""

    file: Path
    model: mujoco.MjModel


class BesideFaults:
    """A vehicle that is settled, and goes on from there beside each fault.

    Args:
        read: the model.
        vehicle: of it.
        whole: what all its thrusters can do, or those that are not lost.
        speed_m_s: straight ahead.
        in_place: whether to stay at a point instead.
        cost_limit: see `cube_sim.control.judged_capability.capability`.
    """

    def __init__(
        self,
        read: ReadModel,
        vehicle: Vehicle,
        whole: Capability,
        speed_m_s: float,
        in_place: bool,
        cost_limit: float | None,
    ) -> None:
        self._vehicle, self._in_place = vehicle, in_place
        scenario, ahead = _scenario(read.file, speed_m_s, in_place, cost_limit), 0.0 if in_place else speed_m_s
        self._settled = self._settle(scenario, CompiledHull(read.model, vehicle), whole, ahead)

    def foreseen(self, thruster: int, given_N: float, left: Capability, found_s: float) -> Foreseen | None:
        """How far it leaves its path from the fault on; None where that is not foreseen.

        Args:
            thruster: that does not do what it is told.
            given_N: what it gives.
            left: what the others can do.
            found_s: by when that is known [s].
        """
        if self._settled is None or not self._is_flown(left):
            return None
        ahead, before = unpacked(self._settled, {})
        forces = np.zeros(len(self._vehicle.thrusters.names))
        (number,) = np.flatnonzero(before == thruster)
        ahead.moved_by = ahead.moved_by.with_fault(int(number), given_N)
        off = ahead.fly(found_s)
        forces[before] = ahead.forces
        ahead.follower.reconfigure(left)
        ahead.go_on_with(*self._of(left, forces))
        return foreseen(np.concatenate([off, ahead.fly(AHEAD_S, until_back=True)]))

    def _settle(
        self, scenario: dict[str, Any], hull: CompiledHull, whole: Capability, speed_m_s: float
    ) -> bytes | None:
        """The settled flight and the numbers of the thrusters that fly it; None where it is not flown ahead."""
        if not self._is_flown(whole):
            return None
        loaded = load_mapping(scenario)
        allocator, path = allocator_of(loaded, hull.vehicle, {}), path_of(loaded)
        dynamics = hull.vehicle.dynamics
        ability = Ability.of(allocator, dynamics, loaded.scenario, path, hull.vehicle.lag_s)
        follower = controller_of(loaded, hull, path, ability)
        if not isinstance(follower, PathFollower):
            return None
        follower.reconfigure(whole)
        follower.monitor = LossOfTargetMonitor(SafeMode())
        position, R = np.array([0.0, 0.0, DEEP_M]), np.eye(3)
        state = State(position, np.array([1.0, 0.0, 0.0, 0.0]), R, np.array([speed_m_s, 0.0, 0.0]), np.zeros(3))
        thrusters, forces = self._of(whole, np.zeros(len(hull.vehicle.thrusters.names)))
        ahead = Ahead(follower, thrusters, state, forces, np.zeros(6), USUAL_PERIOD_S, in_place=self._in_place)
        ahead.fly(SETTLED_S)
        assert whole.budget is not None
        return packed((ahead, whole.budget.which), {})

    def _is_flown(self, left: Capability) -> bool:
        """Whether thrusters alone are flown ahead: what fins make goes with the flow."""
        budget = left.budget
        if budget is None or budget.which is None or self._vehicle.fins is not None:
            return False
        return left.authority is not Authority.SAFE

    def _of(self, left: Capability, forces: Vector) -> tuple[LeftThrusters, Vector]:
        """Those that are left, and what they make of all (m,) forces [N]."""
        budget = left.budget
        assert budget is not None
        assert budget.which is not None
        return LeftThrusters.of(budget, self._vehicle.lag_s[budget.which]), forces[budget.which]


def _scenario(file: Path, speed_m_s: float, in_place: bool, cost_limit: float | None) -> dict[str, Any]:
    """A line that does not end, or a point, as a scenario that says nothing else has it."""
    scenario = straight_ahead(file, speed_m_s, cost_limit)
    if in_place:
        scenario["path"] = {"type": "point", "position_m": scenario["initial"]["position_m"], "heading_deg": 0.0}
    return scenario


def straight_ahead(file: Path, speed_m_s: float, cost_limit: float | None) -> dict[str, Any]:
    """A level line that does not end, as a scenario that says nothing else has it.

    Args:
        file: of the model.
        speed_m_s: along the line.
        cost_limit: see `cube_sim.control.judged_capability.capability`.
    """
    start = [0.0, 0.0, DEEP_M]
    return {
        "schema_version": 1,
        "name": "ahead",
        "model": str(file),
        "duration_s": 1.0,
        "path": {"type": "line", "start_m": start, "end_m": [1000.0 * speed_m_s, 0.0, DEEP_M]},
        "initial": {"position_m": start},
        "guidance": {"speed_m_s": speed_m_s},
        "control": {} if cost_limit is None else {"cost_limit": cost_limit},
        "checks": [{"kind": "allowed_forces"}],
    }


def where_stuck(low: float, high: float) -> list[float]:
    """Half of either end, and the ends, of what a thruster or a fin can do; an end at 0 is none."""
    return [share * end for share in SHARES for end in (low, high) if end != 0.0]
