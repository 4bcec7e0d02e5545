"""Every statistic against plain numpy on whole signals, and the same bits however the rows come in blocks."""

from __future__ import annotations

import math
import tracemalloc
from typing import get_args

import numpy as np
import pytest
from pydantic import TypeAdapter
from support.random_signals import HELD, RUN_S, SAMPLED, in_random_blocks, random_signals

from cube_sim.checks import Beforehand, Evaluation, evaluate
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.scenario.statistic_keys import Statistic

LEVEL, BAND, PERCENT = 0.3, (-0.8, 0.9), 62.5
NEEDED = {
    "percentile": {"percent": PERCENT},
    "share_above": {"level": LEVEL},
    "share_below": {"level": LEVEL},
    "crossings": {"level": LEVEL},
    "share_within": {"band": BAND},
    "settling": {"band": BAND},
}
BEFOREHAND = Beforehand(held={HELD})


def of_samples(statistic, times, values, series, start_s):
    """By its formula, of samples inside the window: times (n,), values (n, width) and series (n,)."""
    inside = (series >= BAND[0]) & (series <= BAND[1])
    match statistic:
        case "rms":
            return math.sqrt(math.fsum(series**2) / len(series))
        case "mean":
            return math.fsum(series) / len(series)
        case "std":
            mean = math.fsum(series) / len(series)
            return math.sqrt(math.fsum((series - mean) ** 2) / len(series))
        case "max" | "min":
            return getattr(series, statistic)()
        case "max_abs" | "min_abs":
            return getattr(np.abs(series), statistic[:3])()
        case "final":
            return series[-1]
        case "increase":
            return series[-1] - series[0]
        case "percentile":
            return np.sort(series)[math.ceil(PERCENT * len(series) / 100) - 1]
        case "share_above":
            return np.count_nonzero(series > LEVEL) / len(series)
        case "share_below":
            return np.count_nonzero(series < LEVEL) / len(series)
        case "share_within":
            return np.count_nonzero(inside) / len(series)
        case "crossings":
            return np.count_nonzero(np.diff(series >= LEVEL))
        case "changes":
            return np.count_nonzero((np.diff(values, axis=0) != 0).any(axis=1))
        case "integral":
            return np.trapezoid(series, times)
        case "settling":
            if inside.all():
                return 0.0
            last_out = np.flatnonzero(~inside)[-1]
            return None if last_out + 1 == len(series) else times[last_out + 1] - start_s


def of_held(statistic, starts, ends, values, series, window):
    """By its formula, of spans that last."""
    lasting = ends - starts
    whole = lasting.sum()
    inside = (series >= BAND[0]) & (series <= BAND[1])
    match statistic:
        case "rms":
            return math.sqrt(math.fsum(series**2 * lasting) / whole)
        case "mean":
            return math.fsum(series * lasting) / whole
        case "std":
            mean = math.fsum(series * lasting) / whole
            return math.sqrt(math.fsum((series - mean) ** 2 * lasting) / whole)
        case "percentile":
            order = np.argsort(series)
            return series[order][np.searchsorted(np.cumsum(lasting[order]), PERCENT / 100 * whole)]
        case "share_above":
            return lasting[series > LEVEL].sum() / whole
        case "share_below":
            return lasting[series < LEVEL].sum() / whole
        case "share_within":
            return lasting[inside].sum() / whole
        case "integral":
            return math.fsum(series * lasting)
        case _:
            return of_samples(statistic, starts, values, series, window[0])


def reference(statistic, rows, window, component, combine, held):
    start, end = window
    if held:
        until = np.append(rows[1:, 0], np.inf)
        chosen = (rows[:, 0] <= end) & (until > start)
        starts, ends = np.maximum(rows[chosen, 0], start), np.minimum(until[chosen], end)
    else:
        chosen = (rows[:, 0] >= start) & (rows[:, 0] <= end)
        starts = rows[chosen, 0]
    values = rows[chosen, 1:] if component is None else rows[chosen, 1 + component][:, None]
    if values.shape[1] == 1:
        series = values[:, 0]
    else:
        series = values.sum(axis=1) if combine == "sum" else np.sqrt((values**2).sum(axis=1))
    if held:
        return of_held(statistic, starts, ends, values, series, window)
    return of_samples(statistic, starts, values, series, window[0])


STATISTICS = tuple(get_args(Statistic))


