"""One run of the report: what it is called, what became of it, and its signals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from cube_sim.recording.batch import Rows
from cube_sim.report.thruster_use import ThrusterUse, thruster_uses
from cube_sim.runs.judging import judged
from cube_sim.runs.recorded_run import RecordedRun
from cube_sim.scenario import Scenario
from cube_sim.verdict import CheckResult, Verdict

NO_VERDICT = "NOT JUDGED"


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
        """Rows of a signal (n, 1+width), infinities as NaN; none where the run has no such signal."""
        if signal not in self._rows:
            rows = self.run.signals.get(signal, np.empty((0, 1 + self._width(signal))))
            self._rows[signal] = np.where(np.isinf(rows), np.nan, rows) if np.isinf(rows).any() else rows
        return self._rows[signal]

    def has(self, signal: str) -> bool:
        """Whether there are rows of it."""
        return len(self.rows(signal)) > 0

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
        """The headline: PASS only where verdict.json says so and the record agrees, to its end."""
        if self.run.verdict is None:
            return NO_VERDICT
        said, found = self._said.get("verdict"), self.judged[0]
        if said == found:
            return found
        return "FAIL" if "FAIL" in (said, found) else "ERROR"

    @cached_property
    def remarks(self) -> tuple[str, ...]:
        """Why the headline is not simply that of the checks, a line each."""
        found, _, remarks = self.judged
        lines = list(remarks)
        if self.run.verdict is None:
            lines.append(f"there is no verdict.json beside the record; judged from it now, the checks say {found}")
        elif self._said.get("verdict") != found:
            lines.append(
                f"verdict.json says {self._said.get('verdict')}; judged from the record, the checks say {found}"
            )
        early = self._said.get("ended_early")
        if isinstance(early, Mapping) and not any("ended early" in line for line in lines):
            lines.append(f"ended early, at {early.get('time_s')} s: {early.get('reason')}")
        return tuple(lines)

    @property
    def _said(self) -> Mapping[str, Any]:
        """What verdict.json says; nothing where it is none of ours."""
        return self.run.verdict if isinstance(self.run.verdict, Mapping) else {}

    @cached_property
    def thrusters(self) -> tuple[ThrusterUse, ...]:
        """What each thruster did, in the order of the columns of A."""
        needed = {name: self.rows(name) for name in ("thrusters.force_demanded", "actuation.limits", "power.motor")}
        return thruster_uses(needed, self.columns("thrusters.force_demanded"))

    def _width(self, signal: str) -> int:
        field = self.run.fields.get(signal)
        return 1 if field is None else field.width
