"""Checks: pure functions of recorded signals.

A signal is an array (n, 1 + width) named ``channel.field``; column 0 is simulated time [s]. A check first
proves that it can be judged: its signals exist, cover the run, lie inside the window and are finite. What
cannot be judged is an ERROR, never a PASS.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from cube_sim.scenario.check_blocks import (
    AllowedForcesCheckBlock,
    AnyCheck,
    ExactWrenchCheckBlock,
    PathEndCheckBlock,
    SignalCheckBlock,
)
from cube_sim.verdict import CheckResult

Array = NDArray[np.float64]
Signals = Mapping[str, Array]

EXACT = 0
"""Value of allocation.status at a tick whose wrench is attainable."""


class _NotJudgedError(Exception):
    """A check cannot be judged; the text says why."""


def evaluate(
    checks: Sequence[AnyCheck], signals: Signals, *, duration_s: float | None = None
) -> tuple[CheckResult, ...]:
    """Judge every check.

    Args:
        checks: the scenario's checks.
        signals: ``channel.field`` -> array (n, 1 + width), column 0 time [s], increasing.
        duration_s: how long the run should have been; a recording that ends earlier is judged by no check.

    Returns:
        One result per check, in order.
    """
    return tuple(_evaluate(check, _Recorded(signals, duration_s)) for check in checks)


def _evaluate(check: AnyCheck, recorded: _Recorded) -> CheckResult:
    try:
        match check:
            case SignalCheckBlock():
                return _signal(check, recorded)
            case AllowedForcesCheckBlock():
                return _allowed_forces(check, recorded)
            case ExactWrenchCheckBlock():
                return _exact_wrench(check, recorded)
            case PathEndCheckBlock():
                return _path_end(check, recorded)
            case _:
                assert_never(check)
    except _NotJudgedError as reason:
        relation, limit = check.bound
        return CheckResult(check.title, "ERROR", None, relation, limit, None, None, str(reason))


def _judge(check: AnyCheck, value: float, at_s: float, detail: str) -> CheckResult:
    if not np.isfinite(value):
        raise _NotJudgedError(f"the value is not finite ({detail})")
    relation, limit = check.bound
    at_least = relation == ">="
    value, at_s = float(value), float(at_s)
    margin = value - limit if at_least else limit - value
    # Spelled so that anything that does not compare fails.
    failed = not (value >= limit) if at_least else not (value <= limit)
    return CheckResult(check.title, "FAIL" if failed else "PASS", value, relation, limit, margin, at_s, detail)


class _Recorded:
    """Signals that prove themselves when asked for."""

    def __init__(self, signals: Signals, duration_s: float | None) -> None:
        self._signals, self._duration_s = signals, duration_s

    def on_change(self, name: str) -> Array:
        """A signal of which a row holds until the next."""
        rows = self._signals.get(name)
        if rows is None:
            near = difflib.get_close_matches(name, self._signals, n=3, cutoff=0.6)
            known = near or sorted(self._signals)
            raise _NotJudgedError(
                f"no signal {name}; {'nearest' if near else 'recorded'}: {', '.join(known) or 'none'}"
            )
        if rows.ndim != 2 or rows.shape[1] < 2 or len(rows) == 0:
            raise _NotJudgedError(f"{name} holds no samples")
        times = rows[:, 0]
        if not np.all(np.isfinite(times)) or np.any(np.diff(times) <= 0):
            raise _NotJudgedError(f"the times of {name} do not increase")
        return rows

    def every_tick(self, name: str, width: int | None = None) -> Array:
        """A signal sampled from the start to the end of the run."""
        rows = self.on_change(name)
        if width is not None and rows.shape[1] != 1 + width:
            raise _NotJudgedError(f"{name} has {rows.shape[1] - 1} columns, needs {width}")
        if len(rows) < 2:
            raise _NotJudgedError(f"{name} has one sample, needs two or more")
        end, period = rows[-1, 0], _period(rows)
        # The last tick starts one period before the run ends.
        if self._duration_s is not None and end + 1.5 * period < self._duration_s:
            raise _NotJudgedError(f"{name} ends at {end:g} s, the run should last {self._duration_s:g} s")
        return rows

    def held(self, name: str, times: Array) -> Array:
        """The row of an on-change signal in force at each time, without its own time: (n, width)."""
        rows = self.on_change(name)
        index = np.searchsorted(rows[:, 0], times, side="right") - 1
        if index[0] < 0:
            raise _NotJudgedError(f"{name} starts at {rows[0, 0]:g} s, the run at {times[0]:g} s")
        _require_finite(name, rows)
        return rows[index, 1:]


def _period(rows: Array) -> float:
    return float(np.median(np.diff(rows[:, 0])))


def _require_finite(name: str, rows: Array) -> None:
    bad = ~np.isfinite(rows).all(axis=1)
    if bad.any():
        raise _NotJudgedError(f"{name} is not finite at {rows[int(np.argmax(bad)), 0]:g} s")


def _same_times(**signals: Array) -> None:
    (first_name, first), *others = signals.items()
    for name, rows in others:
        if not np.array_equal(rows[:, 0], first[:, 0]):
            raise _NotJudgedError(f"{first_name} and {name} are not sampled at the same times")


def _signal(check: SignalCheckBlock, recorded: _Recorded) -> CheckResult:
    rows = _window(check, recorded.every_tick(check.signal))
    _require_finite(check.signal, rows)
    times, values = rows[:, 0], rows[:, 1:]
    if check.component is not None:
        if check.component >= values.shape[1]:
            raise _NotJudgedError(f"{check.signal} has {values.shape[1]} columns, no component {check.component}")
        series = values[:, check.component]
    else:
        series = values[:, 0] if values.shape[1] == 1 else np.linalg.norm(values, axis=1)
    with np.errstate(over="ignore"):
        value, worst = _statistic(check, series)
    detail = f"{len(times)} samples of {check.signal}, {times[0]:g} s to {times[-1]:g} s"
    return _judge(check, value, times[worst], detail)


def _window(check: SignalCheckBlock, rows: Array) -> Array:
    start, end = rows[0, 0], rows[-1, 0]
    from_s = start if check.from_s is None else check.from_s
    to_s = end if check.to_s is None else check.to_s
    window = f"window {from_s:g} s to {'the end' if check.to_s is None else f'{to_s:g} s'}"
    # Samples stand for the period around them: a window may stick out by one.
    slack = 1.5 * _period(rows)
    if not (start - slack <= from_s <= end + slack and start - slack <= to_s <= end + slack):
        raise _NotJudgedError(f"{window} is outside the run, {start:g} s to {end:g} s")
    times = rows[:, 0]
    inside = rows[(times >= from_s) & (times <= to_s)]
    needed = 1 if check.statistic == "final" else 2
    if len(inside) < needed:
        raise _NotJudgedError(f"{window} holds {len(inside)} samples, needs {needed}")
    return inside


def _statistic(check: SignalCheckBlock, series: Array) -> tuple[float, int]:
    """Value of the statistic, and the sample that speaks most against the check."""
    against = series if check.at_most is not None else -series
    match check.statistic:
        case "rms":
            size = np.abs(series)
            return float(np.sqrt(np.mean(series**2))), int(
                np.argmax(size) if check.at_most is not None else np.argmin(size)
            )
        case "mean":
            return float(np.mean(series)), int(np.argmax(against))
        case "max":
            return float(np.max(series)), int(np.argmax(series))
        case "min":
            return float(np.min(series)), int(np.argmin(series))
        case "max_abs":
            return float(np.max(np.abs(series))), int(np.argmax(np.abs(series)))
        case "final":
            return float(series[-1]), len(series) - 1
        case _:
            assert_never(check.statistic)


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


def _allowed_forces(check: AllowedForcesCheckBlock, recorded: _Recorded) -> CheckResult:
    rows = recorded.every_tick("thrusters.force_demanded")
    _require_finite("thrusters.force_demanded", rows)
    force = rows[:, 1:]
    limits = recorded.held("actuation.limits", rows[:, 0])
    if limits.shape[1] != 4 * force.shape[1]:
        raise _NotJudgedError(f"actuation.limits has {limits.shape[1]} columns, {force.shape[1]} thrusters need 4 each")
    limits = limits.reshape(len(rows), -1, 4)
    if np.any(np.diff(limits, axis=2) < 0):
        raise _NotJudgedError("actuation.limits are not in the order F_max-, F_DZ-, F_DZ+, F_max+")
    allow_off = check.allow_off is not False
    distance = distance_to_allowed(force, limits, allow_off)
    tick, thruster = np.unravel_index(int(np.argmax(distance)), distance.shape)
    detail = f"{distance.size} forces of {force.shape[1]} thrusters"
    if distance[tick, thruster] > 0:
        low, dead_low, dead_high, high = limits[tick, thruster]
        allowed = f"[{low:g}, {dead_low:g}] u {'{0} u ' if allow_off else ''}[{dead_high:g}, {high:g}] N"
        detail += f"; worst: thruster {thruster + 1} asked for {force[tick, thruster]:g} N, allowed {allowed}"
    return _judge(check, distance[tick, thruster], rows[tick, 0], detail)


def _exact_wrench(check: ExactWrenchCheckBlock, recorded: _Recorded) -> CheckResult:
    force = recorded.every_tick("thrusters.force_demanded")
    wrench = recorded.every_tick("wrench.demanded", 6)
    status = recorded.every_tick("allocation.status", 1)
    _same_times(force=force, wrench=wrench, status=status)
    _require_finite("allocation.status", status)
    attainable = status[:, 1] == EXACT
    if not attainable.any():
        raise _NotJudgedError(f"no wrench of {len(status)} was attainable")
    _require_finite("thrusters.force_demanded", force[attainable])
    _require_finite("wrench.demanded", wrench[attainable])
    times, m = force[attainable, 0], force.shape[1] - 1
    matrix = recorded.held("actuation.matrix", times)
    if matrix.shape[1] != 6 * m:
        raise _NotJudgedError(f"actuation.matrix has {matrix.shape[1]} columns, {m} thrusters need {6 * m}")
    A = matrix.reshape(len(times), 6, m)
    achieved = np.einsum("nij,nj->ni", A, force[attainable, 1:])
    error = np.linalg.norm(achieved - wrench[attainable, 1:], axis=1)
    worst = int(np.argmax(error))
    return _judge(check, error[worst], times[worst], f"attainable at {len(times)} of {len(status)} ticks")


def _path_end(check: PathEndCheckBlock, recorded: _Recorded) -> CheckResult:
    names = ("target.remaining", "target.position", "pose.position")
    remaining, target, vehicle = (
        recorded.every_tick(name, width) for name, width in zip(names, (1, 3, 3), strict=True)
    )
    _same_times(remaining=remaining, target=target, vehicle=vehicle)
    for name, rows in zip(names, (remaining, target, vehicle), strict=True):
        _require_finite(name, rows)
    # An arc is never shorter than its chord, so this bounds the distance to the end from above.
    distance = np.linalg.norm(vehicle[:, 1:] - target[:, 1:], axis=1) + np.abs(remaining[:, 1])
    nearest = int(np.argmin(distance))
    detail = f"nearest to the end with {remaining[nearest, 1]:.3g} m of path left to the target"
    return _judge(check, distance[nearest], remaining[nearest, 0], detail)
