"""One sample flown: a row of what became of it."""

from __future__ import annotations

import json
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, NamedTuple

from cube_sim.campaign.sampling import DrawnSample, SamplePlan
from cube_sim.errors import CubeSimError, DirectoryError, RecordingError, SweepError
from cube_sim.many_flights import FlightOutcome, Stop, StoppedFlightError, flown, own_traceback, unconfirmed
from cube_sim.scenario.fleet_loading import AnyLoaded, LoadedFleet
from cube_sim.scenario.shared import Shared
from cube_sim.simulation import fly
from cube_sim.vehicle.plugin.hook import install
from cube_sim.verdict import CheckResult

Keep = Literal["none", "failures", "all"]
"""Of which samples a recording stays."""
RUNS = "runs"
"""Folder of the recordings, one for each sample in it, by its number."""
GO_ON = "what is flown stays: go on with --resume once there is room"
"""What is to be done where a disk is full."""
CHECK, NOTE = "check", "note"
"""Before the name of a check, and of a note, in the name of a column."""


@dataclass(frozen=True)
class FlownSample:
    """What became of a sample.

    Attributes:
        row: by the name of the column; the same whoever flies it, wherever.
        flight_s: of the clock, between take-off and landing [s].
        wall_s: of the clock, drawing, preparation, judgement and recording included [s].
    """

    row: Mapping[str, Any]
    flight_s: float
    wall_s: float

    @property
    def index(self) -> int:
        """Its number."""
        return self.row["sample"]

    @property
    def verdict(self) -> str:
        """PASS, FAIL or ERROR."""
        return self.row["verdict"]


class Task(NamedTuple):
    """What all who fly samples are told, in whatever process.

    Attributes:
        loaded: the scenario.
        keep: of which samples a recording stays.
        folder: where the recordings go, in `RUNS`.
        limit_s: so long a sample may take, of the clock [s]; None: as long as it takes.
    """

    loaded: AnyLoaded
    keep: Keep
    folder: Path
    limit_s: float | None = None

    @property
    def too_long(self) -> str:
        """What is said of a sample that takes longer."""
        return f"not landed after {self.limit_s:g} s of the clock, the limit of a sample"


class SampleFlights:
    """Flies samples of a scenario; several threads may use it at once.

    Args:
        task: what is flown.

    Raises:
        ScenarioError: the scenario has no samples, or code that it names cannot be found.
    """

    def __init__(self, task: Task) -> None:
        self._task, self._plan = task, SamplePlan(sharing(task.loaded))
        self._turn = threading.Lock()  # samples are drawn one at a time
        install()

    def fly(
        self,
        k: int,
        stop: threading.Event | None = None,
        tell: Callable[[Mapping[str, Any]], None] | None = None,
    ) -> FlownSample:
        """Fly sample k; whatever goes wrong in it is its row.

        Args:
            k: its number.
            stop: once it is set, the flight is left, within a simulated second or ten; so it is at its time limit.
            tell: called with the columns of what is drawn, before it flies.

        Raises:
            StoppedFlightError: it was stopped.
            SweepError: what is to be kept of it cannot be.
        """
        begun, clock = time.perf_counter(), _FlightClock()
        limit = _Limit(stop, self._task.limit_s)
        row: dict[str, Any] = {"sample": k, "verdict": "ERROR", "reason": "", "seed": None}
        try:
            with self._turn:
                sample = self._plan.sample(k)
                columns = drawn_columns(sample)
                row |= columns
                if tell is not None:
                    tell(columns)
                loaded = self._plan.scenario_of(sample)
            row["seed"] = loaded.scenario.seed
            outcome = flown(unconfirmed(loaded), sample.values, stop=limit, around=clock)
            row |= _columns(outcome)
            self._keep_recording(k, loaded, outcome)
        except SweepError:
            raise
        except StoppedFlightError:
            if stop is not None and stop.is_set():
                raise
            row |= {"reason": self._task.too_long}
        except CubeSimError as error:
            row |= {"reason": _one_line(error)}
            if said := own_traceback(error):
                row["traceback"] = said
        except (Exception, KeyboardInterrupt) as error:  # the second is the user's own code's: a worker hears no Ctrl-C
            row |= {"reason": f"{type(error).__name__}: {_one_line(error)}", "traceback": _below_here(error)}
        return FlownSample(row, clock.seconds, time.perf_counter() - begun)

    def drawn(self, k: int) -> Mapping[str, Any]:
        """Columns of what is drawn for sample k, without flying it; none where code of the user's own draws it.

        That code may be what a process has died of.
        """
        if self._plan.block.generator is not None:
            return {}
        with suppress(CubeSimError), self._turn:
            return drawn_columns(self._plan.sample(k))
        return {}

    def _keep_recording(self, k: int, loaded: AnyLoaded, outcome: FlightOutcome) -> None:
        """Fly it once more, with a recording, where that is wanted: what passes has cost nothing for it."""
        if self._task.keep == "all" or (self._task.keep == "failures" and outcome.verdict != "PASS"):
            try:
                again = fly(loaded, out=self._task.folder / RUNS / str(k), record="mcap")
            except (RecordingError, DirectoryError) as error:
                raise SweepError(f"the recording of sample {k} cannot be kept: {_one_line(error)}; {GO_ON}") from None
            if again.checks != outcome.checks:
                raise CubeSimError(f"flown again with a recording, it is another flight: {_words(again.checks)}")


