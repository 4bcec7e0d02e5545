"""The phases of a mission: which leg the controller flies, and what ends it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, radians
from typing import NamedTuple

import numpy as np

from cube_sim.allocation import FaultTolerant
from cube_sim.control.controller import Controller, GoesOn
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.planar.follower import PlanarFollower
from cube_sim.errors import ScenarioError
from cube_sim.guidance.path import Path
from cube_sim.mission.ability import Ability
from cube_sim.mission.control import controller_of
from cube_sim.mission.fins import fins_at
from cube_sim.mission.hull import CompiledHull
from cube_sim.mission.knowledge import believed_dynamics
from cube_sim.mission.own.code import Codes
from cube_sim.mission.path import path_of
from cube_sim.mission.refusals import wrong_depth
from cube_sim.mission.stopping import PATH_END, RESTING, TIMED, Stops
from cube_sim.scenario import Loaded, Scenario
from cube_sim.scenario.document import Location
from cube_sim.scenario.phase_blocks import PhaseBlock, as_written, is_timed
from cube_sim.spatial import Matrix

_SAME = 1e-9  # of a tick


class Leg(NamedTuple):
    """A phase, ready to be flown.

    Attributes:
        block: what the scenario says of it.
        follower: flies it; None for the first, which the mission's own controller flies from the start.
        path: its path.
    """

    block: PhaseBlock
    follower: Controller | None
    path: Path


class Phases:
    """The phases of a run.

    Args:
        legs: in their order; none for a mission of one path.
        period_s: of the ticks.

    Attributes:
        index: of the one that is flown.
        run_out: how many have been over before the vehicle had arrived, for want of time.
        timed: whether that can be.
    """

    def __init__(self, legs: tuple[Leg, ...], period_s: float) -> None:
        self._legs, self._period, self.index, self.run_out = legs, period_s, 0, 0
        self.timed = is_timed(leg.block for leg in legs)

    def __len__(self) -> int:
        """How many there are."""
        return len(self._legs)

    @property
    def flown(self) -> Leg:
        """The one that is flown."""
        return self._legs[self.index]

    @property
    def last(self) -> bool:
        """Whether it is the last."""
        return self.index + 1 >= len(self._legs)

    @property
    def title(self) -> str:
        """The one that is flown, for readers: its number, how many there are, and its name."""
        return f"phase {self.index + 1} of {len(self)}: {self.flown.block.name}"

    def late(self, stops: Stops, t: float) -> str:
        """That the one that is flown, which is over, has run out of time at t [s]; "" where the vehicle has arrived."""
        record, limit = stops.phase, self.flown.block.time_limit_s
        if limit is None or record["kind"] != PATH_END or record["held"] > record["ticks"]:
            return ""
        return f"{self.title}: has not arrived within {limit:g} s"

    def outline(self, points: int) -> Matrix:
        """(points,3) places on the paths of all phases [m], world axes; each has as many as its length asks for."""
        lengths = np.array([max(leg.path.length, 1e-3) for leg in self._legs])
        ends = np.linspace(0.0, lengths.sum(), points)
        before = np.concatenate([[0.0], np.cumsum(lengths)])
        which = np.clip(np.searchsorted(before, ends, side="right") - 1, 0, len(lengths) - 1)
        legs = [self._legs[i].path for i in which.tolist()]
        along = [min(s - before[i], path.length) for s, i, path in zip(ends, which, legs, strict=True)]
        return np.array([path.at(float(s)).position for path, s in zip(legs, along, strict=True)])

    def begin(self, stops: Stops, t: float) -> None:
        """Let the conditions look for the end of the phase that is flown.

        Args:
            stops: that watch.
            t: at which it begins [s].
        """
        record, block = stops.phase, self.flown.block
        record["held"], record["from_s"] = 0, 0.0
        record["until"] = np.inf if block.time_limit_s is None else t + block.time_limit_s
        if block.for_s is not None:
            record["kind"], record["limit"], record["ticks"] = TIMED, t + block.for_s, 0
            return
        record["kind"], record["limit"] = PATH_END, block.reach_m
        record["turned"] = np.inf if block.within_deg is None else radians(block.within_deg)
        record["ticks"] = ceil(block.hold_s / self._period - _SAME)

    def go_on(self, controller: Controller, stops: Stops, t: float) -> bool:
        """Fly the next one; False after the last, which goes on.

        Args:
            controller: that flies it, changed here.
            stops: that watch for its end.
            t: at which it begins [s].
        """
        if self.last:
            stops.phase["kind"], stops.phase["until"] = RESTING, np.inf
            return False
        self.index += 1
        if (follower := self.flown.follower) is not None and isinstance(controller, GoesOn):
            controller.take_up(follower)
        self.begin(stops, t)
        return True


def phases_of(loaded: Loaded, believed: CompiledHull, allocator: FaultTolerant, codes: Codes) -> Phases:
    """The phases of a scenario, each with what flies it.

    Raises:
        ScenarioError: a phase does not fit the vehicle, or what flies it keeps a path of its own; with position.
    """
    scenario = loaded.scenario
    legs = [_leg(loaded, i, believed, allocator, codes) for i in range(len(scenario.phases))]
    return Phases(tuple(legs), scenario.control_period_s)


def _leg(loaded: Loaded, index: int, believed: CompiledHull, allocator: FaultTolerant, codes: Codes) -> Leg:
    block = loaded.scenario.phases[index]
    one = replace(loaded, scenario=_as_a_whole(loaded.scenario, block), within=_in_phase(loaded, index))
    path = path_of(one, codes)
    start = tuple(path.at(0.0).position.tolist())
    initial = one.scenario.initial.model_copy(update={"position_m": start})
    one = replace(one, scenario=one.scenario.model_copy(update={"initial": initial}))
    dynamics = believed_dynamics(believed.vehicle.dynamics, one.scenario.knowledge, believed.vehicle.lift)
    vehicle = believed.vehicle
    fins = fins_at(vehicle, one.scenario)
    ability = Ability.of(allocator, dynamics, one.scenario, path, vehicle.lag_s, fins)
    try:
        follower = controller_of(one, believed, path, ability, codes)
        mistakes = wrong_depth(one, path, loaded.scenario.initial.position_m[2]) if _is_level(follower) else []
    except ScenarioError as error:
        follower, mistakes = None, error.mistakes
    if mistakes:
        raise ScenarioError([f"{line} (phase {block.name})" for line in mistakes])
    if not isinstance(follower, GoesOn):
        text = "a controller of one's own keeps its path: phases are flown by a law, a function from an aim to a wrench"
        raise ScenarioError([one.mistake("path", text, because="control.law")])
    return Leg(block, follower if index else None, path)


def _is_level(follower: Controller | None) -> bool:
    """Whether nothing that a controller asks for changes depth."""
    return isinstance(follower, PlanarFollower) or (isinstance(follower, PathFollower) and follower.capability.level)


def _in_phase(loaded: Loaded, index: int) -> Callable[[Location], Location]:
    """Where in the file a value stands that stands there in the scenario of one phase alone."""
    block = loaded.scenario.phases[index]

    def place(location: Location) -> Location:
        if location[:1] in (("path",), ("guidance",)):
            location = ("phases", index, *location)
        elif location[:2] == ("control", "attitude") and block.attitude is not None:
            location = ("phases", index, *location[1:])
        if loaded.within is not None:
            return loaded.within(location)
        return as_written(location, loaded.document.data)

    return place


def _as_a_whole(scenario: Scenario, block: PhaseBlock) -> Scenario:
    """A scenario that has this phase alone."""
    control = scenario.control
    if block.attitude is not None:
        control = control.model_copy(update={"attitude": block.attitude})
    alone = {"path": block.path, "guidance": block.guidance, "control": control, "phases": ()}
    return scenario.model_copy(update=alone)
