"""Checks of several vehicles, each judged by its own rows, and those over several by the rows of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from cube_sim.judged_store import JudgedRows
from cube_sim.recording.among import channels_of, rows_of
from cube_sim.recording.batch import Batch, Rows
from cube_sim.recording.channels import Channel
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.scenario.fleet import FleetScenario
from cube_sim.verdict import CheckResult


class JudgedFleet:
    """Judges a run of several vehicles batch by batch, as a sink.

    Args:
        channels: the channel table of the run.
        scenario: of all; each vehicle's checks are told with its name.
        checks: over several vehicles in place of the scenario's; the vehicles' own are then not asked.
    """

    def __init__(
        self, channels: Sequence[Channel], scenario: FleetScenario, checks: Sequence[AnyCheck] | None = None
    ) -> None:
        own = scenario.vehicles if checks is None else {}
        self._of_each = {name: JudgedRows(channels_of(name, channels), one) for name, one in own.items() if one.checks}
        asked = scenario.checks if checks is None else checks
        self._of_all = JudgedRows(channels, scenario.together, asked) if asked else None

    def write(self, batch: Batch) -> None:
        """Take the next batch."""
        for name, judge in self._of_each.items():
            if own := rows_of(name, batch.rows):
                judge.write(Batch(own))
        if self._of_all is not None and batch.rows:
            self._of_all.write(batch)

    def close(self) -> None:
        """Nothing comes after."""

    def results(self, duration_s: float | None) -> tuple[CheckResult, ...]:
        """Judge, once nothing comes any more.

        Args:
            duration_s: how long the run should have been; None if nothing is known of that.
        """
        found = [
            replace(result, name=f"{name}: {result.name}")
            for name, judge in self._of_each.items()
            for result in judge.results(duration_s)
        ]
        return (*found, *(() if self._of_all is None else self._of_all.results(duration_s)))


def evaluate_fleet(
    channels: Sequence[Channel],
    scenario: FleetScenario,
    rows: Mapping[str, Rows],
    duration_s: float | None,
    checks: Sequence[AnyCheck] | None = None,
) -> tuple[CheckResult, ...]:
    """Judge all rows at once.

    Args:
        channels: the channel table.
        scenario: of all.
        rows: of each channel.
        duration_s: how long the run should have been; None if nothing is known of that.
        checks: as for `JudgedFleet`.
    """
    judge = JudgedFleet(channels, scenario, checks)
    judge.write(Batch(rows))
    return judge.results(duration_s)
