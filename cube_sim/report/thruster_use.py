"""What each thruster was asked for: off, reverse, forward, or at a limit, and for how long."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cube_sim.recording.batch import Rows
from cube_sim.report.decimation import Values, held

OFF, REVERSE, FORWARD, LOST, LOWER, UPPER = range(6)
"""What a thruster does at a tick; the more it matters to a reader, the larger."""
UNKNOWN = -1
"""What it does where nothing is recorded."""

STATES = ("off", "reverse", "forward", "believed dead", "at its lower limit", "at its upper limit")

NEAR = 0.95
"""A thruster is near a limit while it is asked for so large a share of it on average (choice)."""
NEAR_OVER_S = 5.0
"""Over so long a time is averaged: what a gust or a curve asks for is no news (choice)."""

_AT_LIMIT = 1e-3
"""A force this near to a limit, as a share of it, counts as at the limit (choice)."""


@dataclass(frozen=True)
class ThrusterUse:
    """One thruster over a run.

    Attributes:
        name: of the thruster.
        times: (n,) ticks [s].
        force: (n,) force asked for [N].
        limits: (k, 5) time [s], F_max-, F_DZ-, F_DZ+, F_max+ as believed [N]; a row holds until the next.
        state: (n,) one of `STATES` at each tick, by its number; -1 where nothing is recorded.
        period_s: time a tick stands for [s].
        energy_J: electrical energy drawn [J]; NaN where it is not known.
    """

    name: str
    times: Values
    force: Values
    limits: Rows
    state: NDArray[np.int8]
    period_s: float
    energy_J: float  # noqa: N815 - J is the joule

    def time_in(self, *states: int) -> float:
        """How long it was in one of these states [s]."""
        return float(np.isin(self.state, states).sum()) * self.period_s

    def spans(self, *states: int) -> list[tuple[float, float]]:
        """From when to when it was in one of these states [s], in the order of time."""
        inside = np.concatenate([[False], np.isin(self.state, states), [False]])
        edges = np.flatnonzero(np.diff(inside)).reshape(-1, 2)
        return [(float(self.times[a]), float(self.times[b - 1]) + self.period_s) for a, b in edges.tolist()]

    @cached_property
    def shares(self) -> Values:
        """(n,) mean share of its limit that was asked for in the `NEAR_OVER_S` before; NaN before so much has passed.

        Of the limit on the side of the force; NaN where one of the forces is not recorded or that limit is 0.
        """
        limits = held(self.limits, self.times)
        limit = np.where(self.force < 0, limits[:, 0], limits[:, 3])
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(self.force == 0, 0.0, self.force / limit)
        n = round(NEAR_OVER_S / self.period_s) if self.period_s > 0 else len(share) + 1
        mean = np.full(len(share), np.nan)
        if n <= len(share):
            mean[n - 1 :] = np.convolve(share, np.full(n, 1.0 / n), "valid")
        return np.where(np.isfinite(mean), mean, np.nan)

    def near_since(self, t: float) -> tuple[float, float, bool] | None:
        """Since when it has been near a limit at a time [s]; its mean share of it since then, and whether the upper."""
        last = int(np.searchsorted(self.times, t + 1e-9, side="right")) - 1
        near = self.shares[: last + 1] >= NEAR
        if last < 0 or not near[last]:
            return None
        before = np.flatnonzero(~near)
        first = int(before[-1]) + 1 if len(before) else 0
        n = round(NEAR_OVER_S / self.period_s)
        start = max(first - n + 1, 0)
        share = float(np.mean(self.shares[first : last + 1]))
        return float(self.times[start]), share, bool(self.force[last] > 0)

    @property
    def reversals(self) -> int:
        """How often its force changed its sign, times at rest between left out."""
        signs = np.sign(self.force[np.isfinite(self.force) & (self.force != 0)])
        return int(np.count_nonzero(np.diff(signs)))


def thruster_uses(signals: Mapping[str, Rows], names: Sequence[str]) -> tuple[ThrusterUse, ...]:
    """Each thruster of a run; none where forces or limits are not recorded."""
    forces, limits = signals.get("thrusters.force_demanded"), signals.get("actuation.limits")
    if forces is None or limits is None or not len(forces) or not len(limits):
        return ()
    times = forces[:, 0]
    period_s = float(np.median(np.diff(times))) if len(times) > 1 else 0.0
    power = signals.get("power.motor")
    if power is not None and not np.any(power[:, 1:] > 0):
        power = None  # the model does not state it
    found = []
    for index, name in enumerate(names):
        force = forces[:, 1 + index]
        own = np.column_stack([limits[:, 0], limits[:, 1 + 4 * index : 5 + 4 * index]])
        energy_J = float("nan") if power is None else float(np.nansum(power[:, 1 + index])) * period_s
        found.append(ThrusterUse(name, times, force, own, _states(force, held(own, times)), period_s, energy_J))
    return tuple(found)


def _states(force: Values, limits: Values) -> NDArray[np.int8]:
    """Of forces (n,) by their limits (n, 4)."""
    lowest, highest = limits[:, 0], limits[:, 3]
    state = np.full(len(force), OFF, np.int8)
    state[force < 0] = REVERSE
    state[force > 0] = FORWARD
    state[(lowest < 0) & (force <= (1 - _AT_LIMIT) * lowest)] = LOWER
    state[(highest > 0) & (force >= (1 - _AT_LIMIT) * highest)] = UPPER
    state[(lowest >= 0) & (highest <= 0)] = LOST
    state[np.isnan(force)] = UNKNOWN
    return state