@pytest.mark.parametrize("name", [SAMPLED, HELD])
@pytest.mark.parametrize("statistic", STATISTICS)
def test_a_statistic_is_its_formula_and_the_same_to_the_bit_in_any_blocks(statistic, name):
    told = 0
    for seed in range(40):
        rng = np.random.default_rng([seed, STATISTICS.index(statistic)])
        signals = random_signals(rng)
        width = signals[name].shape[1] - 1
        component = int(rng.integers(width)) if rng.random() < 0.4 else None
        combine = "sum" if component is None and rng.random() < 0.4 else "norm"
        start = float(rng.uniform(0.0, RUN_S - 0.3))
        end = float(rng.uniform(start + 0.2, RUN_S))
        window = (start, end) if rng.random() < 0.7 else (0.0, RUN_S)
        asked = {"kind": "signal", "signal": name, "statistic": statistic, "component": component, "combine": combine}
        keys = {} if window == (0.0, RUN_S) else {"from_s": start, "to_s": end}
        limit = 0.99 if statistic.startswith("share_") else 1.5
        check = TypeAdapter(AnyCheck).validate_python(asked | NEEDED.get(statistic, {}) | keys | {"at_most": limit})
        (result,) = evaluate([check], signals, duration_s=RUN_S, beforehand=BEFOREHAND)
        for _ in range(3):
            blocks = in_random_blocks(signals, rng)
            assert evaluate([check], blocks, duration_s=RUN_S, beforehand=BEFOREHAND) == (result,)
        expected = reference(statistic, signals[name], window, component, combine, name == HELD)
        if expected is None:  # it has not settled: longer than the window, if that is enough to say so
            assert result.verdict == ("FAIL" if window[1] - window[0] > 1.5 else "ERROR")
            continue
        assert result.value == pytest.approx(expected, rel=1e-11, abs=1e-11), (seed, result)
        assert result.verdict == ("PASS" if result.value <= limit else "FAIL")
        assert result.margin == limit - result.value
        assert window[0] <= result.at_s <= window[1]
        told += 1
    assert told > 10


def test_an_on_change_signal_is_judged_as_held():
    """42 N for a tenth of the time are not a half of the rows."""
    rows = np.array([[0.0, 10.0], [9.0, 100.0]])
    clock = np.column_stack([np.arange(0.0, 10.01, 0.02), np.zeros((501, 3))])
    check = TypeAdapter(AnyCheck).validate_python(
        {"kind": "signal", "signal": "x.y", "statistic": "mean", "at_most": 20.0}
    )
    (result,) = evaluate(
        [check], {"x.y": rows, "pose.position": clock}, duration_s=10.0, beforehand=Beforehand(held={"x.y"})
    )
    assert result.value == pytest.approx(19.0)
    assert "each held until the next" in result.detail


def test_what_one_of_several_vehicles_holds_is_held_as_far_as_its_own_run_goes():
    rows = np.array([[0.0, 1.0], [6.0, 3.0]])
    clock = np.column_stack([np.arange(0.0, 8.01, 0.02), np.zeros((401, 3))])
    asked = {"signal": "leader/x.y", "at_most": 20.0}
    for check, value in (({"kind": "signal", "statistic": "mean"}, 1.5), ({"kind": "always"}, 3.0)):
        known = {"all": [asked]} if check["kind"] == "always" else asked
        (result,) = evaluate(
            [TypeAdapter(AnyCheck).validate_python(check | known)],
            {"leader/x.y": rows, "leader/pose.position": clock},
            beforehand=Beforehand(held={"leader/x.y"}),
        )
        assert result.value == pytest.approx(value)


def test_what_is_held_from_later_than_its_window_is_an_error():
    signals = {"x.y": np.array([[3.0, 1.0]]), "pose.position": np.column_stack([np.arange(11.0), np.zeros((11, 3))])}
    for from_s, verdict in ((2.0, "ERROR"), (3.0, "PASS"), (4.0, "PASS")):
        check = TypeAdapter(AnyCheck).validate_python(
            {"kind": "signal", "signal": "x.y", "statistic": "max", "at_most": 2.0, "from_s": from_s}
        )
        (result,) = evaluate([check], signals, duration_s=10.0, beforehand=Beforehand(held={"x.y"}))
        assert result.verdict == verdict, result.detail


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", [SAMPLED, HELD])
@pytest.mark.parametrize("statistic", STATISTICS)
def test_a_number_that_is_none_is_an_error_in_the_window_alone(statistic, name, bad):
    rng = np.random.default_rng(3)
    signals = random_signals(rng)
    index = len(signals[name]) // 2
    signals[name][index, 1] = bad
    at = float(signals[name][index, 0])
    after = float(signals[name][index + 1, 0])
    for window, verdict in (({"to_s": at + 1e-6}, "ERROR"), ({"from_s": after}, None)):
        asked = {"kind": "signal", "signal": name, "statistic": statistic}
        asked["at_most"] = 0.99 if statistic.startswith("share_") else 1e300
        check = TypeAdapter(AnyCheck).validate_python(asked | NEEDED.get(statistic, {}) | window)
        results = [
            evaluate([check], how, duration_s=RUN_S, beforehand=BEFOREHAND)[0]
            for how in (signals, in_random_blocks(signals, rng))
        ]
        if verdict == "ERROR":
            assert [each.verdict for each in results] == ["ERROR", "ERROR"]
            assert results[0].detail == results[1].detail == f"{name} is not finite at {at:g} s"
        else:
            assert results[0] == results[1]
            assert results[0].verdict == "PASS" or "not settled" in results[0].detail


