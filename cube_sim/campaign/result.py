"""What a sweep came to, as it is flown or read back from its folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pyarrow as pa

from cube_sim.campaign.counting import Counted, counted
from cube_sim.campaign.folder import SweepHead, differences, rows_in
from cube_sim.campaign.pass_rate import Interval, RateJudged, interval, judged
from cube_sim.campaign.rows import joined
from cube_sim.campaign.summary import WorstSample, command_of, worst_samples
from cube_sim.errors import DirectoryError
from cube_sim.flight_statistics import STATISTICS
from cube_sim.scenario.samples_block import RequiredBlock


@dataclass(frozen=True)
class SweepResult:
    """What a sweep came to.

    Attributes:
        folder: where its files are.
        head: what sweep.json says.
        rows: all of them, with their times.
        part: whether it is a part of a sweep alone.
    """

    folder: Path
    head: Mapping[str, Any]
    rows: pa.Table
    part: bool = False

    @property
    def name(self) -> str:
        """Of the scenario."""
        return self.head["name"]

    @property
    def limits(self) -> dict[str, float]:
        """The limit of each check, by its name, as the scenario has it."""
        return {check["name"]: check["limit"] for check in self.head["checks"]}

    @cached_property
    def counted(self) -> Counted:
        """What of it counts for the rate that is required, and how it came out."""
        return counted(self.rows, self.required)

    @property
    def interval(self) -> Interval:
        """Where the pass rate lies."""
        return interval(self.counted.passed, self.counted.count)

    @property
    def required(self) -> RequiredBlock | None:
        """What the samples must show; None where every one must pass."""
        given = self.head["required"]
        return None if given is None else RequiredBlock(**given)

    @property
    def verdict(self) -> RateJudged | None:
        """Of the rate of those that pass; None of a part of a sweep whose whole has to show one."""
        required = self.required
        if self.part and required is not None and (required.pass_rate is not None or required.each is not None):
            return None
        came = self.counted
        return judged(came.passed, came.failed, came.errors, self.required, came.words)

    def worst(self, most: int) -> list[WorstSample]:
        """Samples near the end of the list, of those that count."""
        came = self.counted
        among = pa.array([k in came.among for k in self.rows["sample"].to_pylist()], pa.bool_())
        return worst_samples(self.rows.filter(among), self.limits, most, came.against)

    def count(self, verdict: str) -> int:
        """How many samples have a verdict."""
        return self.rows["verdict"].to_pylist().count(verdict)

    def command(self, k: int) -> str:
        """What a shell takes to fly a sample again."""
        return command_of(self.head["scenario"], self.head["settings"], k)


def load_sweep(folders: Sequence[Path]) -> SweepResult:
    """Read a sweep back, also one that is not at its end.

    Args:
        folders: one, or several that hold parts of the same sweep.

    Raises:
        DirectoryError: they hold none, or not the same.
    """
    heads = [SweepHead.read(folder).content for folder in folders]
    for folder, head in zip(folders, heads, strict=True):
        if differing := differences(heads[0], head):
            what = "; ".join(differing)
            raise DirectoryError(f"{folder}: holds another sweep than {folders[0]}; what differs: {what}")
    checks = [check["name"] for check in heads[0]["checks"]]
    rows = joined([rows_in(folder, checks) for folder in folders], checks, STATISTICS)
    return SweepResult(folders[0], heads[0], rows)
