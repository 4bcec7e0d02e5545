"""The loop, and nothing else.

One tick: state (MuJoCo, or an estimate of it) -> path error and desired motion (guidance) -> wrench (control) ->
thruster forces (allocation) -> thruster commands -> one row per channel (recording) -> MuJoCo steps with water.
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import FlightError, OwnCodeError
from cube_sim.flight.action import OWN, Action
from cube_sim.flight.compiled import BEGIN, JUDGED, engine_of, fly_ticks
from cube_sim.flight.rows import rows_for, write_power
from cube_sim.flight.start import described
from cube_sim.flight.taken_over import NOT_BEGUN, Begun, Watches, take_over
from cube_sim.flight.tick import NotANumberError, tick
from cube_sim.mission import Mission
from cube_sim.mission.divergence import divergence
from cube_sim.mission.fault_response import record_actuation, respond_to_faults
from cube_sim.recording.signal_store import SignalStore
from cube_sim.spatial import State, Vector
from cube_sim.uninterrupted import uninterrupted
from cube_sim.vehicle.plugin.warnings import collect_warnings
from cube_sim.verdict import EarlyEnd

PYTHON_TICKS = 10
"""So many ticks are flown in Python before compiled code is tried again."""


class Loop:
    """A prepared mission, flown.

    Args:
        mission: the objects of the loop, at its beginning.
        store: where its rows and sentences go.

    Attributes:
        mission: the same.
        tick: number of the next control period.
        ended: why the flight has ended early; "" while it has not.
    """

    def __init__(self, mission: Mission, store: SignalStore) -> None:
        self._stand(mission, store)
        described(mission, store)

    def _stand(self, mission: Mission, store: SignalStore) -> None:
        """Stand at the beginning."""
        self.mission, self.ended, self.tick = mission, "", 0
        self._store = store
        self._applied: NDArray[np.float64] = np.zeros(6)
        self._given_up = ""
        self._known: State | None = None
        self._wanted: Vector | None = None
        self._watches = Watches.of(mission, store)
        self._period = mission.scenario.control_period_s
        self._rows, self._python_until = rows_for(mission.channels, 1), 0
        self._engine = engine_of(mission)

    @property
    def time_s(self) -> float:
        """Simulated time [s]."""
        return self.tick * self.mission.scenario.control_period_s

    @property
    def over(self) -> bool:
        """Whether nothing can be stepped any more."""
        return bool(self.ended) or self.tick >= self.mission.scenario.ticks

    @property
    def ended_early(self) -> EarlyEnd | None:
        """When and why the flight has ended before its time; None while it has not."""
        return EarlyEnd(self.time_s, self.ended) if self.ended else None

    def go_on(self, ticks: int) -> None:
        """Fly so many control periods, compiled where they can be.

        Args:
            ticks: how many; fewer are flown where the flight is over before.

        Raises:
            FlightError: the flight is over, or there is not one tick to fly, or a part of one.
        """
        if ticks < 1 or ticks % 1 != 0:  # also what is not finite
            raise FlightError(f"fly whole ticks, at least one tick, not {ticks}")
        self._require_going_on()
        end = min(self.tick + ticks, self.mission.scenario.ticks)
        with collect_warnings() as warnings:
            while self.tick < end and not self.ended:
                self._fly_on(warnings, end - self.tick)

    def fly_to_its_end(self, told: Callable[[float], None] | None = None) -> None:
        """Fly as long as the scenario says; the last row is the state at its end.

        Args:
            told: called about once per simulated second with the simulated time [s].

        Raises:
            FlightError: the flight is over.
        """
        self._require_going_on()
        last = -1.0
        with collect_warnings() as warnings:
            while not self.over:
                self._fly_on(warnings, self.mission.scenario.ticks - self.tick)
                if told is not None and self.time_s >= last + 1.0:
                    last = self.time_s
                    told(last)
            if not self.ended and (begun := self._fly_compiled(warnings, 1, moving=False)) is not None:
                self.control(warnings, begun=begun)
        self.finish()

    def _fly_on(self, warnings: list[str], ticks: int) -> None:
        """Fly as many control periods as compiled code takes at once, one at least unless the flight ends.

        Args:
            warnings: where MuJoCo's arrive; they are moved to the log.
            ticks: at most.
        """
        begun = self._fly_compiled(warnings, ticks)
        if begun is not None:
            self.control(warnings, begun=begun)
            self.advance()

    def _fly_compiled(self, warnings: list[str], ticks: int, moving: bool = True) -> Begun | None:
        """Fly what compiled code can; how far the next tick has come, None where it has all been flown.

        Args:
            warnings: of MuJoCo, which Python moves to the log first.
            ticks: at most.
            moving: whether the physics goes on after a tick; if not, there is one tick, and time stands still.
        """
        mission, tick, period = self.mission, self.tick, self._period
        most = self._store.ticks_at_once(tick, period), mission.events.ticks_before(tick, period)
        ticks = min(ticks, mission.scenario.ticks - tick + (not moving), *most)
        if warnings or tick < self._python_until or ticks <= 0 or not self._watches.surface.under_water:
            return NOT_BEGUN
        with uninterrupted():  # the parts of a mission go on together, with their rows
            flying = self._applied, self._watches.surface.boxes, moving
            flown = fly_ticks(mission, self._engine, tick, ticks, *flying)
            if flown is None or flown.ticks == 0:
                self._python_until = tick + PYTHON_TICKS
            if flown is None:
                return NOT_BEGUN
            begun = take_over(flown, tick, mission, self._watches, self._store)
            if flown.ticks:
                self._applied, self._wanted, self._known = flown.applied, flown.wanted, flown.known
                self.tick += flown.ticks if moving else 0
        return begun if flown.reached != BEGIN or flown.ticks == 0 else None

    def _require_going_on(self) -> None:
        if self.over:
            raise FlightError(f"the flight is over{f': {self.ended}' if self.ended else ''}; reset it")

    def control(self, warnings: list[str], action: Action = OWN, begun: Begun = NOT_BEGUN) -> None:
        """All of a tick but the physics; `ended` says whether it went well.

        Args:
            warnings: where MuJoCo's arrive; they are moved to the log.
            action: in place of the loop's own answer.
            begun: how far the tick has come in the compiled loop.
        """
        mission, store, t = self.mission, self._store, self.time_s
        if begun.reached == BEGIN:
            for message in mission.events.apply_due(t):
                store.log(t, "WARNING", message)
            mujoco.mj_forward(mission.model, mission.data)
        while warnings:
            store.log(t, "WARNING", f"MuJoCo: {warnings.pop(0)}")
        self.ended = divergence(mission.model, mission.data) or ""
        if self.ended:
            return
        self._watches.surface.note(t, mission.data)
        judged = begun.reached >= JUDGED
        other_voltage = begun.other_voltage if judged else self._feed_thrusters(t)
        supply = mission.supply
        write_power(self._rows, 0, t, supply.power, supply.energy, supply.voltage, supply.charge)
        try:
            if respond_to_faults(mission, store, t, judged) or other_voltage or self.tick == 0:
                record_actuation(mission, store, t, mission.supply.force_ratio)
            given = t, self._applied, action, begun.known
            decision, allocation, self._known = tick(mission, self._rows, store, *given)
        except (NotANumberError, OwnCodeError) as error:
            store.extend(t, t, [("power", self._rows.power)])
            self.ended = str(error)
            return
        self._applied, self._wanted = allocation.wrench, decision.quaternion
        self._watches.note(t, allocation.status, decision.pace)
        if decision.given_up != self._given_up:
            self._log_given_up(t, decision.given_up)
        mission.drop_weight.lift(mission.data)

    def advance(self) -> None:
        """The physics up to the next tick."""
        if self.ended:
            return
        mujoco.mj_step(self.mission.model, self.mission.data, nstep=self.mission.scenario.steps_per_tick)
        self.tick += 1

    def finish(self) -> None:
        """Say at the end what there is to say of the whole flight, and let no answer go unconfirmed."""
        self.mission.allocator.settle()
        self._watches.surface.finish(self.time_s)
        if self.ended:
            self._store.log(self.time_s, "ERROR", f"{self.ended}: the run ends here")

    def _feed_thrusters(self, t: float) -> bool:
        """Update the supply by what the thrusters draw; returns whether its voltage, and so their limits, changed."""
        supply, before = self.mission.supply, self.mission.supply.force_ratio
        if supply.update(self.mission.data):
            self._store.log(t, "WARNING", "the battery is empty: the thrusters stand still")
        return supply.force_ratio != before

    def _log_given_up(self, t: float, reason: str) -> None:
        """Log that the path is given up, and why, or followed again; drop the ballast where that is asked."""
        self._given_up, mission = reason, self.mission
        self._store.log(t, "WARNING", f"the path is given up: {reason}" if reason else "the path is followed again")
        if reason and mission.scenario.control.safe_mode.action == "surface" and mission.drop_weight.drop():
            self._store.log(t, "WARNING", "the ballast is dropped")