def died(k: int, reason: str, said: str, drawn: Mapping[str, Any], wall_s: float = 0.0) -> FlownSample:
    """What became of a sample whose process died.

    Args:
        k: its number.
        reason: of what.
        said: what the process said of itself at its end.
        drawn: columns of what was drawn, as far as that is known.
        wall_s: of the clock, until then [s].
    """
    row: dict[str, Any] = {"sample": k, "verdict": "ERROR", "reason": reason, "seed": None}
    return FlownSample(row | dict(drawn) | {"traceback": said}, 0.0, wall_s)


def sharing(loaded: AnyLoaded) -> AnyLoaded:
    """The same scenario, whose variations share what all of them need."""
    return loaded.sharing() if isinstance(loaded, LoadedFleet) else replace(loaded, shared=Shared())


class _Limit:
    """Is set once a flight is to be left: because somebody says so, or because its time is over."""

    def __init__(self, stop: Stop | None, limit_s: float | None) -> None:
        self._stop, self._until = stop, None if limit_s is None else time.monotonic() + limit_s

    def is_set(self) -> bool:
        over = self._until is not None and time.monotonic() > self._until
        return over or (self._stop is not None and self._stop.is_set())


class _FlightClock:
    """Seconds spent within it."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def __enter__(self) -> None:
        self._begun = time.perf_counter()

    def __exit__(self, *_: object) -> None:
        self.seconds += time.perf_counter() - self._begun


def drawn_columns(sample: DrawnSample) -> dict[str, Any]:
    """Notes and what was drawn, a column for each number: of a list by its index, names joined, the rest JSON."""
    found: dict[str, Any] = {}
    for name, value in sample.notes.items():
        found |= dict(_flat(f"{NOTE}.{name}", value))
    for path, value in sample.values.items():
        found |= dict(_flat(path, value))
    found.pop("seed", None)  # a column that every sample has
    return found


def _flat(path: str, value: Any) -> Iterator[tuple[str, Any]]:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple) and value and all(_is_number(each) for each in value):
        for index, each in enumerate(value):
            yield f"{path}.{index}", each
    elif isinstance(value, list | tuple) and all(isinstance(each, str) for each in value):
        yield path, "+".join(value)
    elif _is_number(value) or isinstance(value, str | bool) or value is None:
        yield path, value
    else:
        yield path, json.dumps(value, default=str)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _columns(outcome: FlightOutcome) -> dict[str, Any]:
    """What a flight came to."""
    found: dict[str, Any] = {"verdict": outcome.verdict, "reason": _reason(outcome), "simulated_s": outcome.simulated_s}
    for check in outcome.checks:
        name = f"{CHECK}.{check.name}"
        found |= {
            f"{name}.value": check.value,
            f"{name}.limit": check.limit,
            f"{name}.margin": check.margin,
            f"{name}.verdict": check.verdict,
            f"{name}.at_s": check.at_s,
            f"{name}.unit": check.unit,
        }
    if outcome.traceback:
        found["traceback"] = outcome.traceback
    return found | dict(outcome.statistics)


def _reason(outcome: FlightOutcome) -> str:
    """Why it did not pass, in one line; "" where it did."""
    why = _words(check for check in outcome.checks if check.verdict == outcome.verdict != "PASS")
    early = outcome.ended_early
    if early is None:
        return why
    end = f"ended at {early.time_s:g} s: {early.reason}"
    return f"{why}; {end}" if why and early.verdict == "PASS" else end  # of its proper end it has not failed


def _words(checks: Any) -> str:
    return "; ".join(map(_said, checks))


def _said(check: CheckResult) -> str:
    if check.value is None:
        return f"{check.name}: {check.detail}"
    unit = "" if check.unit in ("", "1") else f" {check.unit}"
    return f"{check.name}: {check.value:.4g}{unit}, {check.relation} {check.limit:g} wanted"


def _one_line(error: BaseException) -> str:
    return " ".join(str(error).split())


def _below_here(error: BaseException) -> str:
    """The traceback from the sample on: who flies it, a thread or a cluster, is no part of what went wrong."""
    place: TracebackType | None = error.__traceback__
    return "".join(traceback.format_exception(type(error), error, place.tb_next if place is not None else None))
