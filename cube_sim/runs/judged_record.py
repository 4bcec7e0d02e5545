"""A record judged again, some seconds of it in memory at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from cube_sim.errors import RecordingError
from cube_sim.judged_store import JudgedRows
from cube_sim.recording.batch import Batch
from cube_sim.recording.one_pass import OnePass
from cube_sim.run_directory import record_of
from cube_sim.runs.judging import asked_duration_s, concluded, judged
from cube_sim.runs.recorded_run import RecordedRun, load_run, told_beside
from cube_sim.runs.row_times import RowTimes
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.verdict import CheckResult, Verdict

Asked = Callable[[RecordedRun], Sequence[AnyCheck] | None]


@dataclass(frozen=True)
class JudgedRecord:
    """A run judged again.

    Attributes:
        run: what was judged.
        verdict: of the whole.
        results: one per check.
        remarks: why the whole cannot be judged, a line each.
    """

    run: RecordedRun
    verdict: Verdict
    results: tuple[CheckResult, ...]
    remarks: tuple[str, ...]


def judged_record(path: Path, asked: Asked) -> JudgedRecord:
    """Judge a record again, in the same memory however long it is.

    One whose rows another program has put out of the order of time, and a damaged one, is read as a whole: what is
    found, or said of it, is what `load_run` and `judged` find and say of any.

    Args:
        path: a run's folder, or its record.
        asked: the checks to hold it against, of a run of which the inputs and the channels are known; None: its own.

    Raises:
        RecordingError: as `load_run`.
        ScenarioError: as `asked`.
    """
    record = record_of(path)
    try:
        return judged_in_one_pass(record, asked)
    except RecordingError:
        run = load_run(path)
        return JudgedRecord(run, *judged(run, asked(run)))


def judged_in_one_pass(record: Path, asked: Asked) -> JudgedRecord:
    """Judge a record whose rows stand in the order of time.

    Args:
        record: the MCAP file.
        asked: as for `judged_record`.

    Raises:
        RecordingError: it is damaged, or none of this kind.
        ScenarioError: as `asked`.
    """
    told, read = told_beside(record), OnePass(record)
    run = RecordedRun(record, read.beginning, told)
    if run.header.vehicles:
        raise RecordingError(f"{record}: is of several vehicles, and read as a whole")
    scenario = run.scenario
    checks = asked(run)
    checks = scenario.checks if checks is None else checks
    judge, row_times = JudgedRows(run.recording.channels, scenario, checks, run.header.inputs), dict[str, RowTimes]()
    for rows in read.blocks():
        for name, some in rows.items():
            row_times.setdefault(name, RowTimes(scenario.control_period_s)).take(some[:, 0])
        judge.write(Batch(rows))
    ordered = {channel.name: row_times[channel.name] for channel in run.recording.channels if channel.name in row_times}
    run = RecordedRun(record, read.finish(), told, ordered)
    return JudgedRecord(run, *concluded(run, checks, judge.results(asked_duration_s(run))))
