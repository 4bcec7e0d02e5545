"""Checks that look at rows as they come, so that nobody has to keep them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from cube_sim.baseline import baseline_signal
from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.evaluating import Evaluation
from cube_sim.checks.reasons import NotJudgedError
from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Batch, BySignal, Rows, Sink, signals
from cube_sim.recording.channels import Channel, held_signals, units_of
from cube_sim.recording.signal_store import SignalStore
from cube_sim.scenario import Scenario
from cube_sim.scenario.check_blocks import AnyCheck, BaselineCheckBlock
from cube_sim.verdict import CheckResult

BLOCK_S = 60.0
"""So much of a run is judged at once [s]."""


def beforehand_of(
    scenario: Scenario, channels: Sequence[Channel], files: Mapping[str, bytes] | None = None
) -> Beforehand:
    """What is known of a run before its rows come.

    Args:
        scenario: to be flown, or flown.
        channels: what it records.
        files: contents of files that its record carries, by name; None for one that is flown.
    """

    def baseline(check: BaselineCheckBlock) -> Rows:
        try:
            return baseline_signal(check.record, check.signal, files).rows
        except RecordingError as error:
            raise NotJudgedError(str(error)) from None

    phases = tuple(phase.name for phase in scenario.phases)
    return Beforehand(scenario.events, held_signals(channels), baseline, phases)


class JudgedRows:
    """Judges a run batch by batch, as a sink; it holds a minute of what the checks look at, however long the run.

    Args:
        channels: the channel table.
        scenario: what is flown, or was.
        checks: in place of the scenario's.
        files: as for `beforehand_of`.
    """

    def __init__(
        self,
        channels: Sequence[Channel],
        scenario: Scenario,
        checks: Sequence[AnyCheck] | None = None,
        files: Mapping[str, bytes] | None = None,
    ) -> None:
        self._channels = channels
        asked = scenario.checks if checks is None else checks
        self._evaluation, self._judge_at = Evaluation(asked, beforehand_of(scenario, channels, files)), BLOCK_S
        self._names = [f"{channel.name}.{field.name}" for channel in channels for field in channel.fields]
        needed = self._evaluation.needs.intersection(self._names)
        self._needed = [c for c in channels if needed.intersection(f"{c.name}.{field.name}" for field in c.fields)]
        self._rows: dict[str, list[Rows]] = {channel.name: [] for channel in self._needed}

    def write(self, batch: Batch) -> None:
        """Take the next batch."""
        for name, rows in self._rows.items():
            if name in batch.rows:
                rows.append(batch.rows[name])
        last = max((float(rows[-1, 0]) for rows in batch.rows.values()), default=-np.inf)
        if last >= self._judge_at:
            self._judge(np.floor(last))  # all rows before a whole second are there
            self._judge_at = np.floor(last) + BLOCK_S

    def close(self) -> None:
        """Nothing comes after."""

    def results(self, duration_s: float | None) -> tuple[CheckResult, ...]:
        """Judge, once nothing comes any more.

        Args:
            duration_s: how long the run should have been; None if nothing is known of that.
        """
        self._judge(np.inf)
        return self._evaluation.results(self._names, duration_s=duration_s, units=units_of(self._channels))

    def _judge(self, end: float) -> None:
        """Judge the rows before a time [s], and forget them."""
        block: dict[str, Rows] = {}
        for channel in self._needed:
            rows = np.concatenate([np.empty((0, 1 + channel.width)), *self._rows[channel.name]])
            count = int(np.searchsorted(rows[:, 0], end))
            block |= signals((channel,), {channel.name: rows[:count]})
            self._rows[channel.name] = [rows[count:].copy()]
        self._evaluation.take({name: block[name] for name in self._evaluation.needs if name in block})


class JudgedStore(SignalStore):
    """What the loop calls where the verdict alone is wanted: rows are judged, and nobody keeps them.

    Args:
        channels: the channel table.
        judge: of the rows.
    """

    def __init__(self, channels: Sequence[Channel], judge: Sink) -> None:
        super().__init__(channels)
        self._judge = judge

    @property
    def signals(self) -> Mapping[str, Rows]:
        """None."""
        return BySignal[Rows]()

    def settle(self) -> None:
        """Let the last rows be judged."""
        self._flush()

    def _keep(self, batch: Batch) -> None:
        self._judge.write(batch)
