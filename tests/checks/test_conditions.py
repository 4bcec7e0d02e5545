"""Conditions against their definition on whole signals; ratios and changes against the statistics they are made of."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError
from support.random_signals import CLOCK, HELD, PERIOD_S, RUN_S, SAMPLED, in_random_blocks, random_signals
from support.scenario_files import MINIMAL, mistakes, write

from cube_sim.checks import Beforehand, evaluate
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.scenario.event_blocks import CurrentEventBlock
from cube_sim.scenario.windows import TimeWindow, window_of

CURRENT = CurrentEventBlock(kind="current", name="tide", at_s=4.0, current_m_s=(0.1, 0.0, 0.0))
BEFOREHAND = Beforehand(events=(CURRENT,), held={HELD})


def block(**asked):
    return TypeAdapter(AnyCheck).validate_python(asked)


def judge(signals, rng=None, **asked):
    """By whole signals, and in blocks at random: the same."""
    check = block(**asked)
    (result,) = evaluate([check], signals, duration_s=RUN_S, beforehand=BEFOREHAND)
    for _ in range(3 if rng is not None else 0):
        again = evaluate([check], in_random_blocks(signals, rng), duration_s=RUN_S, beforehand=BEFOREHAND)
        assert again == (result,)
    return result


def at(rows, t):
    """The number in force at one instant, of a vector its norm; slow and plain."""
    values = rows[rows[:, 0] <= t][-1, 1:]
    return float(values[0] if len(values) == 1 else np.linalg.norm(values))


@pytest.mark.parametrize("kind", ["always", "eventually"])
@pytest.mark.parametrize("key", ["all", "any"])
@pytest.mark.parametrize("names", [(SAMPLED,), (HELD,), (SAMPLED, CLOCK), (SAMPLED, HELD), (HELD, HELD, SAMPLED)])
def test_a_condition_is_its_definition(kind, key, names):
    verdicts = set()
    for seed in range(25):
        rng = np.random.default_rng([seed, len(names)])
        signals = random_signals(rng)
        start, end = sorted(float(t) for t in rng.uniform(0.0, RUN_S, 2))
        parts = []
        for name in names:
            limit = {rng.choice(["at_most", "at_least"]): float(rng.uniform(0.0, 2.0))}
            parts.append({"signal": name, "scale": float(rng.uniform(0.5, 2.0)), **limit})
        result = judge(signals, rng, **{"kind": kind, key: parts, "from_s": start, "to_s": end})
        times = np.concatenate([signals[part["signal"]][:, 0] for part in parts])
        if HELD in names:
            times = np.append(times, start)
        times = np.unique(times[(times >= start) & (times <= end)])
        if not len(times):
            assert result.verdict == "ERROR"
            continue
        margins = np.array(
            [
                [
                    ((p["at_most"] - x) if "at_most" in p else (x - p["at_least"])) / p["scale"]
                    for p, x in ((p, at(signals[p["signal"]], t)) for p in parts)
                ]
                for t in times
            ]
        )
        each = margins.min(axis=1) if key == "all" else margins.max(axis=1)
        value = each.min() if kind == "always" else each.max()
        assert result.value == pytest.approx(value, abs=1e-12), seed
        assert (result.relation, result.limit, result.margin) == (">=", 0.0, result.value)
        assert result.verdict == ("PASS" if value >= 0 else "FAIL")
        verdicts.add(result.verdict)
    assert verdicts


@pytest.mark.parametrize(("limit", "key"), [(0.7, "at_most"), (0.7, "at_least")])
@pytest.mark.parametrize(("kind", "statistic"), [("always", {"at_most": "max", "at_least": "min"}),
                                                 ("eventually", {"at_most": "min", "at_least": "max"})])  # fmt: skip
def test_one_comparison_shows_the_signal_s_own_value(kind, statistic, limit, key):
    rng = np.random.default_rng(5)
    signals = random_signals(rng)
    part = {"signal": SAMPLED, key: limit}
    found = judge(signals, rng, kind=kind, all=[part], from_s=2.0)
    same = judge(signals, kind="signal", signal=SAMPLED, statistic=statistic[key], from_s=2.0, **{key: limit})
    assert (found.value, found.at_s, found.limit, found.relation, found.margin, found.verdict) == (
        (same.value, same.at_s, same.limit, same.relation, same.margin, same.verdict)
    )


def test_a_violation_of_one_sample_latches_and_its_first_time_is_told():
    times = np.arange(0.0, RUN_S, PERIOD_S)
    for tick in (0, 17, len(times) - 1):
        rows = np.column_stack([times, np.where(np.arange(len(times)) == tick, 2.0, 1.0)])
        result = judge({SAMPLED: rows}, kind="always", all=[{"signal": SAMPLED, "at_most": 1.5}])
        assert (result.verdict, result.at_s) == ("FAIL", times[tick])
        assert result.detail.endswith(f"first violated at {times[tick]:g} s")


def test_eventually_within_a_time_looks_no_further():
    times = np.arange(0.0, RUN_S + 0.01, PERIOD_S)
    signals = {SAMPLED: np.column_stack([times, times])}
    asked = {"kind": "eventually", "all": [{"signal": SAMPLED, "at_least": 5.0}], "from_s": 3.0}
    assert judge(signals, **asked, within_s=1.9).verdict == "FAIL"
    passed = judge(signals, **asked, within_s=2.1)
    assert (passed.verdict, passed.detail.endswith("first holds at 5 s")) == ("PASS", True)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_no_number_in_the_window_is_an_error(bad):
    signals = random_signals(np.random.default_rng(1))
    signals[SAMPLED][100, 1] = bad
    asked = {"kind": "eventually", "any": [{"signal": SAMPLED, "at_least": -1.0}, {"signal": CLOCK, "at_least": -1.0}]}
    assert judge(signals, **asked).detail == f"{SAMPLED} is not finite at 5 s"
    assert judge(signals, **asked, from_s=6.0).verdict == "PASS"


def test_a_signal_minus_another_is_judged_instant_by_instant():
    rng = np.random.default_rng(8)
    signals = random_signals(rng)
    other = signals[SAMPLED] + np.where(
        np.arange(signals[SAMPLED].shape[1]), rng.normal(size=signals[SAMPLED].shape), 0
    )
    signals["other.values"] = other
    apart = signals[SAMPLED][:, 1:] - other[:, 1:]
    distance = np.abs(apart[:, 0]) if apart.shape[1] == 1 else np.linalg.norm(apart, axis=1)
    of = {"signal": SAMPLED, "minus": "other.values"}
    for result in (
        judge(signals, rng, kind="signal", statistic="max_abs", at_most=1.0, **of),
        judge(signals, rng, kind="always", all=[{**of, "at_most": 1.0}]),
    ):
        assert result.value == pytest.approx(distance.max() if result.name[0] == "m" or apart.shape[1] > 1 else
                                             apart.max(), rel=1e-12)  # fmt: skip
    component = judge(signals, rng, kind="signal", statistic="mean", component=0, at_most=1.0, **of)
    assert component.value == pytest.approx(apart[:, 0].mean(), abs=1e-12)
    signals["other.values"] = other[::2]
    for asked in ({"kind": "signal", "statistic": "max", "at_most": 9.0, **of},
                  {"kind": "always", "all": [{**of, "at_most": 9.0}]}):  # fmt: skip
        result = judge(signals, rng, **asked)
        assert (result.verdict, "are not sampled at the same times" in result.detail) == ("ERROR", True)
    del signals["other.values"]
    assert "no signal other.values" in judge(signals, kind="signal", statistic="max", at_most=9.0, **of).detail
    assert "no signal other.values" in judge(signals, kind="always", all=[{**of, "at_most": 9.0}]).detail


def test_a_ratio_is_of_two_statistics():
    rng = np.random.default_rng(2)
    signals = random_signals(rng)
    above = {"signal": SAMPLED, "statistic": "rms", "from_s": 1.0}
    below = {"signal": HELD, "statistic": "mean", "to_s": 7.0}
    result = judge(signals, rng, kind="ratio", numerator=above, denominator=below, at_most=1.0)
    values = [judge(signals, kind="signal", at_most=1.0, **each).value for each in (above, below)]
    assert result.value == values[0] / values[1]
    signals[HELD][:, 1:] = 0.0
    result = judge(signals, kind="ratio", numerator=above, denominator=below, at_most=1.0)
    assert (result.verdict, "over 0 is no number" in result.detail) == ("ERROR", True)


@pytest.mark.parametrize("compare", ["difference", "ratio"])
@pytest.mark.parametrize("name", [SAMPLED, HELD])
def test_before_and_after_an_event(compare, name):
    rng = np.random.default_rng(3)
    signals = random_signals(rng)
    asked = {"signal": name, "statistic": "rms"}
    spans = {"before_s": 2.0, "after_s": 3.0, "delay_s": 0.5}
    result = judge(signals, rng, kind="before_after", event=0, compare=compare, at_most=1.0, **asked, **spans)
    before = judge(signals, kind="signal", at_most=1.0, from_s=2.0, to_s=float(np.nextafter(4.0, 0.0)), **asked).value
    after = judge(signals, kind="signal", at_most=1.0, from_s=4.5, to_s=7.5, **asked).value
    assert result.value == (after - before if compare == "difference" else after / before)
    assert f"{before:g} before, {after:g} after" in result.detail


def test_a_window_counts_from_events():
    check = block(kind="signal", signal="a.b", statistic="max", at_most=1.0, from_event=0, from_s=-1.5, to_event=0)
    assert window_of(check, (CURRENT,)) == TimeWindow(2.5, 4.0)
    named = check.model_copy(update={"from_event": "tide", "to_event": "tide"})
    assert window_of(named, (CURRENT,)) == TimeWindow(2.5, 4.0)
    with pytest.raises(ValueError, match="no event 'gust'"):
        window_of(check.model_copy(update={"to_event": "gust"}), (CURRENT,))


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"kind": "always"}, "give exactly one list of comparisons: all or any"),
        ({"kind": "always", "all": [{"signal": "a.b"}]}, "give exactly one limit"),
        ({"kind": "always", "all": [{"signal": "a.b", "at_most": 1, "scale": 1}, {"signal": "a.b", "at_most": 1}]},
         "give every comparison a scale, or none"),
        ({"kind": "eventually", "all": [{"signal": "a.b", "at_most": 1}], "within_s": 1, "to_s": 4},
         "leave out to_s and to_event"),
        ({"kind": "signal", "signal": "a.b", "statistic": "percentile", "at_most": 1},
         "percentile needs the key percent"),
        ({"kind": "signal", "signal": "a.b", "statistic": "max", "at_most": 1, "band": [0, 1]},
         "max takes no band; share_within, settling do"),
        ({"kind": "signal", "signal": "a.b", "statistic": "settling", "at_most": 1, "band": [1, 0]},
         r"must be \[lowest, highest\], got \[1.0, 0.0\]"),
        ({"kind": "signal", "signal": "a.b", "statistic": "rms", "at_most": -1}, "rms is never negative"),
        ({"kind": "signal", "signal": "a.b", "statistic": "share_above", "level": 1, "at_least": 1.1},
         "share_above is 1 at most"),
        ({"kind": "signal", "signal": "a.b", "statistic": "max", "at_most": 1, "component": 0, "combine": "sum"},
         "one component has nothing to combine"),
        ({"kind": "signal", "signal": "a.b", "statistic": "max", "at_most": 1, "from_s": -1}, "must be at least 0"),
        ({"kind": "signal", "signal": "a.b", "statistic": "max", "at_most": 1, "from_event": -1},
         "must be the name of an event, or its number"),
        ({"kind": "signal", "signal": "a.b", "statistic": "max", "at_most": 1, "from_event": True},
         "must be the name of an event, or its number"),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(asked, said):
    with pytest.raises(ValidationError, match=said):
        block(**asked)


def test_a_condition_within_a_condition_is_refused_in_one_line(tmp_path):
    inner = "any: [{signal: pose.position, at_most: 1}, {signal: velocity.linear, at_most: 1}]"
    check = f"{{kind: always, all: [{{{inner}}}, {{signal: velocity.linear, at_most: 1}}]}}"
    (line,) = mistakes(write(tmp_path, MINIMAL.replace("{kind: path_end, reach_m: 0.5}", check)))
    assert line.startswith(
        "mission.yaml:8:32: checks.0.all.0.any: a condition within a condition: several of `all` are"
    )
