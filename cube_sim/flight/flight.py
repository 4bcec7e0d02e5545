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
from cube_sim.flight.start import checked_seed, described, foreseen_attitude, placed, pose_numbers, prepared
from cube_sim.flight.taken_over import Watches
from cube_sim.mission.copying import integration_state, packed, set_integration_state, unpacked
from cube_sim.mission.input_files import input_files
from cube_sim.mission.own.given import AnyScenario, loaded_with
from cube_sim.mission.own.handed import handed
from cube_sim.mission.own.packages import MODULES
from cube_sim.native.forked import flying
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_log import LogLine
from cube_sim.spatial import State
from cube_sim.vehicle.plugin.warnings import collect_warnings
from cube_sim.vehicle.state import read_state

_CHANGING = (
    "controller",
    "supply",
    "events",
    "fault_finding",
    "fin_finding",
    "drop_weight",
    "estimation",
    "stops",
    "phases",
    "inflow",
)
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
            # Files are looked at before somebody changes them.
            self._start: bytes | None = self._content() if self._file_digests else None
        except FlightError:
            self._start = None

    @cached_property
    def _digests(self) -> dict[str, str]:
        """Of all that flights must share to take up each other's snapshots, by name.

        Raises:
            FlightError: a file that the scenario names is gone.
        """
        # The scenario's own words for a path do not say all of one that a program hands over.
        others = {"scenario": self._loaded.resolved_yaml().encode(), "path": self.mission.outline.tobytes()}
        return self._file_digests | {name: sha256(content).hexdigest() for name, content in others.items()}

    @cached_property
    def _file_digests(self) -> dict[str, str]:
        """Of every file that flies, by name; the model is always one.

        Raises:
            FlightError: a file that the scenario names is gone.
        """
        mission = self.mission
        try:
            files = input_files(mission.scenario).contents
        except OSError as error:
            raise FlightError(f"the flight cannot be saved: {error}") from error
        for key, code in mission.codes.items():
            files |= {f"python/{key}": code.source.encode()}
            files |= {f"python/{key}/{name}": content for name, content in code.neighbours.items()}
            files |= {f"{MODULES}/{name}": content for name, content in code.modules.items()}
        return {name: sha256(content).hexdigest() for name, content in files.items()}

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
            FlightError: the seed is no whole number from 0 to 2^63 - 1; the state is none, is not finite, or its
                quaternion has no direction. The flight stays as it is.
        """
        root = None if seed is None else checked_seed(seed)
        pose = None if state is None else pose_numbers(state)
        # What takes long, and leaves the flight as it is.
        mission = prepared(self._loaded) if self._start is None else None
        with self._whole():
            self._store.clear()
            if self._start is not None:
                self._go_on_from(*unpacked(self._start, self._fixed), forget=True)
            elif mission is not None:
                self._stand(mission, self._store)
                self._amid = True
            if root is not None:
                for part in (self.mission.estimation, self.mission.fault_finding):
                    if part is not None:
                        part.reseed(root)
            if pose is not None:
                placed(self.mission, pose)
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
        with flying(), collect_warnings() as warnings, self._whole():
            self.control(warnings, action)
            self.advance()
        return self.observation()

    def observation(self) -> Observation:
        """The flight as it stands.

        Raises:
            FlightError: it is amid a tick.
        """
        self._require_whole()
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
            ended=self.ended or (self.stopped.reason if self.stopped is not None else ""),
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
            FlightError: code of the user's own remembers what cannot be pickled, or the flight is amid a tick.
        """
        content = self._content()
        return Snapshot(self._digests, content)

    def _content(self) -> bytes:
        """What changes in a flight."""
        self._require_whole()
        mission = self.mission
        try:
            changing = (
                (self.tick, self.ended, self.stopped, self._applied, self._given_up, self._known, self._wanted),
                self._watches,
                mission.allocator.memory(),
                integration_state(mission.model, mission.data),
                (mission.model.numeric_data.copy(), mission.model.opt.wind.copy()),
                {name: getattr(mission, name) for name in _CHANGING},
            )
            return packed(changing, self._fixed)
        except (PicklingError, TypeError, AttributeError) as error:
            raise FlightError(f"the flight cannot be saved: {error}") from error

    def restore(self, snapshot: Snapshot) -> Observation:
        """Go on from a snapshot, of this flight or another of the same scenario.

        Recorded rows stay, unless time goes back, or the flight was interrupted amid a tick: then they are forgotten,
        and recording starts again.

        Raises:
            FlightError: this is no snapshot, or that of another scenario, of one with other files or another path.
        """
        if not isinstance(snapshot, Snapshot):
            raise FlightError(f"restore takes a Snapshot, as `snapshot` gives it, not a {type(snapshot).__name__}")
        if other := [name for name in self._digests if snapshot.digests.get(name) != self._digests[name]]:
            raise FlightError(f"the snapshot belongs to another scenario: not the same {', '.join(other)}")
        whole = unpacked(snapshot.content, self._fixed)
        with self._whole():
            self._go_on_from(*whole, forget=self._amid or whole[0][0] < self.tick)
        return self.observation()

    def _go_on_from(
        self, loop: Any, watches: Watches, allocation: Any, physics: Any, numbers: Any, parts: Any, forget: bool
    ) -> None:
        """Stand where a snapshot was taken, which holds these; forget the rows recorded so far, or do not."""
        self._python_until = loop[0]
        if forget:
            self._store.clear()  # rows are recorded in the order of time
        self.tick, self.ended, self.stopped, self._applied, self._given_up, self._known, self._wanted = loop
        self._watches = watches
        mission = self.mission
        mission.model.numeric_data[:], mission.model.opt.wind[:] = numbers
        set_integration_state(mission.model, mission.data, physics)
        # What follows from the state: the forces of the thrusters, for one.
        mujoco.mj_forward(mission.model, mission.data)
        set_integration_state(mission.model, mission.data, physics)
        mission.allocator.recall(allocation)
        self.mission = replace(mission, **parts)

    def __deepcopy__(self, memo: dict[int, Any]) -> Flight:
        """Another flight that stands where this one does, its recorded rows among it.

        Raises:
            FlightError: code of the user's own remembers what cannot be copied, or the flight is amid a tick.
        """
        snapshot = self.snapshot()
        other = Flight(self._loaded)
        other.restore(snapshot)
        other._store.take_up(self._store)
        return other

    def __copy__(self) -> Flight:
        """As a deep one: two flights share nothing that changes."""
        return self.__deepcopy__({})

    @property
    def _fixed(self) -> dict[str, Any]:
        """What parts of the mission refer to and never changes."""
        return self.mission.fixed | {"store": self._store, "allocator": self.mission.allocator}
