"""What the compiled loop has flown, taken over into the record and the log of a flight."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import NamedTuple

import numpy as np

from cube_sim.flight.compiled import BEGIN, ESTIMATED, JUDGED, FlownTicks
from cube_sim.flight.off_path_log import OffPathLog
from cube_sim.flight.rows import TickRows
from cube_sim.flight.shortfall import Afloat, Thrust
from cube_sim.flight.unattainable_log import UnattainableLog
from cube_sim.mission import Mission
from cube_sim.mission.fault_response import record_actuation
from cube_sim.mission.fin_finding import columns_of
from cube_sim.mission.navigation import estimated
from cube_sim.mission.pace_log import PaceLog
from cube_sim.mission.surface_watch import SurfaceWatch
from cube_sim.recording.signal_store import SignalStore
from cube_sim.spatial import State, Vector
from cube_sim.vehicle.floating import Buoyancy, water_surface
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.matrix import lever_arm


class Begun(NamedTuple):
    """How far a tick has come in the compiled loop.

    Attributes:
        reached: as `cube_sim.flight.compiled.loop` names it.
        known: the estimated state, once there is one.
        other_voltage: whether the supply's voltage has changed, once the thrusters are fed.
    """

    reached: int
    known: State | None = None
    other_voltage: bool = False


NOT_BEGUN = Begun(BEGIN)


@dataclass
class Watches:
    """Those that say something of a flight now and then.

    Attributes:
        unattainable: of demands that stay out of reach.
        pace: of a path followed more slowly than asked.
        off_path: of a vehicle that stays off its path.
        surface: of a hull out of the water.
    """

    unattainable: UnattainableLog
    pace: PaceLog
    off_path: OffPathLog
    surface: SurfaceWatch

    @staticmethod
    def of(mission: Mission, store: SignalStore) -> Watches:
        """At the beginning of a mission."""
        A, limits = mission.ability.A, mission.ability.limits
        thrust = Thrust(mission.vehicle.thrusters.names, A, limits, lever_arm(A, SPATIAL))
        fins, at_speed = mission.vehicle.fins, mission.ability.fins
        if fins is not None and at_speed is not None:
            thrust = thrust._replace(fins=fins.names, per_newton=at_speed.matrix, travel=fins.travel)
        if (surface := water_surface(mission.model)) < inf:
            thrust = thrust._replace(afloat=Afloat(Buoyancy.of(mission.model, mission.vehicle), surface))
        return Watches(
            UnattainableLog(store, thrust),
            PaceLog(store, mission.scenario.guidance.speed_m_s),
            OffPathLog(store),
            SurfaceWatch(store, mission.model, mission.vehicle),
        )

    def note(self, t: float, rows: TickRows, k: int, force_ratio: float, pace: float) -> None:
        """Take in one tick.

        Args:
            t: its time [s].
            rows: of the flight.
            k: which of them.
            force_ratio: share of their force that the supply leaves the thrusters.
            pace: share of the speed along the path.
        """
        self._note_others(t, rows, k, force_ratio, pace)
        self.off_path.note(t, rows, k)

    def _note_others(self, t: float, rows: TickRows, k: int, force_ratio: float, pace: float) -> None:
        self.unattainable.note(t, rows, k, force_ratio)
        self.pace.note(t, pace)

    def quiet(self, rows: TickRows, pace: Vector) -> bool:
        """Whether the ticks of these rows, at these shares (n,) of the speed, are no news."""
        return self.off_path.quiet(rows) and self._others_quiet(rows, pace)

    def _others_quiet(self, rows: TickRows, pace: Vector) -> bool:
        return self.unattainable.quiet(rows) and self.pace.quiet(pace)

    def note_all(self, times: Sequence[float], rows: TickRows, force_ratio: Vector, pace: Vector) -> None:
        """Take in ticks one after the other, many of a kind at once.

        Args:
            times: theirs (n,) [s].
            rows: of the flight, n.
            force_ratio: (n,) of `note`.
            pace: (n,) likewise.
        """
        if not len(times):
            return
        if self._others_quiet(rows, pace):
            self.off_path.note_all(times, rows, 0, len(times))
            self._note_others(times[-1], rows, len(times) - 1, float(force_ratio[-1]), float(pace[-1]))
            return
        k, ends = 0, self.unattainable.ends_of_runs(rows)
        while k < len(times):
            self.note(times[k], rows, k, float(force_ratio[k]), float(pace[k]))
            k, end = k + 1, int(ends[k])
            if end > k and self.pace.quiet(pace[k:end]) and self.unattainable.go_on(times, rows, k, end, force_ratio):
                self.off_path.note_all(times, rows, k, end)
                self.pace.note(times[end - 1], float(pace[end - 1]))
                k = end

    def finish(self, t: float) -> None:
        """Say at the end of the flight, at t [s], what there is to say of the whole."""
        self.unattainable.finish(t)
        self.surface.finish(t)


def take_over(flown: FlownTicks, first: int, mission: Mission, watches: Watches, store: SignalStore) -> Begun:
    """Put the rows of ticks into the record, and what there is to say of them into the log.

    Args:
        flown: the ticks.
        first: number of the first.
        mission: that was flown.
        watches: over it.
        store: record and log.

    Returns:
        How far the next tick has come.
    """
    estimation, sensing, period = mission.estimation, flown.sensing, mission.scenario.control_period_s
    times = [k * period for k in range(first, first + flown.ticks + (flown.reached >= ESTIMATED))]
    rows, paces, last = flown.rows, flown.pace, flown.ticks - 1
    quiet = watches.quiet(rows, paces)
    if estimation is None and not quiet:
        watches.note_all(times[: flown.ticks], rows, flown.force_ratio, paces)
    for k in range(len(times)) if estimation is not None else (last,) * (quiet and flown.ticks > 0):
        if estimation is not None:
            estimation.note(sensing.arrived[k, : sensing.counts[k]], store, times[k])
        if k == last or (k < last and not quiet):
            watches.note(times[k], rows, k, float(flown.force_ratio[k]), float(paces[k]))
    ratio = flown.force_ratio[-1] if flown.ticks else flown.force_ratio_before
    if flown.ticks:
        if len(flown.limits):
            record_actuation(mission, store, np.array(times)[: flown.ticks], flown.force_ratio, flown.limits)
        elif first == 0 or (flown.force_ratio != flown.force_ratio_before).any():
            changed = np.diff(flown.force_ratio, prepend=flown.force_ratio_before) != 0.0
            changed[0] |= first == 0
            told = np.flatnonzero(changed)
            record_actuation(mission, store, np.array(times)[told], flown.force_ratio[told])
        watches.surface.note_under_water(times[last])
        if mission.fin_finding is not None:
            k = len(mission.fin_finding.found.jammed)
            mission.fin_finding.note(*columns_of(rows.fins[: flown.ticks], k))
        store.extend(times[0], times[last], rows.named(), ours=True)
    known, n = None, len(times)
    if estimation is not None and n:
        estimation.record(store, np.array(times), sensing.answers[:n], sensing.errors[:n], sensing.inertial[:n])
        known = estimated(sensing.answers[n - 1]) if n > flown.ticks else None
    return Begun(flown.reached, known, flown.reached >= JUDGED and mission.force_ratio != ratio)
