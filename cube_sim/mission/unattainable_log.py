"""Sentences about wrenches out of reach, few enough to be read."""

from __future__ import annotations

from cube_sim.allocation import Status
from cube_sim.recording.recorder import Recorder

PATIENCE_S = 1.0
"""Only what lasts this long is told: a demand that grazes the edge of reach comes and goes from tick to tick."""


class ReachLog:
    """Tells when the demanded wrench has been out of reach for a while, and when it has been back for as long."""

    def __init__(self, recorder: Recorder) -> None:
        self._recorder = recorder
        self._told, self._since = Status.EXACT, 0.0

    def note(self, t: float, status: Status) -> None:
        """Take in one tick, at t [s]."""
        if status is self._told:
            self._since = t
        elif status is Status.INVALID_WRENCH or t - self._since >= PATIENCE_S:
            level = {Status.EXACT: "INFO", Status.INVALID_WRENCH: "ERROR"}.get(status, "WARNING")
            self._recorder.log(t, level, status.message)
            self._told, self._since = status, t
