"""One run of the report: what it is called, what became of it, and its signals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.judged_window import PHASE, JudgedWindow
from cube_sim.checks.reasons import NotJudgedError
from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import held_signals
from cube_sim.report import colours
from cube_sim.report.thruster_use import ThrusterUse, thruster_uses
from cube_sim.run_directory import VERDICT_FILE
from cube_sim.runs.judging import judged
from cube_sim.runs.recorded_run import RecordedRun, Span
from cube_sim.scenario import Scenario
from cube_sim.scenario.windows import TimeWindow
from cube_sim.verdict import CheckResult, Verdict

NO_VERDICT = "NOT JUDGED"


class FlownPhase(NamedTuple):
    """A phase of the mission, as it was flown.

    Attributes:
        number: of it, from 0.
        name: its name.
        start_s: when it began [s].
        end_s: when the next one began, or the last row was recorded [s].
    """

    number: int
    name: str
    start_s: float
    end_s: float


@dataclass(frozen=True, eq=False)
class Subject:
    """A run and how the page tells it from others.

    Attributes:
        run: as its files have it.
        label: short name.
        colour: of its curves beside other runs.
    """

    run: RecordedRun
    label: str
    colour: str

    @cached_property
    def _rows(self) -> dict[str, Rows]:
        return {}

    @property
    def scenario(self) -> Scenario:
        """What was flown."""
        return self.run.scenario

    def rows(self, signal: str) -> Rows:
        """Rows of a signal (n, 1+width), infinities as NaN; none where the run has no such signal.

        Where ticks are missing inside the run, a row of NaN stands for them: nothing is drawn as flown there.
        """
        if signal not in self._rows:
            rows = self.run.signals.get(signal, np.empty((0, 1 + self._width(signal))))
            if len(rows) and self.gaps and signal.partition(".")[0] in self._every_tick:
                starts = np.array([start for start, _ in self.gaps])
                rows = np.insert(rows, np.searchsorted(rows[:, 0], starts), np.nan, axis=0)
                rows[np.isnan(rows[:, 0]), 0] = starts
            self._rows[signal] = np.where(np.isinf(rows), np.nan, rows) if np.isinf(rows).any() else rows
        return self._rows[signal]

    @cached_property
    def gaps(self) -> tuple[Span, ...]:
        """From when to when there is nothing, before the last row [s]: what was lost of a record that was damaged."""
        return tuple(span for span in self.run.missing_s if span[1] <= self.run.recorded_s)

    @cached_property
    def _every_tick(self) -> frozenset[str]:
        return frozenset(channel.name for channel in self.run.recording.channels if channel.every_tick)

    @cached_property
    def phases(self) -> tuple[FlownPhase, ...]:
        """Those that were entered, in their order."""
        rows, labels = self.run.signals.get(PHASE, np.empty((0, 2))), self.labels(PHASE)
        rows = rows[np.diff(rows[:, 1], prepend=-1.0) != 0]  # another row of the last one says how it ended
        starts, ends = rows[:, 0].tolist(), [*rows[1:, 0].tolist(), self.run.recorded_s]
        numbers = rows[:, 1].astype(int).tolist()
        return tuple(
            FlownPhase(number, labels[number], start, end)
            for number, start, end in zip(numbers, starts, ends, strict=False)
            if number < len(labels)
        )

    def span(self, window: TimeWindow) -> Span:
        """A check's window in seconds of this run; of a phase that was never entered, nothing at its end."""
        if window.phase is None:
            return window.within(self.scenario.duration_s)
        names = [phase.name for phase in self.scenario.phases]
        judged_window = JudgedWindow(window, Beforehand(phases=names))
        judged_window.take({PHASE: self.run.signals.get(PHASE, np.empty((0, 2)))})
        try:
            return judged_window.shown(self.run.recorded_s).within(self.run.recorded_s)
        except NotJudgedError:
            return self.run.recorded_s, self.run.recorded_s

    def has(self, signal: str) -> bool:
        """Whether there are rows of it."""
        return len(self.rows(signal)) > 0

    def is_held(self, signal: str) -> bool:
        """Whether a row of a signal holds until the next."""
        return signal in self._held

    @cached_property
    def _held(self) -> frozenset[str]:
        return held_signals(self.run.recording.channels)

    def unit(self, signal: str) -> str:
        """Of a signal; "" where there is none."""
        field = self.run.fields.get(signal)
        return "" if field is None else field.unit

    def columns(self, signal: str) -> tuple[str, ...]:
        """Names of a signal's numbers, without its own."""
        field = self.run.fields.get(signal)
        return () if field is None else field.columns or tuple(map(str, range(field.width)))

    def labels(self, signal: str) -> tuple[str, ...]:
        """What the codes of a signal mean; () where they have no names."""
        field = self.run.fields.get(signal)
        return () if field is None else field.labels

    @cached_property
    def judged(self) -> tuple[Verdict, tuple[CheckResult, ...], tuple[str, ...]]:
        """Verdict, results and remarks by the record itself."""
        return judged(self.run)

    @property
    def results(self) -> tuple[CheckResult, ...]:
        """One per check of the scenario."""
        return self.judged[1]

    @cached_property
    def verdict(self) -> str:
        """The headline: PASS only where the run was said to pass and the record agrees, to its end."""
        if not self._said:
            return NO_VERDICT
        found = self.judged[0]
        if all(word == found for _, word in self._said):
            return found
        return "FAIL" if "FAIL" in (found, *(word for _, word in self._said)) else "ERROR"

    @cached_property
    def remarks(self) -> tuple[str, ...]:
        """Why the headline is not simply that of the checks, a line each."""
        found, _, remarks = self.judged
        lines = list(remarks)
        if not self._said and self.scenario.checks:
            lines.append(f"nothing says what it was judged; judged from the record now, it is {found}")
        lines += [
            f"{who} says {word}; judged from the record now, it is {found}" for who, word in self._said if word != found
        ]
        early = self._told.get("ended_early")
        if isinstance(early, Mapping) and not any("ended early" in line or "stopped, at" in line for line in lines):
            lines.append(f"ended early, at {early.get('time_s')} s: {early.get('reason')}")
        return tuple(lines)

    @property
    def _told(self) -> Mapping[str, Any]:
        """What verdict.json says; nothing where it is none of ours."""
        return self.run.told if isinstance(self.run.told, Mapping) else {}

    @property
    def _said(self) -> list[tuple[str, object]]:
        """Who says what the run was judged."""
        said: list[tuple[str, object]] = []
        if self.run.end is not None and self.run.end.verdict is not None:
            said.append(("the record's end", self.run.end.verdict))
        if self.run.told is not None:
            said.append((VERDICT_FILE, self._told.get("verdict")))
        return said

    @cached_property
    def thrusters(self) -> tuple[ThrusterUse, ...]:
        """What each thruster did, in the order of the columns of A."""
        needed = {name: self.rows(name) for name in ("thrusters.force_demanded", "actuation.limits", "power.motor")}
        return thruster_uses(needed, self.columns("thrusters.force_demanded"))

    def _width(self, signal: str) -> int:
        field = self.run.fields.get(signal)
        return 1 if field is None else field.width


def subjects_of(runs: Sequence[RecordedRun], labels: Sequence[str]) -> tuple[list[Subject], list[Subject]]:
    """Those of the page, and of runs of several vehicles, each of which is one, all vehicles of each together.

    Args:
        runs: one or more.
        labels: a short name for each, all different.
    """
    named: list[tuple[RecordedRun, str]] = []
    together = []
    for run, label in zip(runs, labels, strict=True):
        if run.vehicles:
            together.append(Subject(run.together, label, colours.BLACK))
            named += [(one, name if len(runs) == 1 else f"{label}: {name}") for name, one in run.vehicles.items()]
        else:
            named.append((run, label))
    return [Subject(run, label, colours.of_index(index)) for index, (run, label) in enumerate(named)], together
