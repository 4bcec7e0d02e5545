"""A run read back from its folder, or from its record alone."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, get_args

from pydantic import ValidationError

from cube_sim.errors import RecordingError
from cube_sim.recording.among import fleet_in, recordings_of, together_of
from cube_sim.recording.batch import BySignal, Rows, SignalsOf
from cube_sim.recording.channels import Field
from cube_sim.recording.header import RunHeader
from cube_sim.recording.reading import ALTERED, CANNOT_KNOW, NO_END, Recording, read_recording
from cube_sim.recording.run_end import How, RunEnd
from cube_sim.run_directory import MCAP_FILE, VERDICT_FILE, record_of
from cube_sim.run_log import LogLine
from cube_sim.runs.losses import Loss, losses_of
from cube_sim.runs.row_times import RowTimes, Span, row_times_of
from cube_sim.scenario import Scenario
from cube_sim.scenario.document import parse
from cube_sim.scenario.fleet import SEPARATOR, FleetScenario
from cube_sim.verdict import CheckResult, EarlyEnd, Verdict


@dataclass(frozen=True, eq=False, repr=False)
class RecordedRun:
    """A run as its files have it; it equals itself alone: `cube-sim diff` and `differences` compare two.

    Attributes:
        path: of the record.
        recording: what the record holds.
        told: what verdict.json beside it says, as plain data; None without one.
        row_times: when each channel has rows, of a run read in passing; None: its rows say it.
    """

    path: Path
    recording: Recording
    told: Mapping[str, Any] | None
    row_times: Mapping[str, RowTimes] | None = None

    @cached_property
    def signals(self) -> Mapping[str, Rows]:
        """Every signal as "channel.field" -> (n, 1+width), column 0 the time [s]; the bits the run had in memory.

        A name that is none is an `UnknownSignalError`, which is a KeyError too and says which is nearest.
        """
        return SignalsOf(self.recording.channels, self.recording.rows)

    @cached_property
    def fields(self) -> dict[str, Field]:
        """Width, unit, meaning with its frame, and column names of each signal, by the same names."""
        return BySignal(
            (f"{channel.name}.{field.name}", field) for channel in self.recording.channels for field in channel.fields
        )

    @property
    def header(self) -> RunHeader:
        """The inputs of the run."""
        return self.recording.header

    @cached_property
    def scenario(self) -> Scenario:
        """The scenario flown, every default written out; files go by their names in the record.

        Raises:
            RecordingError: it is none that this version knows, or of several vehicles: each of `vehicles` has its own.
        """
        if self.header.vehicles:
            raise RecordingError(f"{self.path}: is of several vehicles: {', '.join(self.header.vehicles)}")
        try:
            return Scenario.model_validate(self.resolved, context={"several": True})
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = ".".join(map(str, first["loc"]))
            raise RecordingError(
                f"{self.path}: its scenario is none of this version: {where}: {first['msg']}"
            ) from None

    @cached_property
    def whole(self) -> Scenario | FleetScenario:
        """The scenario flown, of one vehicle or of several.

        Raises:
            RecordingError: it is none that this version knows.
        """
        return fleet_in(self.header) if self.header.vehicles else self.scenario

    @cached_property
    def vehicles(self) -> dict[str, RecordedRun]:
        """Of several vehicles, the run of each under the names it would have alone, by name; of one, nothing.

        Raises:
            RecordingError: the scenario is none that this version knows.
        """
        runs = {}
        for name, recording in recordings_of(self.recording).items():
            start = f"{name}{SEPARATOR}"
            times = self.row_times and {key.removeprefix(start): its for key, its in self.row_times.items()}
            runs[name] = RecordedRun(self.path, recording, None, times)
        return runs

    @cached_property
    def together(self) -> RecordedRun:
        """Of several vehicles, all of them as one run, whose checks are those over several.

        Raises:
            RecordingError: the scenario is none that this version knows.
        """
        return RecordedRun(self.path, together_of(self.recording), self.told, self.row_times)

    @cached_property
    def resolved(self) -> dict[str, Any]:
        """The same as its file holds it, plain data.

        Raises:
            RecordingError: it is no scenario.
        """
        data = parse(self.header.resolved).data
        if not isinstance(data, dict):
            raise RecordingError(f"{self.path}: the scenario in it is none")
        return data

    @property
    def log(self) -> tuple[LogLine, ...]:
        """All that was said, in the order of time."""
        return self.recording.log

    @property
    def end(self) -> RunEnd | None:
        """How the run ended; None where the record does not say it, as after a crash and before format 3."""
        return self.recording.end

    @property
    def how(self) -> How | None:
        """How the run ended, in a word; None where the record does not say it."""
        return None if self.end is None else self.end.how

    @property
    def simulated_s(self) -> float:
        """Simulated time from the start to the end [s]; as far as the record goes where it does not say it."""
        return self.recorded_s if self.end is None or self.end.simulated_s is None else self.end.simulated_s

    @property
    def ended_early(self) -> EarlyEnd | None:
        """When and why the run, or what there is of it, ended before its time; None where all of it was flown."""
        if self.end is None:
            lines = [line for line in self.log if line.level == "ERROR" and line.t >= self.recorded_s]
            return EarlyEnd(self.recorded_s, lines[-1].text if lines else self.flaw) if self.flaw or lines else None
        match self.end.how:
            case "completed":
                return None
            case "stopped":
                return EarlyEnd(self.simulated_s, self.end.reason, self.end.stop or "ERROR")
            case "interrupted":
                return EarlyEnd(self.simulated_s, f"interrupted by {self.end.reason}")
            case "recovered" if self._reaches_its_end:
                return None
        return EarlyEnd(min(self.recorded_s, self.simulated_s), self.end.reason)

    @property
    def versions(self) -> Mapping[str, str]:
        """Of each package that took part in the numbers, and of what else did."""
        return self.header.versions

    @property
    def build(self) -> str:
        """Which code of cube_sim flew: the start of the SHA-256 of its source, and its commit where that is known."""
        return self.header.build

    def __repr__(self) -> str:
        """Name, verdict and how it ended, in one line."""
        try:
            name = self.resolved.get("name", "")
        except RecordingError:
            name = "of no scenario"
        ended = self.how or "without an end"
        return f"<RecordedRun {name}: {self.verdict or 'not judged'}, {ended}, {self.simulated_s:g} s: {self.path}>"

    @property
    def verdict(self) -> Verdict | None:
        """What the run was judged, in the same word as `cube_sim.run(...).verdict`.

        It is that of the record; where the record does not say it, that of verdict.json beside it. None where neither
        does, and of a record that was altered.
        """
        if self.end is not None:
            return None if self.altered else self.end.verdict
        said = self.told.get("verdict") if isinstance(self.told, Mapping) else None
        return next((word for word in get_args(Verdict) if word == said), None)

    @property
    def altered(self) -> bool:
        """Whether something in the record is not as it was written, by the digests at its end, or was not before."""
        saved = self.end is not None and self.end.how == "recovered" and self.end.reason.startswith(ALTERED)
        return saved or self.recording.flaw.startswith(ALTERED)

    @property
    def checks(self) -> tuple[CheckResult, ...]:
        """One result per check of the scenario, as `cube_sim.run(...).checks`; () where the record has none."""
        return () if self.end is None else self.end.checks

    @property
    def complete(self) -> bool:
        """Whether this is all of a flight that came to its end, as it was recorded; else `flaw` says why not."""
        return not self.flaw

    @cached_property
    def flaw(self) -> str:
        """Why this is not all of what was recorded of a flight that came to its end, in words; "" if it is."""
        flaw = self.recording.flaw
        if not flaw or self.end is not None:
            return flaw
        if flaw == CANNOT_KNOW:
            # Rows that do not reach the end of the time are known not to be all, unless the flight ended itself.
            of_itself = any(line.level == "ERROR" and line.t >= self.recorded_s for line in self.log)
            return flaw if of_itself or self._reaches_its_end else self._early
        return self._early if flaw == NO_END else f"{self._early}: {flaw}"

    @property
    def _early(self) -> str:
        early = f"the record ends early, at {self.recorded_s:.10g} s"
        try:
            if self._reaches_its_end:
                return f"its rows go to the end, {self.whole.duration_s:.10g} s, but {NO_END}"
            return f"{early} of {self.whole.duration_s:.10g} s"
        except RecordingError:  # a scenario of another version can be looked at all the same
            return early

    @property
    def _reaches_its_end(self) -> bool:
        """Whether there are rows of the last control period."""
        return self.recorded_s > (self.whole.ticks - 0.5) * self.whole.control_period_s

    @property
    def recorded_s(self) -> float:
        """The time of the last row [s]; 0 without rows."""
        if self.row_times is not None:
            return max((times.last_s for times in self.row_times.values()), default=0.0)
        return max((float(rows[-1, 0]) for rows in self.recording.rows.values() if len(rows)), default=0.0)

    @cached_property
    def missing_s(self) -> tuple[Span, ...]:
        """From when to when there are no rows [s], of the channel that has most; none of a run that is whole."""
        empty = RowTimes(self.whole.control_period_s)
        most = max(self._row_times.values(), key=lambda times: times.rows, default=empty)
        return most.spans_without_rows(self._last_s)

    @cached_property
    def losses(self) -> tuple[Loss, ...]:
        """What each channel lacks, of those that lack anything; none of a run that is whole."""
        return losses_of(self.recording, self._row_times, self.whole.control_period_s, self._last_s)

    @cached_property
    def _row_times(self) -> Mapping[str, RowTimes]:
        if self.row_times is not None:
            return self.row_times
        return row_times_of(self.recording.rows, self.whole.control_period_s)

    @property
    def _last_s(self) -> float:
        """When the last row should be [s]."""
        end = self.end
        return self.whole.duration_s if end is None or end.simulated_s is None else end.simulated_s

    def to_pandas(self, channel: str) -> Any:
        """The rows of a channel as a DataFrame, named as by `cube-sim export`, with units: the time is "t [s]".

        Args:
            channel: its name, for example path_error.

        Raises:
            RecordingError: no such channel, or pandas is not installed.
        """
        from cube_sim.runs.tables import pandas_frame, table_of

        return pandas_frame(table_of(self, channel))

    def to_polars(self, channel: str) -> Any:
        """The same for polars.

        Args:
            channel: its name, for example path_error.

        Raises:
            RecordingError: no such channel, or polars is not installed.
        """
        from cube_sim.runs.tables import polars_frame, table_of

        return polars_frame(table_of(self, channel))

    def column_names(self, signal: str) -> tuple[str, ...]:
        """A name for each number of a signal, as tables have it: with its field's name, and its unit in brackets."""
        field = self.fields[signal]
        parts = field.columns or tuple(map(str, range(field.width)))
        names = (signal,) if field.is_single_number else tuple(f"{signal}.{part}" for part in parts)
        return tuple(f"{name} [{unit}]" for name, unit in zip(names, field.units, strict=True))


def load_run(path: str | Path) -> RecordedRun:
    """Read a run back.

    Args:
        path: its folder, or its record.

    Raises:
        RecordingError: there is no record, it is not one of cube_sim, or it is damaged. One that merely ends early is
            read as far as it goes.
    """
    record = record_of(Path(path))
    told = told_beside(record)
    return RecordedRun(record, read_recording(record), told)


def told_beside(record: Path) -> Mapping[str, Any] | None:
    """What verdict.json beside a record says, as plain data; None without one.

    Raises:
        RecordingError: it cannot be read.
    """
    beside = record.with_name(VERDICT_FILE)
    if record.name != MCAP_FILE or not beside.is_file():
        return None
    try:
        return json.loads(beside.read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        raise RecordingError(f"{beside}: cannot be read: {error}") from None
