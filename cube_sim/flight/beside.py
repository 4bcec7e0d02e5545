"""A stretch of compiled ticks on a thread of its own: what they leave behind is dealt with while others are flown."""

from __future__ import annotations

import threading
from types import TracebackType

from cube_sim.flight.compiled import Stretch
from cube_sim.vehicle.plugin.warnings import collect_warnings

LOOK_S = 3e-4
"""So often somebody looks how far a flight has come; a simulated second takes some milliseconds."""


class FlyingBeside:
    """Flies a stretch from when it is entered on; it is flown, or stopped, when it is left.

    Args:
        stretch: to be flown.

    Attributes:
        warnings: of MuJoCo, in it.
    """

    def __init__(self, stretch: Stretch) -> None:
        self.warnings: list[str] = []
        self._stretch, self._error = stretch, None
        # Nobody waits for it at the end of the process.
        self._thread = threading.Thread(target=self._fly, name="flying", daemon=True)

    def _fly(self) -> None:
        try:
            with collect_warnings() as warnings:
                self._stretch.fly()
                self.warnings += warnings
        except BaseException as error:
            self._error = error

    def look(self) -> tuple[int, bool]:
        """How many ticks are flown, a little later; and whether these are all."""
        self._thread.join(LOOK_S)
        if self._thread.is_alive():
            return self._stretch.so_far, False
        if self._error is not None:
            raise self._error
        return self._stretch.ticks, True

    def __enter__(self) -> FlyingBeside:
        """Take off."""
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Land, whatever happened."""
        self._stretch.stop()
        self._thread.join()
