"""What a run flies, of one vehicle or of several: its loop, its judge, its record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.checks import evaluate
from cube_sim.flight import FleetLoop, Loop, prepared, prepared_fleet
from cube_sim.judged_fleet import JudgedFleet, evaluate_fleet
from cube_sim.judged_store import JudgedRows, beforehand_of
from cube_sim.mission import Mission
from cube_sim.mission.fleet import FleetMission
from cube_sim.mission.own.code import Codes
from cube_sim.mission.run_header import fleet_header, header
from cube_sim.recording.among import VehicleAmong
from cube_sim.recording.channels import Channel, units_of
from cube_sim.recording.header import RunHeader
from cube_sim.recording.signal_store import SignalStore
from cube_sim.scenario import Loaded, Scenario
from cube_sim.scenario.fleet import FleetScenario
from cube_sim.scenario.fleet_loading import AnyLoaded, LoadedFleet
from cube_sim.verdict import CheckResult

AnyLoop = Loop | FleetLoop
AnyJudge = JudgedRows | JudgedFleet
Signals = Mapping[str, NDArray[np.float64]]


class Undertaking(Protocol):
    """A prepared mission, and what a run needs of it."""

    @property
    def scenario(self) -> Scenario | FleetScenario:
        """What is asked for."""
        ...

    @property
    def channels(self) -> tuple[Channel, ...]:
        """What will be recorded."""
        ...

    @property
    def model(self) -> mujoco.MjModel:
        """That flies."""
        ...

    @property
    def body(self) -> str | None:
        """The hull in it that is drawn; None of several."""
        ...

    @property
    def among(self) -> Sequence[VehicleAmong]:
        """Of several vehicles, each; none of one."""
        ...

    @property
    def codes(self) -> Codes:
        """Code of the user's own in it."""
        ...

    def header(self) -> RunHeader:
        """The inputs of the run."""
        ...

    def loop(self, store: SignalStore) -> AnyLoop:
        """What flies it, from its beginning."""
        ...

    def judge(self) -> AnyJudge:
        """What judges its rows as they come."""
        ...

    def evaluate(self, signals: Signals, duration_s: float) -> tuple[CheckResult, ...]:
        """What its checks say of all that was recorded of a flight that had to last so long [s]."""
        ...


def undertaking(loaded: AnyLoaded) -> Undertaking:
    """Prepare what a scenario asks for.

    Raises:
        ScenarioError: the model does not fit the scenario; with position.
        FlightError: this process was forked off while threads of its parent flew.
    """
    return _OfSeveral(loaded) if isinstance(loaded, LoadedFleet) else _OfOne(loaded)


class _OfOne:
    def __init__(self, loaded: Loaded) -> None:
        self._loaded = loaded
        self._mission: Mission = prepared(loaded)
        self.scenario, self.channels, self.model = self._mission.scenario, self._mission.channels, self._mission.model
        self.body, self.among, self.codes = self._mission.vehicle.name, (), self._mission.codes

    def header(self) -> RunHeader:
        return header(self._loaded, self.codes)

    def loop(self, store: SignalStore) -> Loop:
        return Loop(self._mission, store)

    def judge(self) -> JudgedRows:
        return JudgedRows(self.channels, self.scenario)

    def evaluate(self, signals: Signals, duration_s: float) -> tuple[CheckResult, ...]:
        scenario = self.scenario
        return evaluate(
            scenario.checks,
            signals,
            duration_s=duration_s,
            units=units_of(self.channels),
            beforehand=beforehand_of(scenario, self.channels),
        )


class _OfSeveral:
    def __init__(self, loaded: LoadedFleet) -> None:
        self._loaded = loaded
        self._mission: FleetMission = prepared_fleet(loaded)
        self.scenario, self.channels, self.model = self._mission.scenario, self._mission.channels, self._mission.model
        self.body, self.codes = None, self._mission.codes
        self.among = tuple(
            VehicleAmong(name, hull.model, hull.vehicle.name) for name, hull in self._mission.alone.items()
        )

    def header(self) -> RunHeader:
        return fleet_header(self._loaded, self._mission)

    def loop(self, store: SignalStore) -> FleetLoop:
        return FleetLoop(self._mission, store)

    def judge(self) -> JudgedFleet:
        return JudgedFleet(self.channels, self.scenario)

    def evaluate(self, signals: Signals, duration_s: float) -> tuple[CheckResult, ...]:
        rows = {
            channel.name: np.hstack(
                [
                    signals[f"{channel.name}.{channel.fields[0].name}"],
                    *(signals[f"{channel.name}.{field.name}"][:, 1:] for field in channel.fields[1:]),
                ]
            )
            for channel in self.channels
        }
        return evaluate_fleet(self.channels, self.scenario, rows, duration_s)
