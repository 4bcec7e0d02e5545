"""What of a run is not in its record: of which channels, from when to when, how many rows."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from cube_sim.recording.reading import Recording
from cube_sim.runs.row_times import RowTimes, Span


@dataclass(frozen=True)
class Loss:
    """Rows that a channel lacks.

    Attributes:
        channel: its name.
        rows: how many; of a channel with a row at each control period by the times, where the record does not say it.
        of: how many there were; None where nobody knows.
        spans: from when to when they are missing [s]; () where nobody knows, as of rows on change.
    """

    channel: str
    rows: int
    of: int | None
    spans: tuple[Span, ...]


def losses_of(
    recording: Recording, row_times: Mapping[str, RowTimes], period_s: float, last_s: float
) -> tuple[Loss, ...]:
    """What each channel lacks, of those that lack anything.

    Args:
        recording: what there is.
        row_times: when there is.
        period_s: the control period [s].
        last_s: when the last row should be [s].
    """
    before = {} if recording.end is None else dict(recording.end.missing_rows)
    found = []
    channels = {channel.name: channel for channel in recording.channels}
    for name in dict.fromkeys([*channels, *recording.counts, *before]):
        times = row_times.get(name)
        count = 0 if times is None else times.rows
        known = name in recording.counts
        lost = before.get(name, 0) + recording.counts.get(name, count) - count
        spans: tuple[Span, ...] = ()
        if name not in channels:
            spans = ((0.0, last_s),)
        elif channels[name].every_tick and (times is not None or known):
            spans = (times or RowTimes(period_s)).spans_without_rows(last_s)
            if not known:
                lost = max(lost, sum(_rows_in(span, period_s, last_s) for span in spans))
        if lost > 0:
            found.append(Loss(name, lost, count + lost if known or name in before else None, spans))
    return tuple(found)


def told(losses: Sequence[Loss], every: Collection[str]) -> list[str]:
    """A line for each span of time and for each number of rows, those of channels that lack the same together.

    Args:
        losses: of a run.
        every: the names of those with a row at each control period.
    """
    alike: dict[tuple[tuple[Span, ...], int, int | None], list[str]] = {}
    for loss in losses:
        alike.setdefault((loss.spans, loss.rows, loss.of), []).append(loss.channel)
    lines = []
    for (spans, rows, of), lacking in alike.items():
        when = ", ".join(f"{start:g} s to {end:g} s" for start, end in spans)
        who = "every channel" if len(lacking) > 1 and set(every) <= set(lacking) else ", ".join(lacking)
        many = f"all {rows}" if rows == of else f"{rows} of {of}" if of is not None else f"{rows}"
        each = " each" if len(lacking) > 1 else ""
        lines.append(f"{when}: {many} rows{each} of {who}" if when else f"{many} rows{each} of {who}")
    return lines


def _rows_in(span: Span, period_s: float, last_s: float) -> int:
    start, end = span
    return round((end - start) / period_s) + (end == last_s)
