"""The check that forces lie in their allowed sets."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from cube_sim.checks.judging import Largest, judged
from cube_sim.checks.reasons import Reasons
from cube_sim.checks.samples import Array, Held, Samples, Signals, note_not_finite
from cube_sim.scenario.check_blocks import AllowedForcesCheckBlock
from cube_sim.verdict import CheckResult

FORCE, LIMITS = "thrusters.force_demanded", "actuation.limits"


def distance_to_allowed(force: Array, limits: Array, allow_off: bool) -> Array:
    """Distance of each thruster force to its allowed set.

    Args:
        force: (n, m) [N].
        limits: (n, m, 4) [N]: F_max-, F_DZ-, F_DZ+, F_max+ of each thruster.
        allow_off: whether 0 belongs to the set.

    Returns:
        (n, m) [N]: 0 inside [F_max-, F_DZ-] u [F_DZ+, F_max+], and at 0 if allowed.
    """
    lowest, dead_below, dead_above, highest = np.moveaxis(limits, -1, 0)
    to_reverse = np.maximum(np.maximum(lowest - force, force - dead_below), 0.0)
    to_forward = np.maximum(np.maximum(dead_above - force, force - highest), 0.0)
    distance = np.minimum(to_reverse, to_forward)
    return np.minimum(distance, np.abs(force)) if allow_off else distance


class ForcesWithinLimits:
    """Judges an `AllowedForcesCheckBlock`."""

    needs: tuple[str, ...] = FORCE, LIMITS

    def __init__(self, check: AllowedForcesCheckBlock) -> None:
        self._check, self._reasons = check, Reasons()
        self._force, self._limits = Samples(FORCE), Samples(LIMITS)
        self._held = Held(self._limits, self._reasons)
        self._worst, self._said = Largest(), ""
        self._allow_off = check.allow_off is not False

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        none = np.empty((0, 2))
        rows, changed = block.get(FORCE, none), block.get(LIMITS, none)
        self._limits.take(changed)
        if not self._force.take(rows):
            rows = none
        limits = self._held.take(changed, rows[:, 0])
        if limits is None or not note_not_finite(self._reasons, FORCE, rows):
            return
        times, force = rows[:, 0], rows[:, 1:]
        if limits.shape[1] != 4 * force.shape[1]:
            text = f"{LIMITS} has {limits.shape[1]} columns, {force.shape[1]} thrusters need 4 each"
            self._reasons.note("columns", text)
            return
        limits = limits.reshape(len(rows), -1, 4)
        if np.any(np.diff(limits, axis=2) < 0):
            self._reasons.note("order", f"{LIMITS} are not in the order F_max-, F_DZ-, F_DZ+, F_max+")
            return
        distance = distance_to_allowed(force, limits, self._allow_off)
        thruster = np.argmax(distance, axis=1)
        tick = self._worst.take(distance[np.arange(len(rows)), thruster], times)
        if tick is not None and self._worst.value > 0:
            i = int(thruster[tick])
            low, dead_low, dead_high, high = limits[tick, i]
            allowed = f"[{low:g}, {dead_low:g}] u {'{0} u ' if self._allow_off else ''}[{dead_high:g}, {high:g}] N"
            self._said = f"; worst: thruster {i + 1} asked for {force[tick, i]:g} N, allowed {allowed}"

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        self._force.require_every_tick(recorded, duration_s)
        self._reasons.require_none(FORCE)
        self._held.require(recorded)
        self._reasons.require_none("columns")
        self._reasons.require_none("order")
        m = self._force.width
        detail = f"{m * len(self._force)} forces of {m} thrusters{self._said}"
        return judged(self._check, self._worst.value, self._worst.at_s, detail)
