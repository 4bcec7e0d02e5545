"""One vehicle's part of a flight of several in the same water: all of a tick but the physics."""

from __future__ import annotations

from cube_sim.flight.action import OWN
from cube_sim.flight.compiled import BEGIN, FAILED, FORWARDED, STOPPED, TICKED, Stretch, begin_ticks
from cube_sim.flight.loop import FEW_TICKS, PYTHON_TICKS, Loop, quiet_ticks
from cube_sim.flight.taken_over import Begun, take_over
from cube_sim.mission import Mission
from cube_sim.recording.batch import Batch
from cube_sim.recording.signal_store import SignalStore


class VehicleStore(SignalStore):
    """Rows and sentences of one vehicle on their way to the record of all."""

    def __init__(self, mission: Mission) -> None:
        self._batches: list[Batch] = []
        super().__init__(mission.channels)

    def take(self) -> list[Batch]:
        """What has come since the last time, in the order of time."""
        self._flush()
        taken, self._batches = self._batches, []
        return taken

    def _keep(self, batch: Batch) -> None:
        self._batches.append(batch)


class VehicleLoop(Loop):
    """Flies one vehicle among others, by compiled code as long as it has nothing for Python to do.

    Whoever flies all of them brings MuJoCo's data up to date before each tick, and steps them after it.

    Args:
        mission: of the vehicle, at its beginning.
        store: where its rows and sentences go.
    """

    def __init__(self, mission: Mission, store: VehicleStore) -> None:
        super().__init__(mission, store)
        self._engine = self._engine._replace(shared=True)
        self._stretch: Stretch | None = None
        self._begun_at = 0

    def begin_stretch(self, most: int) -> bool:
        """Whether compiled code can fly the next tick, and up to so many."""
        finding = self.mission.fin_finding
        if self._stretch is None and finding is not None and finding.look(self.tick):
            return False
        if self._stretch is None and not self.ended and self.tick >= self._python_until:
            count = min(most, FEW_TICKS, quiet_ticks(self.mission, self.tick))
            if count > 0 and self._watches.surface.under_water:
                flying = self._applied, self._watches.surface.boxes
                self._stretch = begin_ticks(self.mission, self._engine, self.tick, count, *flying)
                self._begun_at = self.tick
                if self._stretch is None:
                    self._python_until = self.tick + PYTHON_TICKS
                else:
                    self._stretch.go_on_confirming()
        return self._stretch is not None

    def fly_tick(self) -> None:
        """All of a tick but the physics; `ended` says whether it went well.

        MuJoCo's data are up to date; `begin_stretch` has been asked.
        """
        stretch, begun = self._stretch, Begun(FORWARDED)
        if stretch is not None:
            reached = stretch.fly_tick()
            if reached == TICKED:
                self.tick += 1
                if not stretch.room:
                    self.end_stretch()
                return
            flown = stretch.ticks > self.tick - self._begun_at
            begun = self.end_stretch()
            if reached == FAILED:
                self._break_off(stretch.last_words)
                return
            if reached == STOPPED:
                self._meet(stretch.condition, self.time_s)
                if not self.stopped:
                    self.tick += 1
                return
            if flown:
                self.tick += 1
                return
            self._python_until = self.tick + PYTHON_TICKS
        self.control([], OWN, begun)
        if not (self.ended or self.stopped):
            self.tick += 1

    def end_stretch(self) -> Begun:
        """Take over what compiled code has flown; says how far the next tick has come."""
        stretch, self._stretch = self._stretch, None
        if stretch is None:
            return Begun(BEGIN)
        if stretch.reached == TICKED:
            stretch.reached = BEGIN
        stretch.finish()
        begun = take_over(
            stretch.part(0, stretch.ticks, stretch.reached), self._begun_at, self.mission, self._watches, self._store
        )
        stretch.confirm(0, stretch.ticks)
        if stretch.ticks:
            self._applied, self._wanted, self._known = stretch.applied, stretch.wanted, stretch.known
        return begun
