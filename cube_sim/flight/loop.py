"""The loop, and nothing else.

One tick: state (MuJoCo, or an estimate of it) -> path error and desired motion (guidance) -> wrench (control) ->
thruster forces (allocation) -> thruster commands -> one row per channel (recording) -> MuJoCo steps with water.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import FlightError, OwnCodeError
from cube_sim.flight.action import OWN, Action
from cube_sim.flight.beside import FlyingBeside
from cube_sim.flight.compiled import BEGIN, FAILED, JUDGED, STOPPED, UNANSWERED, Stretch, begin_ticks, engine_of
from cube_sim.flight.rows import rows_for, write_power
from cube_sim.flight.start import described, record_phase, tell_phase
from cube_sim.flight.stop_law import condition_met
from cube_sim.flight.taken_over import NOT_BEGUN, Begun, Watches, take_over
from cube_sim.flight.tick import NotANumberError, tick
from cube_sim.mission import Mission
from cube_sim.mission.divergence import divergence, why_broken_off
from cube_sim.mission.fault_response import record_actuation, respond_to_faults
from cube_sim.mission.fin_finding import columns_of
from cube_sim.mission.fin_response import record_fin_health
from cube_sim.native.forked import flying, require_its_own_threads
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_conditions import BALLAST_DROPPED, BATTERY_EMPTY, PATH_GIVEN_UP
from cube_sim.spatial import State, Vector
from cube_sim.uninterrupted import is_asked_to_end, uninterrupted
from cube_sim.vehicle.plugin.warnings import collect_warnings
from cube_sim.verdict import EarlyEnd

PYTHON_TICKS = 10
"""So many ticks are flown in Python before compiled code is tried again."""
FEW_TICKS, MANY_TICKS = 500, 4000
"""So many ticks compiled code flies at once: few at first, more when nothing comes between. Longer stretches would
take some megabytes more and no less time."""


def _nobody(t: float) -> None:
    """Nobody is told how far a flight has come, t [s]."""


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
        self.raised: Exception | None = None
        self.stopped: EarlyEnd | None = None
        self._store = store
        self._applied: NDArray[np.float64] = np.zeros(6)
        self._given_up = ""
        self._known: State | None = None
        self._wanted: Vector | None = None
        self._watches = Watches.of(mission, store)
        self._period = mission.scenario.control_period_s
        self._rows, self._python_until, self._at_once = rows_for(mission.channels, 1), 0, FEW_TICKS
        self._engine = engine_of(mission)
        self._amid = False

    def __reduce_ex__(self, protocol: Any) -> Any:
        """None: compiled code holds on to what it flies."""
        raise FlightError("a flight stays in its process: pickle its snapshot, for another Flight of the same scenario")

    @property
    def time_s(self) -> float:
        """Simulated time [s]."""
        return self.tick * self.mission.scenario.control_period_s

    @property
    def given_up(self) -> str:
        """Why the path is given up; "" while it is followed."""
        return self._given_up

    @property
    def over(self) -> bool:
        """Whether nothing can be stepped any more."""
        return bool(self.ended) or self.stopped is not None or self.tick >= self.mission.scenario.ticks

    @property
    def ended_early(self) -> EarlyEnd | None:
        """When and why the flight has ended before its time; None while it has not."""
        return EarlyEnd(self.time_s, self.ended) if self.ended else self.stopped

    def go_on(self, ticks: int) -> None:
        """Fly so many control periods, compiled where they can be.

        Args:
            ticks: how many; fewer are flown where the flight is over before.

        Raises:
            FlightError: the flight is over, or there is not one tick to fly, or a part of one.
        """
        number = isinstance(ticks, int | float | np.integer | np.floating)
        if not number or ticks < 1 or ticks % 1 != 0:  # also what is not finite
            raise FlightError(f"fly whole ticks, at least one tick, not {ticks}")
        self._require_going_on()
        end = min(self.tick + ticks, self.mission.scenario.ticks)
        with flying(), collect_warnings() as warnings:
            while self.tick < end and not self.over:
                self._fly_on(warnings, end - self.tick)

    def fly_to_its_end(self, told: Callable[[float], None] | None = None) -> None:
        """Fly as long as the scenario says; the last row is the state at its end.

        Args:
            told: called about once per simulated second with the simulated time [s].

        Raises:
            FlightError: the flight is over.
        """
        self._require_going_on()
        tell, patient = each_second(told), not self.mission.codes  # own code may never come to an end
        with flying(), collect_warnings() as warnings:
            # Amid the first second nobody is told: some of its code may have to be loaded yet, or compiled.
            ticks, amid = self._store.ticks_at_once(self.tick, self._period), _nobody
            while not self.over:
                self._fly_on(warnings, ticks, amid, patient)
                tell(self.time_s)
                ticks, amid = self.mission.scenario.ticks - self.tick, tell
            if not (self.ended or self.stopped):
                with self._whole(patient):
                    begun, _ = self._fly_compiled(warnings, 1, moving=False)
                    if begun is not None:
                        self.control(warnings, begun=begun)
        self.finish()

    def _fly_on(
        self, warnings: list[str], ticks: int, tell: Callable[[float], None] = _nobody, patient: bool = True
    ) -> None:
        """Fly as many control periods as compiled code takes at once, one at least unless the flight ends.

        Args:
            warnings: where MuJoCo's arrive; they are moved to the log.
            ticks: at most.
            tell: called with the simulated time [s] as ticks are flown.
            patient: whether what interrupts waits until they are.
        """
        with self._whole(patient):
            begun, interrupted = self._fly_compiled(warnings, ticks, tell=tell)
            if begun is not None:
                self.control(warnings, begun=begun)
                self.advance()
        if interrupted is not None:
            raise interrupted

    def _fly_compiled(
        self, warnings: list[str], ticks: int, moving: bool = True, tell: Callable[[float], None] = _nobody
    ) -> tuple[Begun | None, BaseException | None]:
        """Fly what compiled code can.

        Args:
            warnings: of MuJoCo, which Python moves to the log first.
            ticks: at most.
            moving: whether the physics goes on after a tick; if not, there is one tick, and time stands still.
            tell: called with the simulated time [s] as ticks are flown.

        Returns:
            How far the next tick has come, None where it has all been flown; and what `tell` raised.
        """
        mission, tick = self.mission, self.tick
        if mission.fin_finding is not None and mission.fin_finding.look(tick):
            return NOT_BEGUN, None
        most = self._at_once, quiet_ticks(mission, tick)
        ticks = min(ticks, mission.scenario.ticks - tick + (not moving), *most)
        if warnings or tick < self._python_until or ticks <= 0 or not self._watches.surface.under_water:
            return NOT_BEGUN, None
        with uninterrupted():  # the parts of a mission go on together, with their rows
            flying = self._applied, self._watches.surface.boxes, moving
            stretch = begin_ticks(mission, self._engine, tick, ticks, *flying)
            if stretch is None:
                self._python_until = tick + PYTHON_TICKS
                return NOT_BEGUN, None
            interrupted: BaseException | None = None
            if self._store.writes and ticks > 1:
                begun, interrupted = self._fly_and_record(stretch, warnings, tell)
            else:
                stretch.go_on_confirming()
                stretch.fly()
                stretch.finish()
                _, begun = self._hand_over(stretch, 0, stretch.ticks, True)
            if stretch.ticks:
                self._applied, self._wanted, self._known = stretch.applied, stretch.wanted, stretch.known
                self.tick += stretch.ticks if moving else 0
                if stretch.reached == STOPPED:  # the physics has not gone on from its last tick
                    self.tick -= moving
                    self._meet(stretch.condition, self.time_s)
                    if moving:
                        self.advance()
            else:
                self._python_until = tick + PYTHON_TICKS
            if stretch.reached == FAILED:
                self._break_off(stretch.last_words)
            longer = self._store.writes and stretch.ticks == ticks
            self._at_once = min(2 * self._at_once, MANY_TICKS) if longer else FEW_TICKS
        if stretch.reached in (FAILED, STOPPED) or (stretch.reached == BEGIN and stretch.ticks):
            return None, interrupted
        return begun, interrupted

    def _fly_and_record(
        self, stretch: Stretch, warnings: list[str], tell: Callable[[float], None]
    ) -> tuple[Begun, BaseException | None]:
        """Let a thread fly, and hand each second over while it flies the next; upon an interrupt it comes to a halt.

        Args:
            stretch: that it flies.
            warnings: where MuJoCo's arrive.
            tell: called with the simulated time [s] of what is in the record.

        Returns:
            How far the next tick has come; and what `tell` raised, upon which the flight has come to a halt.
        """
        done, over, begun, interrupted = 0, False, NOT_BEGUN, None
        with FlyingBeside(stretch) as flying:
            while not over:
                flown, over = flying.look()
                if over:
                    stretch.finish()
                done, begun = self._hand_over(stretch, done, flown, over)
                stretch.go_on_confirming()
                if is_asked_to_end():
                    stretch.stop()
                elif interrupted is None:
                    try:
                        tell((self.tick + done) * self._period)
                    except BaseException as error:
                        interrupted = error
                        stretch.stop()
        warnings += flying.warnings
        return begun, interrupted

    def _hand_over(self, stretch: Stretch, done: int, flown: int, over: bool) -> tuple[int, Begun]:
        """Put ticks of a stretch into the record, as many at a time as it takes.

        Args:
            stretch: the ticks.
            done: how many are in the record already.
            flown: how many there are by now.
            over: whether these are all; the others wait for their second to be whole.

        Returns:
            How many are in the record now, and how far the next one has come.
        """
        while True:
            room = self._store.ticks_at_once(self.tick + done, self._period)
            end, whole = min(done + room, flown), done + room <= flown
            if not (whole or over):
                return done, NOT_BEGUN
            part = stretch.part(done, end, BEGIN if whole else stretch.reached)
            begun = take_over(part, self.tick + done, self.mission, self._watches, self._store)
            stretch.confirm(done, end)
            done = end
            if not whole:
                return done, begun
            self._store.hand_on()

    @contextmanager
    def _whole(self, patient: bool = True) -> Iterator[None]:
        """A piece that is flown whole: where something is raised amid it, the flight cannot go on from there.

        Args:
            patient: whether Ctrl-C waits for its end; a second one does not.
        """
        with uninterrupted(twice=True) if patient else nullcontext():
            self._amid = True
            yield
            self._amid = False

    def _require_whole(self) -> None:
        if self._amid:
            raise FlightError("the flight was interrupted amid a tick; reset it, or restore a snapshot")

    def _require_going_on(self) -> None:
        require_its_own_threads()
        self._require_whole()
        if self.over:
            raise FlightError(f"the flight is over{f': {self.ended}' if self.ended else ''}; reset it")

    def control(self, warnings: list[str], action: Action = OWN, begun: Begun = NOT_BEGUN) -> None:
        """All of a tick but the physics; `ended` says whether it went well.

        Args:
            warnings: where MuJoCo's arrive; they are moved to the log.
            action: in place of the loop's own answer.
            begun: how far the tick has come in the compiled loop.
        """
        with self._broken_off_on_errors():
            self._control(warnings, action, begun)

    def apply_events(self) -> None:
        """What the scenario lets happen at this tick."""
        mission, t = self.mission, self.time_s
        fins = mission.events.fin_health
        for level, message in mission.events.apply_due(t):
            self._store.log(t, level, message)
        if mission.events.fin_health is not fins:
            record_fin_health(mission, self._store, t)

    def _control(self, warnings: list[str], action: Action, begun: Begun) -> None:
        mission, store, t = self.mission, self._store, self.time_s
        if begun.reached == BEGIN:
            self.apply_events()
            mujoco.mj_forward(mission.model, mission.data)
        while warnings:
            store.log(t, "WARNING", f"MuJoCo: {warnings.pop(0)}")
        self.ended = divergence(mission.model, mission.data, [mission.vehicle]) or ""
        if self.ended:
            return
        self._watches.surface.note(t, mission.data)
        judged = begun.reached >= JUDGED
        other_voltage = begun.other_voltage if judged else self._feed_thrusters(t)
        supply = mission.supply
        write_power(self._rows, 0, t, supply.power, supply.energy, supply.voltage, supply.charge)
        try:
            tells_nothing = judged or not self._watches.surface.under_water  # thrusters in the air are not faulty
            if mission.fin_finding is not None:
                mission.fin_finding.look(self.tick)
            news = respond_to_faults(mission, store, t, tells_nothing, self._known) or other_voltage or self.tick == 0
            if news and not mission.inflow.varies:
                record_actuation(mission, store, t, mission.force_ratio)
            if begun.reached == UNANSWERED:
                mission.allocator.ask_again()
            given = t, self._applied, action, begun.known
            decision, allocation, self._known = tick(mission, self._rows, store, *given)
        except (NotANumberError, OwnCodeError) as error:
            store.extend(t, t, [(name, rows) for name, rows in self._rows.named() if name == "power"])
            self.ended, self.raised = str(error), error
            return
        self._applied, self._wanted = allocation.wrench, decision.quaternion
        self._watches.note(t, self._rows, 0, mission.force_ratio, decision.pace)
        if mission.fin_finding is not None:
            mission.fin_finding.note(*columns_of(self._rows.fins[:1], len(mission.fin_finding.found.jammed)))
        if decision.given_up != self._given_up:
            self._log_given_up(t, decision.given_up)
            if decision.given_up:
                self.stopped = mission.stops.given_up(decision.given_up, t)
        met = condition_met(mission.stops.records, self._rows, 0, t)
        if met >= 0 and self.stopped is None:
            self._meet(met, t)
        mission.drop_weight.lift(mission.data)

    def _meet(self, condition: int, t: float) -> None:
        """Stop because a condition is met at t [s], or go on with the next phase, whose beginning it is."""
        mission, controller = self.mission, self.mission.controller
        if not mission.stops.ends_phase(condition):
            self.stopped = mission.stops.end(condition, t)
            return
        if late := mission.phases.late(mission.stops, t):
            mission.phases.run_out += 1
            if mission.phases.flown.block.when_late == "fail":
                record_phase(mission, self._store, t)
                self.stopped = EarlyEnd(t, late, "FAIL")
                return
            self._store.log(t, "WARNING", late)
        if mission.phases.go_on(controller, mission.stops, t):
            tell_phase(mission, self._store, t)
        else:
            if late:
                record_phase(mission, self._store, t)
            self.stopped = mission.stops.after_phases(t)
            if self.stopped is None:
                self._store.log(t, "INFO", "all phases are flown; the last goes on")

    def advance(self) -> None:
        """The physics up to the next tick."""
        if self.ended or self.stopped:
            return
        with self._broken_off_on_errors():
            mujoco.mj_step(self.mission.model, self.mission.data, nstep=self.mission.scenario.steps_per_tick)
        self.tick += 1

    @contextmanager
    def _broken_off_on_errors(self) -> Iterator[None]:
        try:
            yield
        except mujoco.FatalError as error:
            self._break_off(str(error))

    def _break_off(self, said: str) -> None:
        """End the flight early, because MuJoCo has said that it cannot go on."""
        self.ended = why_broken_off(self.mission.model, self.mission.data, said, [self.mission.vehicle])

    def finish(self) -> None:
        """Say at the end what there is to say of the whole flight, and let no answer go unconfirmed."""
        self.mission.allocator.settle()
        self._watches.finish(self.time_s)
        if self.ended:
            self._store.log(self.time_s, "ERROR", f"{self.ended}: the run ends here")
        elif self.stopped is not None:
            level = "WARNING" if self.stopped.verdict == "PASS" else "ERROR"
            self._store.log(self.time_s, level, f"{self.stopped.reason}: the run ends here")

    def _feed_thrusters(self, t: float) -> bool:
        """Update the supply by what the thrusters draw; returns whether its voltage, and so their limits, changed."""
        supply, before = self.mission.supply, self.mission.supply.force_ratio
        if supply.update(self.mission.data):
            self._store.log(t, "WARNING", BATTERY_EMPTY.begins)
        return supply.force_ratio != before

    def _log_given_up(self, t: float, reason: str) -> None:
        """Log that the path is given up, and why, or followed again; drop the ballast where that is asked."""
        self._given_up, mission = reason, self.mission
        self._store.log(t, "WARNING", f"{PATH_GIVEN_UP.begins}{reason}" if reason else PATH_GIVEN_UP.ends)
        if reason and mission.scenario.control.safe_mode.action == "surface" and mission.drop_weight.drop():
            self._store.log(t, "WARNING", BALLAST_DROPPED.begins)


def quiet_ticks(mission: Mission, tick: int) -> int:
    """How many ticks, from this one on, have nothing for Python to do before them: no event, no look at the fins.

    Args:
        mission: that is flown.
        tick: its number.
    """
    quiet = mission.events.ticks_before(tick, mission.scenario.control_period_s)
    return quiet if mission.fin_finding is None else min(quiet, mission.fin_finding.ticks_before_look(tick))


def each_second(told: Callable[[float], None] | None) -> Callable[[float], None]:
    """What can be told the simulated time [s] again and again, and passes it on about once a simulated second."""
    last = -1.0

    def tell(t: float) -> None:
        nonlocal last
        if told is not None and t >= last + 1.0:
            last = t
            told(t)

    return tell
