"""Rows of one channel on their way to the files: preallocated, copied into, handed on by the batch.

A second's rows that come at once are handed on as they are.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import Channel

_FIRST_CAPACITY = 64  # rows; a simulated second at 50 Hz fits


class ChannelBuffer:
    """Collects the rows of one channel until they are taken."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._count = 0
        self._whole: Rows | None = None
        self._allocate(_FIRST_CAPACITY if channel.rate else 1)

    def append(self, t: float, values: tuple[ArrayLike, ...]) -> None:
        """Copy one row.

        Args:
            t: simulated time [s].
            values: one per field in the order of the table: a float for one number without a name of its own, else
                an array (width,).

        Raises:
            RecordingError: the values do not fit the fields. Shapes are looked at in the first row of each
                batch, the number of values always.
        """
        self._take_in()
        count = self._count
        if count == 0:
            self._check(values)
        elif count == len(self._times):
            self._allocate(2 * count)
        self._times[count] = t
        try:
            for view, value in zip(self._views, values, strict=True):
                view[count] = value
        except ValueError:
            self._check(values)
            raise
        self._count = count + 1

    def extend(self, rows: Rows, ours: bool = False) -> None:
        """Copy rows (n, 1+width), column 0 the time.

        Args:
            rows: the rows.
            ours: whether nobody else writes into them any more, so that they need not be copied.

        Raises:
            RecordingError: they have another width.
        """
        if rows.shape[1:] != self._rows.shape[1:]:
            width = self._rows.shape[1]
            raise RecordingError(f"channel {self._channel.name!r} takes rows of {width} numbers, not {rows.shape}")
        self._take_in()
        if ours and self._count == 0:
            self._whole = rows
            return
        end = self._count + len(rows)
        if end > len(self._times):
            self._allocate(max(2 * self._count, end))
        self._rows[self._count : end] = rows
        self._count = end

    def __len__(self) -> int:
        """How many rows have been collected so far."""
        return self._count if self._whole is None else len(self._whole)

    @property
    def rows(self) -> Rows:
        """The rows collected so far, (n, 1+width), still here."""
        return self._rows[: self._count].copy() if self._whole is None else self._whole

    def take(self) -> Rows:
        """Hand over the rows collected so far, (n, 1+width), and start anew."""
        rows = self.rows
        self._count, self._whole = 0, None
        return rows

    def _take_in(self) -> None:
        """Copy rows that were not when they came."""
        if self._whole is not None:
            rows, self._whole = self._whole, None
            self.extend(rows)

    def _allocate(self, capacity: int) -> None:
        rows = np.empty((capacity, 1 + self._channel.width))
        if self._count:
            rows[: self._count] = self._rows[: self._count]
        self._rows = rows
        self._times = rows[:, 0]
        # A single number is a 1-D view, so that a float is one assignment and not a broadcast.
        self._views = tuple(
            rows[:, columns.start] if field.is_single_number else rows[:, columns]
            for field, columns in zip(self._channel.fields, self._channel.columns, strict=True)
        )

    def _check(self, values: tuple[ArrayLike, ...]) -> None:
        shapes = [np.shape(value) for value in values]
        wanted = [() if field.is_single_number else (field.width,) for field in self._channel.fields]
        if shapes != wanted:
            fields = ", ".join(f"{field.name}({field.width})" for field in self._channel.fields)
            raise RecordingError(
                f"channel {self._channel.name!r} takes {fields}; it was given values of shapes {shapes}"
            )
