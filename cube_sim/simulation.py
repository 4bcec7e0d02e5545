"""A scenario flown to its end, recorded and judged."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, ExitStack, nullcontext, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import RecordingError, RunInterrupted, told
from cube_sim.judged_store import JudgedStore
from cube_sim.mission.own.given import AnyScenario, any_loaded_with
from cube_sim.mission.run_header import versions
from cube_sim.recording.recorder import Recorder
from cube_sim.recording.run_end import How, RunEnd
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_directory import (
    MCAP_FILE,
    RESOLVED_FILE,
    Claim,
    claim,
    require_writable,
    reserve_verdict,
    write_verdict,
)
from cube_sim.run_log import LogLine
from cube_sim.scenario.fleet_loading import AnyLoaded, LoadedFleet
from cube_sim.undertaking import AnyJudge, AnyLoop, Undertaking, undertaking
from cube_sim.uninterrupted import name_of, signal_of, stoppable, uninterrupted
from cube_sim.verdict import CheckResult, EarlyEnd, Flown, Verdict, overall, to_json
from cube_sim.whole_file import written_whole

Progress = Callable[[float, float], None]
Kept = Literal["full", "mcap", "none"]
"""What a run leaves beside its verdict: the record and its view, the record alone, nothing."""


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """What a run leaves in memory; the same stands in its directory. It equals itself alone.

    Attributes:
        verdict: PASS, FAIL or ERROR (could not be judged).
        checks: one result per check of the scenario.
        signals: "channel.field" -> (n, 1 + width), column 0 the time [s]; none where they were not to be kept.
        directory: where run.mcap, run.rrd, resolved.yaml and verdict.json are.
        real_time_factor: simulated time over the wall-clock time of the loop, its recording included; of a run longer
            than a second without its first second, in which code is loaded, or compiled.
        versions: of the packages that took part.
        simulated_s: simulated time from the start to the end [s].
        ended_early: when and why the run ended before its time; None if it did not.
        log: what was said at the level WARNING or above, in the order of time; all of it is in the recording's log.
    """

    verdict: Verdict
    checks: tuple[CheckResult, ...]
    signals: Mapping[str, NDArray[np.float64]]
    directory: Path
    real_time_factor: float
    versions: Mapping[str, str]
    simulated_s: float
    ended_early: EarlyEnd | None
    log: tuple[LogLine, ...]

    def __repr__(self) -> str:
        """Verdict, time and place, in one line."""
        end = "" if self.ended_early is None else f", ended early: {self.ended_early.reason}"
        return f"<Run {self.verdict}: {self.simulated_s:g} s{end}: {self.directory}>"


def run(
    scenario: str | Path,
    overrides: Mapping[str, Any] | None = None,
    out: str | Path | None = None,
    progress: Progress | None = None,
    record: Kept = "full",
    live: int | None = None,
    keep_signals: bool = True,
) -> Run:
    """Fly a scenario file, record it and judge its checks.

    Args:
        scenario: YAML file.
        overrides: dotted path -> value in place of the file's, e.g. ``{"guidance.speed_m_s": 0.3}``.
        out: directory to write into: new, empty, or an earlier run's, which is replaced. Default: a new one in logs/.
        progress: called about once per simulated second with (simulated time, whole time) [s].
        record: "full" for run.mcap and its view run.rrd, "mcap" without the view, "none" for the verdict alone.
        live: port of this machine at which a viewer shows the run while it flies, 9876 for Rerun's; that it lags, is
            absent or dies changes nothing. It needs a record.
        keep_signals: of a run without a record, whether its signals are kept in memory. Without them a run of any
            length takes the same memory, and the checks are judged as it flies.

    Raises:
        ScenarioError: the scenario cannot be run; one line per mistake, nothing is written.
        DirectoryError: `out` holds something else, cannot be written, or another run is writing there.
        RecordingError: the disk is full, or gone.
        RunInterrupted: Ctrl-C, SIGTERM or SIGHUP; what was flown is recorded, and where nothing was, nothing is.
    """
    return fly(scenario, overrides, out=out, progress=progress, record=record, live=live, keep_signals=keep_signals)


def fly(
    scenario: AnyScenario | LoadedFleet,
    overrides: Mapping[str, Any] | None = None,
    *,
    controller: Any = None,
    allocator: Any = None,
    path: Any = None,
    out: str | Path | None = None,
    progress: Progress | None = None,
    record: Kept = "full",
    live: int | None = None,
    keep_signals: bool = True,
) -> Run:
    """Fly a scenario, with code of one's own in it where that is given; result and errors are those of `run`.

    Args:
        scenario: a file, what would stand in one (file names in it are seen from the working directory), or a loaded
            one.
        overrides: as for `run`.
        controller: a function or class of your own in place of `control.law`, as docs/extending.md has it.
        allocator: likewise in place of `allocation.method`.
        path: likewise in place of `path`, or a path itself.
        out: as for `run`.
        progress: as for `run`.
        record: as for `run`.
        live: as for `run`.
        keep_signals: as for `run`.
    """
    loaded = any_loaded_with(scenario, overrides, controller, allocator, path)
    wanted = None if out is None else Path(out)
    if wanted is not None:
        require_writable(wanted)
    mission = undertaking(loaded)
    with claim(wanted, loaded.scenario.name) as place:
        try:
            return _record_and_judge(loaded, mission, place, progress, record, live, keep_signals)
        except OSError as error:
            raise RecordingError(f"{place.directory}: cannot be written: {told(error)}") from error
        except RunInterrupted:
            raise
        except KeyboardInterrupt as error:
            recorded = record != "none" and place.begun
            number, judged = signal_of(error), place.judged
            raise RunInterrupted(place.directory, recorded=recorded, number=number, judged=judged) from None


def _store(
    place: Claim,
    mission: Undertaking,
    record: Kept,
    live: int | None,
    judge: AnyJudge | None,
    begin: Callable[[], None],
) -> AbstractContextManager[SignalStore]:
    """Where the rows go."""
    if record == "none" and judge is not None:
        return nullcontext(JudgedStore(mission.channels, judge))
    if record == "none":
        return nullcontext(SignalStore(mission.channels))
    shown = mission.channels, mission.model, record == "full", mission.body, live
    return Recorder(place.directory, mission.header(), *shown, begin, judge, mission.among)


def _record_and_judge(
    loaded: AnyLoaded,
    mission: Undertaking,
    place: Claim,
    progress: Progress | None,
    record: Kept,
    live: int | None,
    keep_signals: bool,
) -> Run:
    """Fly and judge, into a folder that is ours."""
    directory = place.directory
    resolved = loaded.resolved_yaml(directory)
    to_be_ended = _ToBeEnded()

    def begin() -> None:
        if not place.begun:
            to_be_ended.begin()
            with written_whole(directory / RESOLVED_FILE) as part:
                part.write_text(resolved, encoding="utf-8")
                reserve_verdict(directory)
                place.begin(but=() if record == "none" else (MCAP_FILE,))

    judge = None if record == "none" and keep_signals else mission.judge()
    with to_be_ended, _store(place, mission, record, live, judge, begin) as recorder, ExitStack() as stack:
        stack.callback(lambda: place.begun or recorder.clear())  # what never began to fly leaves nothing
        flight, clock = mission.loop(recorder), _Clock()
        try:
            number = _fly(flight, _teller(to_be_ended, clock, progress, mission.scenario.duration_s))
            if number and not flight.tick:
                raise RunInterrupted(directory, recorder.warnings, recorded=False, number=number)
            stopped = name_of(number) if number else ""
            if number:
                recorder.hurry()
            factor = clock.factor(flight.time_s)
            with uninterrupted():  # an end that is begun is brought to its end
                recorder.settle()
                begin()
                early = EarlyEnd(flight.time_s, f"interrupted by {stopped}") if stopped else flight.ended_early
                proper = early is None or early.verdict != "ERROR"
                asked_s = mission.scenario.duration_s if early is None or not proper else early.time_s
                results = _results(mission, recorder, judge, asked_s)
                verdict = overall(results, complete=proper, failed=early is not None and early.verdict == "FAIL")
                recorder.finish(_end(flight, stopped, verdict, results))
                flown = Flown(flight.time_s, early, recorder.warnings)
                write_verdict(directory, to_json(verdict, results, factor, versions(), flown))
                place.judged = not stopped
        except Exception as error:
            reason, period_s = told(error), mission.scenario.control_period_s
            ticks = max(flight.tick, round(recorder.last_s / period_s))  # amid a stretch the flight does not count on
            if ticks or place.begun:  # else nothing was flown, and what an earlier run has left stays
                with suppress(OSError, RecordingError):
                    recorder.finish(RunEnd("failed", reason, ticks, ticks * period_s, flight.given_up))
                flown = Flown(ticks * period_s, EarlyEnd(ticks * period_s, reason), recorder.warnings)
                with suppress(OSError):
                    if record == "none":
                        begin()
                    if place.begun:  # there was room for the head of the record
                        write_verdict(directory, to_json("ERROR", (), 0.0, versions(), flown))
            raise
    if stopped:
        raise RunInterrupted(directory, flown.log, record != "none", number)
    return Run(verdict, results, recorder.signals, directory, factor, versions(), flight.time_s, early, flown.log)


def _results(
    mission: Undertaking, recorder: SignalStore, judge: AnyJudge | None, duration_s: float
) -> tuple[CheckResult, ...]:
    """What the checks say of all that has been flown, which they have seen where there is a judge.

    Args:
        mission: that was flown.
        recorder: has the rows.
        judge: has seen them; None for none.
        duration_s: how long the flight had to be [s].
    """
    return mission.evaluate(recorder.signals, duration_s) if judge is None else judge.results(duration_s)


def _fly(flight: AnyLoop, tell: Callable[[float], None]) -> int:
    """Fly to the end; the number of the signal that stopped it before, 0 where none did."""
    try:
        flight.fly_to_its_end(tell)
    except KeyboardInterrupt as interrupt:
        return signal_of(interrupt)
    return 0


class _Clock:
    """How fast a flight is, from when it is first told of its simulated time: what is compiled is compiled by then."""

    def __init__(self) -> None:
        self._marks = [(0.0, time.perf_counter())]

    def told(self, simulated_s: float) -> None:
        """Take note of the first time [s]."""
        if len(self._marks) == 1:
            self._marks.append((simulated_s, time.perf_counter()))

    def factor(self, simulated_s: float) -> float:
        """Simulated over wall-clock time; of a flight that was over when it was first told, from its start."""
        now = time.perf_counter()
        since = [(flown, begun) for flown, begun in self._marks if flown < simulated_s] or self._marks
        flown, begun = since[-1]
        return (simulated_s - flown) / (now - begun)


class _ToBeEnded(ExitStack):
    """While this lasts, and from when it is begun, a signal stops the flight and leads to its ordinary end."""

    _begun = False

    def begin(self) -> None:
        """There is something to bring to an end, or will be at once; more than once is as good."""
        if not self._begun:
            self._begun = True
            self.enter_context(stoppable())


def _teller(
    to_be_ended: _ToBeEnded, clock: _Clock, progress: Progress | None, whole_s: float
) -> Callable[[float], None]:
    """What is told the simulated time about once a second; from the first on there is something to bring to an end.

    Args:
        to_be_ended: begun then.
        clock: told as well.
        progress: of whoever watches.
        whole_s: to be simulated [s].
    """
    begun = False

    def tell(t: float) -> None:
        nonlocal begun
        if not begun:
            begun = True
            clock.told(t)
            to_be_ended.begin()
        if progress is not None:
            progress(t, whole_s)

    return tell


def _end(flight: AnyLoop, stopped: str, verdict: Verdict, results: tuple[CheckResult, ...]) -> RunEnd:
    """What the record says of its end."""
    told = flight.tick, flight.time_s, flight.given_up, verdict, results
    if flight.stopped is not None and not (stopped or flight.ended):
        return RunEnd("stopped", flight.stopped.reason, *told, stop=flight.stopped.verdict)
    how: How = "interrupted" if stopped else "ended early" if flight.ended else "completed"
    return RunEnd(how, stopped or flight.ended, *told)
