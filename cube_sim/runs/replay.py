"""A run flown again from its record alone, and held against it bit by bit."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from itertools import zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from cube_sim.errors import RecordingError, ScenarioError
from cube_sim.mission.own.given import NOT_AGAIN
from cube_sim.mission.own.packages import import_from
from cube_sim.recording.batch import Rows
from cube_sim.recording.header import COMMIT, SOURCE, RunHeader
from cube_sim.recording.mcap.names import MODEL
from cube_sim.recording.saved_inputs import save_inputs
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_log import LogLine
from cube_sim.runs.comparison import SignalDifference, differences
from cube_sim.runs.recorded_run import RecordedRun
from cube_sim.scenario.fleet_loading import load_any
from cube_sim.simulation import Progress
from cube_sim.undertaking import undertaking


@dataclass(frozen=True)
class Replayed:
    """What became of a replay.

    Attributes:
        differences: signals that are not the same to the bit, the one that differs first in time before all others.
        other_versions: of packages that take part, a line each.
        other_log: the first line of the log that is not the same, as recorded and as now; None where all are.
        until_s: how far the record goes [s]; nothing after it is compared.
        signals: how many were compared.
    """

    differences: tuple[SignalDifference, ...]
    other_versions: tuple[str, ...]
    other_log: tuple[str, str] | None
    until_s: float
    signals: int

    @property
    def identical(self) -> bool:
        """Whether every signal and every line of the log is the same."""
        return not self.differences and self.other_log is None


def replay(run: RecordedRun, progress: Progress | None = None) -> Replayed:
    """Fly a recorded run again.

    Args:
        run: one whose record may end early, or lack some of its middle: what there is of it is compared.
        progress: called about once per simulated second with (simulated time, whole time) [s].

    Raises:
        RecordingError: the record does not hold what flies.
        ScenarioError: this version of cube_sim cannot fly it.
    """
    if run.header.model == MODEL:
        lacks = "it lacks files that its scenario names; it can be read, not flown"
        raise RecordingError(f"{run.path}: is a record of format 1: {lacks}")
    if said := [line.text for line in run.log if f" {NOT_AGAIN}: " in line.text]:
        raise RecordingError(f"{run.path}: {said[0]}")
    with TemporaryDirectory() as folder, ExitStack() as after:
        after.callback(import_from, None)
        place = save_inputs(run.header, Path(folder))
        try:
            loaded = replace(load_any(place), text=run.header.scenario)
            mission = undertaking(loaded)
        except ScenarioError as error:
            lines = [line.replace(f"{folder}/", f"{run.path}: ") for line in str(error).splitlines()]
            raise ScenarioError(lines) from None
        store = SignalStore(mission.channels)
        flight = mission.loop(store)
        whole_s = loaded.scenario.duration_s
        flight.fly_to_its_end(None if progress is None else lambda t: progress(t, whole_s))
        inputs = mission.header()
    whole = run.complete
    until_s = max(run.recorded_s, flight.time_s) if whole else run.recorded_s
    again = {name: rows[rows[:, 0] <= until_s] for name, rows in store.signals.items()}
    if not whole:
        again = {name: _of_the_times(rows, run.signals.get(name)) for name, rows in again.items()}
    found = sorted(differences(run.signals, again), key=lambda each: -1.0 if each.first_s is None else each.first_s)
    holes = () if whole or run.end is None else run.end.missing_s
    logs = ([line for line in lines if whole or _is_recorded(line, until_s, holes)] for lines in (run.log, store.lines))
    other_log = _first_other(*logs)
    versions = _other_versions(run.header, inputs)
    return Replayed(tuple(found), versions, other_log, until_s, len(again))


def _is_recorded(line: LogLine, until_s: float, holes: Sequence[tuple[float, float]]) -> bool:
    return line.t <= until_s and not any(start <= line.t < end for start, end in holes)


def _of_the_times(rows: Rows, recorded: Rows | None) -> Rows:
    """The rows at the times of recorded ones."""
    return rows if recorded is None else rows[np.isin(rows[:, 0], recorded[:, 0])]


def _other_versions(recorded: RunHeader, ours: RunHeader) -> tuple[str, ...]:
    then, now = recorded.versions, ours.versions
    names = [name for name in sorted({*then, *now} - {SOURCE, COMMIT}) if then.get(name) != now.get(name)]
    lines = [f"{name} {then.get(name, 'none')}, now {now.get(name, 'none')}" for name in names]
    if then.get(SOURCE) != now.get(SOURCE):  # another commit of the same code is no difference
        lines.insert(0, f"the code of cube_sim is not the same: {recorded.build}, now {ours.build}")
    return tuple(lines)


def _first_other(then: Sequence[LogLine], now: Sequence[LogLine]) -> tuple[str, str] | None:
    for before, after in zip_longest(then, now):
        if _recorded(before) != _recorded(after):
            return _shown(before), _shown(after)
    return None


def _recorded(line: LogLine | None) -> tuple[int, str, str] | None:
    """A line as a record has it, its time in whole nanoseconds."""
    return None if line is None else (round(line.t * 1e9), line.level, line.text)


def _shown(line: LogLine | None) -> str:
    return "nothing" if line is None else f"{line.t:g} s  {line.level}  {line.text}"
