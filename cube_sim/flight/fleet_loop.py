"""The loop of several vehicles in the same water.

One tick: MuJoCo's data are brought up to date once; then each vehicle in turn sees its state, asks its controller and
allocates; then the physics of all goes on. So no vehicle sees what another does at the same tick.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import mujoco
import numpy as np

from cube_sim.errors import FlightError
from cube_sim.flight.compiled import is_classical
from cube_sim.flight.fleet_store import FleetStore
from cube_sim.flight.loop import each_second
from cube_sim.flight.touching import Touching
from cube_sim.flight.vehicle_loop import VehicleLoop, VehicleStore
from cube_sim.mission.divergence import divergence, why_broken_off
from cube_sim.mission.fleet import FleetMission
from cube_sim.native.forked import flying, require_its_own_threads
from cube_sim.recording.signal_store import SignalStore
from cube_sim.uninterrupted import uninterrupted
from cube_sim.vehicle.plugin.clock import held_still
from cube_sim.vehicle.plugin.engine import step
from cube_sim.vehicle.plugin.guard import TEXT_BYTES
from cube_sim.vehicle.plugin.warnings import collect_warnings
from cube_sim.verdict import EarlyEnd


class FleetLoop:
    """A prepared mission of several vehicles, flown.

    Args:
        mission: the objects of the loop, at its beginning.
        store: where rows and sentences go.

    Attributes:
        mission: the same.
        tick: number of the next control period.
        ended: why the flight has ended early; "" while it has not.
        stopped: when and by which condition of a vehicle it has stopped; None while it has not.
    """

    def __init__(self, mission: FleetMission, store: SignalStore) -> None:
        self.mission, self.tick, self.ended = mission, 0, ""
        self.stopped: EarlyEnd | None = None
        self.raised: Exception | None = None
        self._stores = {name: VehicleStore(one) for name, one in mission.missions.items()}
        self._loops = {name: VehicleLoop(one, self._stores[name]) for name, one in mission.missions.items()}
        self._store = FleetStore(store, self._stores, mission.scenario)
        self._touching = Touching(mission)
        self._vehicles = [one.vehicle for one in mission.missions.values()]
        self._period = mission.scenario.control_period_s
        self._words = np.zeros(TEXT_BYTES, np.uint8)
        model, data, words = mission.model._address, mission.data._address, self._words.ctypes.data
        self._physics = model, data, words, mission.scenario.steps_per_tick, is_classical(mission.model)
        self._step = step.form(*self._physics).call  # what kinds its arguments are is looked at once
        self._store.hand_on()

    @property
    def time_s(self) -> float:
        """Simulated time [s]."""
        return self.tick * self._period

    @property
    def over(self) -> bool:
        """Whether nothing can be flown any more."""
        return bool(self.ended) or self.stopped is not None or self.tick >= self.mission.scenario.ticks

    @property
    def given_up(self) -> str:
        """Which vehicles have given their path up, and why; "" while all follow theirs."""
        return "; ".join(f"{name}: {loop.given_up}" for name, loop in self._loops.items() if loop.given_up)

    @property
    def ended_early(self) -> EarlyEnd | None:
        """When and why the flight has ended before its time; None while it has not."""
        return EarlyEnd(self.time_s, self.ended) if self.ended else self.stopped

    def fly_to_its_end(self, told: Callable[[float], None] | None = None) -> None:
        """Fly as long as the scenario says; the last row is the state at its end.

        Args:
            told: called about once per simulated second with the simulated time [s].

        Raises:
            FlightError: the flight is over.
        """
        require_its_own_threads()
        if self.over:
            raise FlightError(f"the flight is over{f': {self.ended}' if self.ended else ''}")
        tell = each_second(told)
        with flying(), collect_warnings() as warnings, held_still():
            while not self.over:
                left = self.mission.scenario.ticks - self.tick
                self._fly(warnings, min(left, self._store.ticks_at_once(self.tick, self._period)))
                tell(self.time_s)
            if not (self.ended or self.stopped):
                self._fly(warnings, 1, moving=False)
        self.finish()

    def _fly(self, warnings: list[str], ticks: int, moving: bool = True) -> None:
        """Fly some control periods, whose rows are handed on together.

        Args:
            warnings: where MuJoCo's arrive; they are moved to the log.
            ticks: how many; fewer where the flight ends.
            moving: whether the physics goes on after a tick; if not, time stands still.
        """
        with uninterrupted(twice=True):  # all vehicles go on together, with their rows
            end = self.tick + ticks
            while self.tick < end and not (self.ended or self.stopped):
                self._fly_tick(warnings, end - self.tick, moving)
                if not moving:
                    break
            for loop in self._loops.values():
                loop.end_stretch()
            self._store.hand_on()

    def _fly_tick(self, warnings: list[str], most: int, moving: bool) -> None:
        """Fly one control period; `ended` says whether all went well.

        Args:
            warnings: of MuJoCo.
            most: so many ticks may be made ready for at once.
            moving: whether the physics goes on after it.
        """
        mission, t = self.mission, self.time_s
        for level, message in mission.events.apply_due(t):
            self._store.log(t, level, message)
        for loop in self._loops.values():
            loop.apply_events()
        try:
            mujoco.mj_forward(mission.model, mission.data)
            while warnings:
                self._store.log(t, "WARNING", f"MuJoCo: {warnings.pop(0)}")
            self.ended = divergence(mission.model, mission.data, self._vehicles) or ""
            if self.ended:
                return
            for message in self._touching.changes(t, mission.data):
                self._store.log(t, "WARNING", message)
            for name, loop in self._loops.items():
                loop.begin_stretch(most)
                loop.fly_tick()
                if loop.ended:
                    self.ended, self.raised = f"{name}: {loop.ended}", loop.raised
                    return
                if loop.stopped is not None and self.stopped is None:
                    self.stopped = replace(loop.stopped, time_s=t, reason=f"{name}: {loop.stopped.reason}")
            if self.stopped is not None:
                return
            if moving and not self._step(*self._physics):
                self._break_off(bytes(self._words).partition(b"\0")[0].decode(errors="replace"))
        except mujoco.FatalError as error:
            self._break_off(str(error))
        if moving and not self.ended:
            self.tick += 1

    def _break_off(self, said: str) -> None:
        """End the flight early, because MuJoCo has said that it cannot go on."""
        self.ended = why_broken_off(self.mission.model, self.mission.data, said, self._vehicles)

    def finish(self) -> None:
        """Say at the end what there is to say of the whole flight."""
        for loop in self._loops.values():
            loop.ended, loop.stopped = "", None  # it is said once, of all
            loop.tick = self.tick
            loop.finish()
        if self.ended:
            self._store.log(self.time_s, "ERROR", f"{self.ended}: the run ends here")
        elif self.stopped is not None:
            level = "WARNING" if self.stopped.verdict == "PASS" else "ERROR"
            self._store.log(self.time_s, level, f"{self.stopped.reason}: the run ends here")
        self._store.hand_on()
