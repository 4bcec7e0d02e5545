"""A simulated second of a run: the unit in which rows travel from the loop to the files."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import UnknownSignalError
from cube_sim.nearest import among
from cube_sim.recording.channels import Channel
from cube_sim.recording.run_end import RunEnd
from cube_sim.run_log import LogLine

Rows = NDArray[np.float64]  # (n, 1+width), column 0 the time [s]


@dataclass(frozen=True)
class Batch:
    """What was recorded in one simulated second, t in [k, k+1).

    Attributes:
        rows: new rows of each channel that has any, in the order of the channel table.
        log: new log lines.
    """

    rows: Mapping[str, Rows]
    log: Sequence[LogLine] = ()


class Sink(Protocol):
    """Something that takes a run batch by batch."""

    def write(self, batch: Batch) -> None:
        """Take the next batch."""
        ...

    def close(self) -> None:
        """Finish; nothing comes after."""
        ...


class View(Sink, Protocol):
    """A sink for people to look at, who want to know what became of the run."""

    def tell(self, end: RunEnd) -> None:
        """Show how the run ended; only `close` comes after."""
        ...


def batch_number(t: float) -> int:
    """Which batch an instant t [s] belongs to."""
    return math.floor(t)


def ticks_left_of_second(tick: int, period: float) -> int:
    """How many ticks, this one and those that follow, fall into the batch of this one.

    Args:
        tick: its number.
        period: of the ticks [s].
    """
    end = batch_number(tick * period) + 1
    last = max(tick, math.ceil(end / period) + 1)
    while last * period >= end:
        last -= 1
    return last - tick + 1


def split_into_batches(rows: Mapping[str, Rows], log: Sequence[LogLine]) -> Iterator[Batch]:
    """Cut whole columns into the batches in which they were recorded.

    Args:
        rows: all rows of each channel.
        log: all log lines.

    Yields:
        The batches that hold anything, in time order.
    """
    numbers = {name: np.floor(r[:, 0]).astype(np.int64) for name, r in rows.items()}
    logged = np.array([batch_number(line.t) for line in log], dtype=np.int64)
    for k in np.unique(np.concatenate([*numbers.values(), logged])):
        parts = {name: rows[name][slice(*np.searchsorted(n, (k, k + 1)))] for name, n in numbers.items()}
        first, last = np.searchsorted(logged, (k, k + 1))
        yield Batch({name: part for name, part in parts.items() if len(part)}, log[first:last])


V = TypeVar("V")


class BySignal(dict[str, V]):
    """What belongs to signals, by "channel.field"; a name that is none is told with the nearest that is one."""

    def __missing__(self, name: str) -> V:
        raise _unknown(name, self)


class SignalsOf(Mapping[str, Rows]):
    """Every field's column by "channel.field", made when it is asked for: few of a long run fit into memory twice.

    Args:
        channels: the channel table.
        rows: all rows of each channel.
    """

    def __init__(self, channels: Sequence[Channel], rows: Mapping[str, Rows]) -> None:
        self._rows, self._made = rows, dict[str, Rows]()
        self._places = {
            f"{channel.name}.{field.name}": (channel, columns)
            for channel in channels
            for field, columns in zip(channel.fields, channel.columns, strict=True)
        }

    def __getitem__(self, name: str) -> Rows:
        """One signal (n, 1+width), column 0 the time [s].

        Raises:
            UnknownSignalError: there is none of that name.
        """
        if name not in self._places:
            raise _unknown(name, self)
        if name not in self._made:
            channel, columns = self._places[name]
            whole = self._rows.get(channel.name, np.empty((0, 1 + channel.width)))
            self._made[name] = np.hstack([whole[:, :1], whole[:, columns]])
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        """Whether there is such a signal, without making it."""
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        """The names, in the order of the table."""
        return iter(self._places)

    def __len__(self) -> int:
        """How many there are."""
        return len(self._places)


def _unknown(name: str, known: Collection[str]) -> UnknownSignalError:
    near = get_close_matches(str(name), known, 1)
    hint = f"did you mean {near[0]}?" if near else f"there are {among(str(name), known)}"
    return UnknownSignalError(f"no signal {name!r}; {hint}")


def signals(channels: Sequence[Channel], rows: Mapping[str, Rows]) -> BySignal[Rows]:
    """Name every field's column.

    Args:
        channels: the channel table.
        rows: all rows of each channel.

    Returns:
        "channel.field" -> (n, 1+width), column 0 the time [s].
    """
    named = BySignal[Rows]()
    for channel in channels:
        whole = rows.get(channel.name, np.empty((0, 1 + channel.width)))
        for field, columns in zip(channel.fields, channel.columns, strict=True):
            named[f"{channel.name}.{field.name}"] = np.hstack([whole[:, :1], whole[:, columns]])
    return named
