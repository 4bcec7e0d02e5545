"""Ticks that one compiled call flies, and what they leave behind."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.flown import FlownAllocator, SearchCodes
from cube_sim.allocation.responsive import ResponsiveThrusters
from cube_sim.control.answering import LawParts
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.planar.steering import PlanarParts
from cube_sim.flight.compiled.loop import BEGIN, FLOWN, JUDGED, MET, STOP, fly
from cube_sim.flight.compiled.parts import (
    Answering,
    Course,
    Engine,
    FaultWatch,
    Feed,
    FinServos,
    Hull,
    Moment,
    Notes,
    Sensing,
)
from cube_sim.flight.rows import TickRows
from cube_sim.guidance.law import Target
from cube_sim.mission import Mission
from cube_sim.mission.setpoints import SetpointParts
from cube_sim.spatial import Record, State, Vector
from cube_sim.vehicle.carried_joints import JointPlaces
from cube_sim.vehicle.plugin.clock import held_still


class FlyArguments(NamedTuple):
    """Those of `cube_sim.flight.compiled.loop.fly`, which says what they are."""

    codes: tuple[int, int, int, SearchCodes, int, int]
    first: int
    ticks: int
    tick: int
    engine: Engine
    hull: Hull
    feed: Feed
    fins: FinServos
    setpoints: SetpointParts
    joints: JointPlaces
    evidence: FaultWatch
    sensing: Sensing
    course: Course
    law: LawParts
    planar: PlanarParts
    answering: Answering
    thrusters: ResponsiveThrusters
    moment: Moment
    rows: TickRows
    notes: Notes
    stops: Record


class FlownTicks(NamedTuple):
    """What the compiled loop has done.

    Attributes:
        ticks: how many it flew.
        reached: how far the next one has come, as `cube_sim.flight.compiled.loop` names it.
        rows: of the ticks flown.
        pace: (ticks,) share of the speed along the path.
        force_ratio_before: share of their force that the thrusters gave at the tick before.
        force_ratio: (ticks,) that share at each tick.
        limits: (ticks,m,4) of whole thrusters [N], where they move; none else.
        sensing: what was estimated; also at the next tick, once its state is.
    """

    ticks: int
    reached: int
    rows: TickRows
    pace: Vector
    force_ratio_before: float
    force_ratio: Vector
    limits: NDArray[np.float64]
    sensing: Sensing


class Stretch:
    """Ticks that one compiled call flies; another thread may look meanwhile at those it has flown.

    Args:
        mission: whose parts are moved on.
        allocator: that the code asks.
        target: of the controller.
        given: arguments of the code.

    Attributes:
        ticks: how many are flown, once all are.
        reached: how far the next one has come then.
    """

    def __init__(self, mission: Mission, allocator: FlownAllocator, target: Target, given: FlyArguments) -> None:
        self._mission, self._allocator, self._target, self._given = mission, allocator, target, given
        self._ratio_before = mission.force_ratio
        self.ticks, self.reached = 0, BEGIN
        self._tick: Callable[..., tuple[int, int]] | None = None

    def fly(self) -> None:
        """Fly them, up to one that has something for Python to do."""
        with held_still():
            self.ticks, self.reached = fly(*self._given)

    def fly_tick(self) -> int:
        """Fly the next tick among others in the same data, and say how far it has come: `TICKED` if it is flown."""
        if self._tick is None:  # what kinds its arguments are is looked at once, not at every tick
            self._tick = fly.form(*self._given).call
        codes, _, _, *others = self._given
        self.ticks, self.reached = self._tick(codes, self.ticks, self.ticks + 1, *others)
        return self.reached

    @property
    def room(self) -> int:
        """How many ticks it may fly yet."""
        return self._given.ticks - self.ticks

    def stop(self) -> None:
        """Let whoever flies come to an end after the tick that is being flown."""
        self._given.notes.told[STOP] = 1

    @property
    def so_far(self) -> int:
        """How many are flown by now, but for the last of all."""
        return int(self._given.notes.told[FLOWN])

    def finish(self) -> None:
        """Tell the objects in Python how far they have come, once all are flown; but for the answers, see `confirm`."""
        given, mission, controller = self._given, self._mission, self._mission.controller
        self._target.arc_length = float(given.course.arc_length[0])
        if self.ticks and isinstance(controller, PathFollower):
            controller.desired = given.answering.quaternion
        mission.supply.power = given.feed.power
        if mission.fault_finding is not None:
            mission.fault_finding.take_over(self.ticks + (self.reached >= JUDGED))
        mission.allocator.take_over(given.thrusters)
        self._allocator.add_effort(*given.notes.effort.tolist())

    def confirm(self, first: int, end: int) -> None:
        """Hand the answers of some ticks on to those who look at each of them, see `go_on_confirming`."""
        if self._allocator.confirms:
            self._allocator.confirm(self._given.notes.answers[first:end], self._given.notes.demands[first:end])

    def go_on_confirming(self) -> None:
        """Let them look at what waits, while compiled code flies."""
        self._allocator.go_on_confirming()

    def part(self, first: int, end: int, reached: int = BEGIN) -> FlownTicks:
        """The ticks from the one to the other, counted from the first of all.

        Args:
            first: of them.
            end: the one behind them.
            reached: how far that one has come.
        """
        rows, notes, sensing = self._given.rows, self._given.notes, self._given.sensing
        estimated = slice(first, end + 1)
        return FlownTicks(
            end - first,
            reached,
            rows.part(first, end),
            notes.pace[first:end],
            float(notes.force_ratio[first - 1]) if first else self._ratio_before,
            notes.force_ratio[first:end],
            notes.limits[first:end],
            sensing._replace(
                answers=sensing.answers[estimated],
                errors=sensing.errors[estimated],
                inertial=sensing.inertial[estimated],
                arrived=sensing.arrived[estimated],
                counts=sensing.counts[estimated],
            ),
        )

    @property
    def condition(self) -> int:
        """Number of the condition that has stopped the flight, where one has."""
        return int(self._given.notes.told[MET])

    @property
    def last_words(self) -> str:
        """Of MuJoCo, where it cannot go on."""
        return bytes(self._given.engine.text).partition(b"\0")[0].decode(errors="replace")

    @property
    def applied(self) -> Vector:
        """(6,) wrench allocated over the last one [N, N m]."""
        return self._given.answering.applied

    @property
    def wanted(self) -> Vector:
        """(4,) the attitude wanted at the last one; zero where none was flown."""
        return self._given.answering.quaternion

    @property
    def known(self) -> State:
        """The state that the controller saw at the last one."""
        state = self._given.answering.state
        return State(state[:3], state[3:7], state[7:16].reshape(3, 3), state[16:19], state[19:])
