"""Two runs: what they were made of, and signal by signal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from json import dumps
from math import inf
from typing import Any

import numpy as np

from cube_sim.recording.batch import Rows
from cube_sim.recording.header import RunHeader

Signals = Mapping[str, Rows]


@dataclass(frozen=True)
class SignalDifference:
    """That a signal is not the same in two runs, within its tolerance.

    Attributes:
        signal: its name.
        text: what differs, where it is no number: that it is missing in one, or has other times.
        first_s: time of the first row that differs by more than the tolerance [s]; None where it is no number.
        largest: largest difference of a number, in the signal's unit; infinite where one is no number and the other is.
        largest_s: its time [s].
        rows: how many rows differ by more than the tolerance.
    """

    signal: str
    text: str = ""
    first_s: float | None = None
    largest: float | None = None
    largest_s: float | None = None
    rows: int = 0

    def to_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON: an infinite difference is null."""
        return {**vars(self), "largest": None if self.largest == inf else self.largest}


@dataclass(frozen=True)
class InputDifference:
    """That two runs are not made of the same.

    Attributes:
        key: dotted path of a scenario's value, or the name of a file.
        one: of the first run: the value as JSON, or the SHA-256 of the file; "" where it has none.
        other: of the second.
    """

    key: str
    one: str
    other: str


def other_settings(one: Mapping[str, Any], other: Mapping[str, Any]) -> list[InputDifference]:
    """Values of two scenarios that are not the same, in the order of the first.

    Args:
        one: every default written out, plain data.
        other: likewise.
    """
    return list(_other_values("", one, other))


def other_files(one: RunHeader, other: RunHeader) -> list[InputDifference]:
    """Files that are not the same, by their digests: model, what it includes, tables, Python of the user's own."""
    then, now = _digests(one), _digests(other)
    names = [name for name in dict.fromkeys([*then, *now]) if then.get(name) != now.get(name)]
    return [InputDifference(name, then.get(name, ""), now.get(name, "")) for name in names]


def _digests(header: RunHeader) -> dict[str, str]:
    files = {name: sha256(data).hexdigest() for name, data in header.inputs.items()}
    return files | {code.file: code.digest for code in header.code}


def _other_values(key: str, a: Any, b: Any) -> Iterator[InputDifference]:
    if isinstance(a, list) and isinstance(b, list):
        a, b = dict(enumerate(a)), dict(enumerate(b))
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        for name in dict.fromkeys([*a, *b]):
            below = f"{key}.{name}" if key else str(name)
            if name in a and name in b:
                yield from _other_values(below, a[name], b[name])
            else:
                yield InputDifference(below, *(_json(each[name]) if name in each else "" for each in (a, b)))
    elif a != b:
        yield InputDifference(key, _json(a), _json(b))


def _json(value: Any) -> str:
    return dumps(value, ensure_ascii=False, default=str)


def differences(
    one: Signals, other: Signals, tolerance: Callable[[str], float] = lambda _: 0.0
) -> Iterator[SignalDifference]:
    """Every signal that differs, in the order of the first run.

    Args:
        one: "channel.field" -> (n, 1+width), column 0 the time [s].
        other: likewise.
        tolerance: of a signal, in its unit; at 0 every bit has to be the same, but for the sign of 0 and kinds of NaN.
    """
    for name in [*one, *(name for name in other if name not in one)]:
        if name not in one or name not in other:
            yield SignalDifference(name, f"only in the {'first' if name in one else 'second'}")
            continue
        found = _difference(name, one[name], other[name], tolerance(name))
        if found is not None:
            yield found


def _difference(name: str, a: Rows, b: Rows, tolerance: float) -> SignalDifference | None:
    if a.shape[1] != b.shape[1]:
        return SignalDifference(name, f"{a.shape[1] - 1} numbers a row against {b.shape[1] - 1}")
    text = ""
    if len(a) != len(b) or not np.array_equal(a[:, 0], b[:, 0]):
        _, at_a, at_b = np.intersect1d(a[:, 0], b[:, 0], return_indices=True)
        text = f"{len(a)} rows against {len(b)}, of which {len(at_a)} at the same times"
        a, b = a[at_a], b[at_b]
    with np.errstate(invalid="ignore"):
        off = np.abs(a[:, 1:] - b[:, 1:])
    same = (a[:, 1:] == b[:, 1:]) | (np.isnan(a[:, 1:]) & np.isnan(b[:, 1:]))
    off = np.where(same, 0.0, np.where(np.isnan(off), np.inf, off)).max(axis=1, initial=0.0)
    beyond = np.flatnonzero(off > tolerance)
    if not len(beyond):
        return SignalDifference(name, text) if text else None
    most = int(np.argmax(off))
    return SignalDifference(name, text, float(a[beyond[0], 0]), float(off[most]), float(a[most, 0]), len(beyond))