def test_a_spread_far_from_zero_keeps_its_digits():
    """Squares less the square of the mean would leave none of them."""
    times = np.arange(0.0, 100.0, 0.02)
    rows = np.column_stack([times, 1e9 + np.where(np.arange(len(times)) % 2, 1e-3, -1e-3)])
    check = TypeAdapter(AnyCheck).validate_python(
        {"kind": "signal", "signal": "a.b", "statistic": "std", "at_most": 1.0}
    )
    (result,) = evaluate([check], {"a.b": rows})
    assert result.value == pytest.approx(np.std(rows[:, 1] - 1e9), rel=1e-6)


@pytest.mark.parametrize(("percent", "value"), [(7.0, 7.0), (95.0, 95.0), (99.9, 100.0), (100.0, 100.0), (0.1, 1.0)])
def test_a_percentile_is_one_of_the_samples(percent, value):
    """0.07 * 100 is not 7 in binary: its rank is."""
    rows = np.column_stack([np.arange(100.0), np.arange(1.0, 101.0)])
    check = TypeAdapter(AnyCheck).validate_python(
        {"kind": "signal", "signal": "a.b", "statistic": "percentile", "percent": percent, "at_most": 1e3}
    )
    (result,) = evaluate([check], {"a.b": rows})
    assert result.value == value


@pytest.mark.parametrize(
    ("asked", "unit"),
    [
        ({"signal": "power.motor", "statistic": "integral"}, "J"),
        ({"signal": "velocity.linear", "statistic": "integral"}, "m"),
        ({"signal": "pose.position", "statistic": "integral"}, "m s"),
        ({"signal": "pose.position", "statistic": "share_above", "level": 1.0}, "1"),
        ({"signal": "pose.position", "statistic": "changes"}, "1"),
        ({"signal": "pose.position", "statistic": "settling", "band": [0, 1]}, "s"),
        ({"signal": "wrench.demanded", "statistic": "std", "component": 4}, "N m"),
        ({"signal": "wrench.demanded", "statistic": "increase"}, "N, N m"),
    ],
)
def test_a_value_has_its_unit(asked, unit):
    from cube_sim.recording.channels import channel_table, units_of

    check = TypeAdapter(AnyCheck).validate_python({"kind": "signal", "at_most": 0.9, **asked})
    (result,) = evaluate([check], {}, units=units_of(channel_table(("T1", "T2"), 2)))
    assert result.unit == unit


@pytest.mark.parametrize("statistic", STATISTICS)
@pytest.mark.parametrize("name", [SAMPLED, HELD])
def test_a_longer_run_takes_no_more_memory(statistic, name):
    """But for a percentile, which keeps the numbers of its window, 8 bytes each, 16 where they are held."""
    limit = 0.99 if statistic.startswith("share_") else 1e9
    asked = {"kind": "signal", "signal": name, "statistic": statistic, "at_most": limit} | NEEDED.get(statistic, {})
    # Whatever else runs in this process, as what compiles beside it, takes memory once: not each of three times.
    more = min(_kept(asked, 20) - _kept(asked, 2) for _ in range(3))
    numbers = 18 * 3000 * (16 if name == HELD else 8)
    assert (numbers <= more < 1.1 * numbers) if statistic == "percentile" else more < 20_000


def _kept(asked, minutes):
    """What the evaluation of a check keeps [bytes], after so much of a run."""
    evaluation = Evaluation([TypeAdapter(AnyCheck).validate_python(asked)], BEFOREHAND)
    tracemalloc.start()
    for minute in range(minutes):
        times = 60.0 * minute + np.arange(3000) * 0.02
        rows = np.column_stack([times, np.sin(times)])
        evaluation.take({asked["signal"]: rows, "pose.position": rows})
    del times, rows
    kept = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    return kept
