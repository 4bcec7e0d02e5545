"""Signals that prove themselves, block by block."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from cube_sim.checks.reasons import NotJudgedError, Reasons

Array = NDArray[np.float64]
Signals = Mapping[str, Array]


class Samples:
    """What is known of one signal after some blocks of its rows.

    Attributes:
        name: channel.field.
        width: numbers per sample; 0 where the rows are none.
        start: time of the first [s].
        end: time of the last [s].
    """

    def __init__(self, name: str) -> None:
        self.name, self.width = name, 0
        self.start = self.end = np.nan
        self._count, self._wrong, self._increase = 0, False, True
        self._steps: dict[float, int] = {}

    def take(self, rows: Array) -> bool:
        """Take in the next rows (n, 1 + width); whether there are any, of a sound shape."""
        if rows.ndim != 2 or rows.shape[1] < 2:
            self._wrong = True
        if self._wrong or not len(rows):
            return False
        times, before = rows[:, 0], self.end
        self.width, self.end = rows.shape[1] - 1, float(times[-1])
        if self._count:
            times = np.concatenate([[before], times])
        else:
            self.start = float(times[0])
        self._count += len(rows)
        steps, counts = np.unique(np.diff(times), return_counts=True)
        self._increase &= bool(np.all(np.isfinite(times)) and np.all(steps > 0))
        for step, count in zip(steps.tolist(), counts.tolist(), strict=True):
            self._steps[step] = self._steps.get(step, 0) + count
        return True

    def __len__(self) -> int:
        """How many samples there are."""
        return self._count

    @property
    def period(self) -> float:
        """The median of the times between two samples [s]."""
        steps = sorted(self._steps.items())
        ends = np.cumsum([count for _, count in steps])
        middle = np.searchsorted(ends, [(ends[-1] - 1) // 2, ends[-1] // 2], side="right")
        return (steps[middle[0]][0] + steps[middle[1]][0]) / 2.0

    def require(self, recorded: Collection[str]) -> None:
        """Hold it against the least that is asked of a signal of which a row holds until the next.

        Args:
            recorded: the names of all signals.

        Raises:
            NotJudgedError: there is no such signal, it has no samples, or their times do not increase.
        """
        if self.name not in recorded:
            near = difflib.get_close_matches(self.name, recorded, n=3, cutoff=0.6)
            known = ", ".join(near or sorted(recorded)) or "none"
            raise NotJudgedError(f"no signal {self.name}; {'nearest' if near else 'recorded'}: {known}")
        if self._wrong or not self._count:
            raise NotJudgedError(f"{self.name} holds no samples")
        if not self._increase:
            raise NotJudgedError(f"the times of {self.name} do not increase")

    def require_every_tick(self, recorded: Collection[str], duration_s: float | None, width: int | None = None) -> None:
        """Hold it against what is asked of a signal sampled from the start to the end of the run.

        Args:
            recorded: the names of all signals.
            duration_s: how long the run should have been; None if nothing is known of that.
            width: how many numbers a sample must have; None for any.

        Raises:
            NotJudgedError: it is no such signal.
        """
        self.require(recorded)
        if width is not None and self.width != width:
            raise NotJudgedError(f"{self.name} has {self.width} columns, needs {width}")
        if self._count < 2:
            raise NotJudgedError(f"{self.name} has one sample, needs two or more")
        # The last tick starts one period before the run ends.
        if duration_s is not None and self.end + 1.5 * self.period < duration_s:
            raise NotJudgedError(f"{self.name} ends at {self.end:g} s, the run should last {duration_s:g} s")


class Held:
    """The rows of an on-change signal in force at given times, block by block."""

    def __init__(self, samples: Samples, reasons: Reasons) -> None:
        """Begin.

        Args:
            samples: of the signal.
            reasons: gets one of the kind "held" where it does not hold at the first time.
        """
        self._samples, self._reasons = samples, reasons
        self._rows: Array | None = None
        self._start = np.nan

    def take(self, rows: Array, times: Array) -> Array | None:
        """The row in force at each of the times, without its own: (n, width).

        Args:
            rows: new ones of the signal, (k, 1 + width).
            times: (n,) [s], later than those asked for before.

        Returns:
            None where none is, which is a reason then.
        """
        if rows.ndim == 2 and len(rows):
            self._rows = rows if self._rows is None else np.concatenate([self._rows, rows])
            note_not_finite(self._reasons, self._samples.name, rows)
        if len(times) and np.isnan(self._start):
            self._start = times[0]
        if self._rows is not None and self._samples.start > self._start:
            text = f"{self._samples.name} starts at {self._samples.start:g} s, the run at {self._start:g} s"
            self._reasons.note("held", text)
        if not len(times) or self._rows is None:
            return None
        index = np.maximum(np.searchsorted(self._rows[:, 0], times, side="right") - 1, 0)
        found = self._rows[index, 1:]
        self._rows = self._rows[index[-1] :]
        return found

    def require(self, recorded: Collection[str]) -> None:
        """Hold it against what is asked of such a signal.

        Raises:
            NotJudgedError: it is no such signal.
        """
        self._samples.require(recorded)
        self._reasons.require_none("held")
        self._reasons.require_none(self._samples.name)


def note_not_finite(reasons: Reasons, name: str, rows: Array) -> bool:
    """Note, as a reason of the kind `name`, when a signal's rows are not finite first; whether they all are."""
    bad = ~np.isfinite(rows).all(axis=1)
    if bad.any():
        reasons.note(name, f"{name} is not finite at {rows[int(np.argmax(bad)), 0]:g} s")
    return not bad.any()


def taken_away(rows: Array, other: Array, names: tuple[str, str], reasons: Reasons) -> Array | None:
    """One signal less another, at the times of both: (n, 1 + width); None, and a reason "minus", where they do not fit.

    Args:
        rows: of the one.
        other: of the other, in the same span of time.
        names: of both.
        reasons: gets it.
    """
    if rows.shape != other.shape:
        if rows.ndim == other.ndim == 2 and rows.shape[1] == other.shape[1]:
            reasons.note("minus", f"{names[0]} and {names[1]} are not sampled at the same times")
        else:
            reasons.note("minus", f"{names[0]} and {names[1]} do not have the same columns")
        return None
    if not np.array_equal(rows[:, 0], other[:, 0]):
        reasons.note("minus", f"{names[0]} and {names[1]} are not sampled at the same times")
        return None
    with np.errstate(over="ignore", invalid="ignore"):  # what is no number is seen to be none
        return np.column_stack([rows[:, 0], rows[:, 1:] - other[:, 1:]])


def note_other_times(reasons: Reasons, **signals: Array) -> None:
    """Note, as a reason of the kind "times", that signals are not sampled at the same times."""
    (first_name, first), *others = signals.items()
    for name, rows in others:
        if first.ndim == rows.ndim == 2 and not np.array_equal(rows[:, 0], first[:, 0]):
            reasons.note("times", f"{first_name} and {name} are not sampled at the same times")
