"""Messages about demanded wrenches that stay unattainable, few enough to be read."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation import Status
from cube_sim.recording.signal_store import SignalStore

PATIENCE_S = 1.0
"""A status is logged once it has lasted this long: a demand at the edge of the attainable set changes it every tick."""


class UnattainableLog:
    """Logs when the demanded wrench has been unattainable for a while, and when it has been attainable for as long."""

    def __init__(self, recorder: SignalStore) -> None:
        self._recorder = recorder
        self._logged, self._since = Status.EXACT, 0.0

    def quiet(self, statuses: NDArray[np.float64]) -> bool:
        """Whether ticks of these statuses (n,) are no news."""
        return bool((statuses == self._logged).all())

    def note(self, t: float, status: Status) -> None:
        """Take in the status of one tick, at t [s]."""
        if status is self._logged:
            self._since = t
        elif status is Status.INVALID_WRENCH or t - self._since >= PATIENCE_S:
            level = {Status.EXACT: "INFO", Status.INVALID_WRENCH: "ERROR"}.get(status, "WARNING")
            self._recorder.log(t, level, status.message)
            self._logged, self._since = status, t
