"""A vehicle in its water, stepped one control period at a time, saved and resumed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from hashlib import sha256
from pickle import PicklingError
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import FlightError
from cube_sim.flight.action import action_of
from cube_sim.flight.loop import Loop
from cube_sim.flight.observation import Observation
from cube_sim.flight.snapshot import Snapshot
from cube_sim.flight.start import described, foreseen_attitude, placed, prepared
from cube_sim.mission.copying import integration_state, packed, set_integration_state, unpacked
from cube_sim.mission.own.given import AnyScenario, loaded_with
from cube_sim.mission.own.handed import handed
from cube_sim.native.forked import flying
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_log import LogLine
from cube_sim.spatial import State
from cube_sim.vehicle.plugin.warnings import collect_warnings
from cube_sim.vehicle.state import read_state

_CHANGING = "controller", "supply", "events", "fault_finding", "drop_weight", "estimation"
"""What of a mission changes in a flight, beside MuJoCo's data, its model's numbers and the allocation."""


class Flight(Loop):
    """A vehicle in its water, stepped one control period at a time.

    A run of the same scenario is the same flight: `run` drives one with files to record it. Here rows are kept in
    memory.

    Attributes:
        mission: the objects of the loop.
        time_s: simulated time [s].
        ended: why the flight has ended early; "" while it has not.
    """

    def __init__(
        self,
        scenario: AnyScenario,
        overrides: Mapping[str, Any] | None = None,
        *,
        controller: Any = None,
        allocator: Any = None,
        path: Any = None,
    ) -> None:
        """Prepare a flight and stand at its beginning.

        Args:
            scenario: a file, what would stand in one (file names in it are seen from the working directory), or a
                loaded one.
            overrides: dotted path -> value in place of the scenario's.
            controller: a function or class of your own in place of `control.law`, as docs/extending.md has it.
            allocator: likewise in place of `allocation.method`.
            path: likewise in place of `path`, or a path itself.

        Raises:
            ScenarioError: the scenario cannot be flown; one line per mistake.
        """
        loaded = loaded_with(scenario, overrides, controller, allocator, path)
        mission = prepared(loaded)
        self._loaded = loaded
        super().__init__(mission, SignalStore(mission.channels))
        try:
            self._start: Snapshot | None = self.snapshot()
        except FlightError:
            self._start = None

    @cached_property
    def _digest(self) -> str:
        """Of the scenario, and of the code it names."""
        sources = [code.source for code in self.mission.codes.values()]
        return sha256("\0".join([self._loaded.resolved_yaml(), *sources]).encode()).hexdigest()

    @property
    def signals(self) -> Mapping[str, NDArray[np.float64]]:
        """Everything recorded since the start: "channel.field" -> (n, 1 + width), column 0 the time [s]."""
        return self._store.signals

    @property
    def log(self) -> tuple[LogLine, ...]:
        """Everything said since the start, in the order of time."""
        return self._store.lines

    def reset(self, seed: int | None = None, state: State | None = None) -> Observation:
        """Back to the beginning.

        Args:
            seed: root of every random stream in place of the scenario's; None for that one.
            state: of the vehicle in place of the scenario's initial one; its `rotation` is not looked at.

        Raises:
            FlightError: the state is not finite, or its quaternion has no direction.
        """
        self._store.clear()
        if self._start is not None:
            self.restore(self._start)
        else:
            self._stand(prepared(self._loaded), self._store)
        if seed is not None:
            mission = self.mission
            for part in (mission.estimation, mission.fault_finding):
                if part is not None:
                    part.reseed(seed)
        if state is not None:
            placed(self.mission, state)
        described(self.mission, self._store)
        return self.observation()

    def step(
        self,
        *,
        wrench: ArrayLike | None = None,
        forces: ArrayLike | None = None,
        commands: ArrayLike | None = None,
    ) -> Observation:
        """Fly one control period.

        Without an argument the loop flies as `run` does. The controller is asked in any case: its target goes on, and
        its estimators hear what was commanded.

        Args:
            wrench: (6,) [N, N m], body axes, in place of the controller's.
            forces: (m,) [N] in place of the allocation's, too.
            commands: (m,) normalised commands in place of those.

        Raises:
            FlightError: the flight is over, or an argument makes no sense.
        """
        self._require_going_on()
        action = action_of(len(self.mission.vehicle.thrusters.names), wrench, forces, commands)
        with flying(), collect_warnings() as warnings:
            self.control(warnings, action)
            self.advance()
        return self.observation()

    def observation(self) -> Observation:
        """The flight as it stands."""
        mission, data = self.mission, self.mission.data
        mujoco.mj_kinematics(mission.model, data)
        state = read_state(mission.vehicle, data)
        return Observation(
            time_s=self.time_s,
            state=state,
            estimate=state if self._known is None or mission.estimation is None else handed(self._known),
            view=mission.controller.view(state),
            wanted=foreseen_attitude(mission, state) if self._wanted is None else self._wanted.copy(),
            force=data.actuator_force[mission.vehicle.thrusters.actuators].copy(),
            wrench=self._applied.copy(),
            given_up=self._given_up,
            ended=self.ended,
            over=self.over,
        )

    def fly(self, ticks: int) -> Observation:
        """Fly so many control periods as `run` does, compiled where they can be: the fast way to where one looks next.

        Args:
            ticks: how many; fewer are flown where the flight is over before.

        Raises:
            FlightError: the flight is over, or there is not one tick to fly.
        """
        self.go_on(ticks)
        return self.observation()

    def snapshot(self) -> Snapshot:
        """The whole flight as it stands, but for the rows that are recorded.

        Raises:
            FlightError: code of the user's own remembers what cannot be pickled.
        """
        mission = self.mission
        try:
            changing = (
                (self.tick, self.ended, self._applied, self._given_up, self._known, self._wanted),
                self._watches,
                mission.allocator.memory(),
                integration_state(mission.model, mission.data),
                (mission.model.numeric_data.copy(), mission.model.opt.wind.copy()),
                {name: getattr(mission, name) for name in _CHANGING},
            )
            return Snapshot(self._digest, packed(changing, self._fixed))
        except (PicklingError, TypeError, AttributeError) as error:
            raise FlightError(f"the flight cannot be saved: {error}") from error

    def restore(self, snapshot: Snapshot) -> Observation:
        """Go on from a snapshot, of this flight or another of the same scenario.

        Recorded rows stay, unless time goes back: then they are forgotten, and recording starts again.

        Raises:
            FlightError: the snapshot is that of another scenario.
        """
        if snapshot.digest != self._digest:
            raise FlightError("the snapshot belongs to another scenario")
        loop, watches, allocation, physics, numbers, parts = unpacked(snapshot.content, self._fixed)
        self._python_until = loop[0]
        if loop[0] < self.tick:
            self._store.clear()  # rows are recorded in the order of time
        self.tick, self.ended, self._applied, self._given_up, self._known, self._wanted = loop
        self._watches = watches
        mission = self.mission
        mission.model.numeric_data[:], mission.model.opt.wind[:] = numbers
        set_integration_state(mission.model, mission.data, physics)
        # What follows from the state: the forces of the thrusters, for one.
        mujoco.mj_forward(mission.model, mission.data)
        set_integration_state(mission.model, mission.data, physics)
        mission.allocator.recall(allocation)
        self.mission = replace(mission, **parts)
        return self.observation()

    @property
    def _fixed(self) -> dict[str, Any]:
        """What parts of the mission refer to and never changes."""
        return self.mission.fixed | {"store": self._store, "allocator": self.mission.allocator}
