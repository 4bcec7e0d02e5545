"""Messages about a path that is followed more slowly than asked, few enough to be read."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_conditions import SPEED_NOT_KEPT

PATIENCE_S = 2.0
"""A change is logged once it has lasted this long: a start or a gust is no news."""
STANDS_S = 2.0 * PATIENCE_S
"""One that stands is given so long to go on: it does once it has turned to where it has more, or has found none."""
SLOWER = 0.95
"""Share of the speed asked for below which the vehicle is said to be slower."""


class PaceLog:
    """Logs when the thrusters have not kept the speed along the path for a while, and when they have again.

    Args:
        recorder: gets the messages.
        speed_m_s: asked for along the path [m/s].
    """

    def __init__(self, recorder: SignalStore, speed_m_s: float) -> None:
        self._recorder, self._speed = recorder, speed_m_s
        self._logged, self._since = False, 0.0

    def quiet(self, paces: NDArray[np.float64]) -> bool:
        """Whether ticks of these shares (n,) of the speed are no news."""
        return bool(((paces < SLOWER) == self._logged).all())

    def note(self, t: float, pace: float) -> None:
        """Take in the share of the speed of one tick, at t [s]."""
        slower = pace < SLOWER
        if slower == self._logged:
            self._since = t
        elif t - self._since >= (STANDS_S if slower and pace <= 0.0 else PATIENCE_S):
            self._logged = slower
            if slower:
                asked, left = f"{self._speed:g} m/s along the path", f"{max(0.0, pace) * self._speed:.2g} m/s"
                text = f"{SPEED_NOT_KEPT.begins}{asked}: it goes on at {left}, to stay as near to it as it can"
                self._recorder.log(t, "WARNING", text)
            else:
                self._recorder.log(t, "INFO", SPEED_NOT_KEPT.ends)
