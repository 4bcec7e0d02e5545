"""A damaged record written anew, without what cannot be read."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import split_into_batches
from cube_sim.recording.mcap.sink import McapSink
from cube_sim.recording.reading import Recording
from cube_sim.recording.run_end import RunEnd
from cube_sim.recording.salvage import salvage
from cube_sim.run_directory import MCAP_FILE, RRD_FILE, claim
from cube_sim.runs.recorded_run import RecordedRun

Span = tuple[float, float]


@dataclass(frozen=True)
class Recovered:
    """What became of a recovery.

    Attributes:
        directory: where the new record is, and its view.
        recorded_s: how far the record goes [s].
        missing_s: from when to when rows are missing [s].
        dropped: what could not be read, a line each.
        view: why the view could not be made; "" if it was.
    """

    directory: Path
    recorded_s: float
    missing_s: tuple[Span, ...]
    dropped: tuple[str, ...]
    view: str


def recover(record: Path, directory: Path) -> Recovered | None:
    """Write what can be read of a record into a folder, and its view.

    Args:
        record: the MCAP file.
        directory: new, empty, or that of an earlier run, which is replaced.

    Returns:
        None where the record is complete: nothing is written then.

    Raises:
        RecordingError: nothing can be read of it.
        DirectoryError: the folder holds something else, or cannot be written.
        OSError: the disk is full, or gone.
    """
    if directory.resolve() == record.parent.resolve():
        raise RecordingError(f"{directory}: is the folder of the record itself; give another")
    found = salvage(record)
    run = RecordedRun(record, found.recording, None)
    if run.complete and not found.dropped:
        return None
    missing = missing_spans(run)
    before = run.end
    end = RunEnd(
        "recovered",
        "; ".join(found.dropped) or run.flaw,
        None if before is None else before.ticks,
        None if before is None else before.simulated_s,
        missing_s=missing,
    )
    with claim(directory, run.scenario.name) as folder:
        _write(folder / MCAP_FILE, found.recording, end)
        return Recovered(folder, run.recorded_s, missing, found.dropped, _view(folder))


def _write(path: Path, recording: Recording, end: RunEnd) -> None:
    sink = McapSink(path, recording.header, recording.channels, recording.vehicle)
    try:
        for batch in split_into_batches(recording.rows, recording.log):
            sink.write(batch)
        sink.finish(end)
    finally:
        sink.close()


def _view(folder: Path) -> str:
    """Make the view; why that was not possible, in one line."""
    from cube_sim.recording.export import rrd_from_mcap

    try:
        rrd_from_mcap(folder / MCAP_FILE, folder / RRD_FILE)
    except Exception as error:  # the view is made of the record again whenever somebody wants it
        return " ".join(str(error).split())
    return ""


def missing_spans(run: RecordedRun) -> tuple[Span, ...]:
    """From when to when a run has no rows [s], of the channel that has most.

    Args:
        run: read back.
    """
    period, end = run.scenario.control_period_s, run.end
    last_s = run.scenario.duration_s if end is None or end.simulated_s is None else end.simulated_s
    times = max((rows[:, 0] for rows in run.recording.rows.values()), key=len, default=np.empty(0))
    # A row stands for the period that it begins; the last one is the state at the end.
    edges = np.concatenate([[-period], times, [last_s + period]])
    gaps = np.flatnonzero(np.diff(edges) > 1.5 * period)
    return tuple((float(edges[k] + period), float(min(edges[k + 1], last_s))) for k in gaps)
