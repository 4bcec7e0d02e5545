"""Checks against closed forms and brute force; and nothing that cannot be judged passes."""

from __future__ import annotations

import itertools
import json

import numpy as np
import pytest
from pydantic import TypeAdapter

from cube_sim.checks import distance_to_allowed, evaluate
from cube_sim.run_log import LogLine
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.verdict import CheckResult, EarlyEnd, Flown, overall, to_json

DT = 0.02
RUN_S = 20.0
TIMES = np.arange(0.0, RUN_S + DT / 2, DT)


def series(*columns) -> np.ndarray:
    """A recorded signal from one array (or number) per column."""
    return np.column_stack([TIMES, *(np.broadcast_to(column, TIMES.shape) for column in columns)]).astype(float)


class InBlocks(dict):
    """The same signals as they come of a long run: span of time after span of time, some of them of one sample."""

    ends = 0.0, 0.02, 0.03, 4.99, 5.0, 9.98, 10.0, 10.019, 16.0, np.inf

    def blocks(self, names):
        for start, end in itertools.pairwise((-np.inf, *self.ends)):
            yield {name: self.part(self[name], start, end) for name in names}

    def part(self, rows, start, end):
        if rows.ndim == 2 and np.isfinite(rows[:, 0]).all() and (np.diff(rows[:, 0]) > 0).all():
            return rows[(rows[:, 0] > start) & (rows[:, 0] <= end)]
        k, n = self.ends.index(end), len(self.ends)
        return rows[k * len(rows) // n : (k + 1) * len(rows) // n]


def judge(signals, *, duration_s=None, **asked) -> CheckResult:
    """Judge by whole signals; by blocks of them the answer must be the same."""
    check = TypeAdapter(AnyCheck).validate_python(asked)
    (result,) = evaluate([check], signals, duration_s=duration_s)
    (again,) = evaluate([check], InBlocks(signals), duration_s=duration_s)
    assert again == result
    return result


def signal(signals, statistic, **asked) -> CheckResult:
    return judge(signals, kind="signal", signal="a.b", statistic=statistic, **asked)


# Statistics


def test_rms_of_a_sine_is_its_amplitude_over_root_two():
    # Whole periods, the last sample of the last period left out.
    wave = {"a.b": series(3.0 * np.sin(2 * np.pi * TIMES / 5.0))}
    result = signal(wave, "rms", at_most=2.2, from_s=5.0, to_s=15.0 - DT)
    assert result.value == pytest.approx(3.0 / np.sqrt(2.0), abs=1e-12)
    assert result.margin == pytest.approx(2.2 - 3.0 / np.sqrt(2.0))
    assert result.verdict == "PASS"
    # The largest single value is at a crest: a quarter or three quarters of a period.
    assert result.at_s % 2.5 == pytest.approx(1.25, abs=DT)


@pytest.mark.parametrize(
    ("statistic", "value", "at_s"),
    [
        ("mean", 0.0, RUN_S),
        ("max", 10.0, RUN_S),
        ("min", -10.0, 0.0),
        ("max_abs", 10.0, 0.0),
        ("final", 10.0, RUN_S),
        ("rms", np.sqrt(np.mean((TIMES - 10.0) ** 2)), 0.0),
    ],
)
def test_statistics_of_a_ramp(statistic, value, at_s):
    result = signal({"a.b": series(TIMES - 10.0)}, statistic, at_most=100.0)
    assert result.value == pytest.approx(value, abs=1e-12)
    assert result.at_s == pytest.approx(at_s)


def test_mean_at_least_points_at_the_lowest_sample():
    result = signal({"a.b": series(TIMES)}, "mean", at_least=3.0)
    assert (result.value, result.at_s, result.verdict) == (pytest.approx(10.0), 0.0, "PASS")


def test_vectors_are_judged_by_norm_or_by_component():
    turning = {"a.b": series(3.0 * np.cos(TIMES), 3.0 * np.sin(TIMES), 4.0)}
    assert signal(turning, "max", at_most=5.1).value == pytest.approx(5.0)
    assert signal(turning, "min", at_most=5.1).value == pytest.approx(5.0)
    assert signal(turning, "mean", at_most=5.1, component=2).value == pytest.approx(4.0)
    assert signal(turning, "min", at_least=-3.0, component=0).value == pytest.approx(-3.0, abs=1e-4)


def test_a_scalar_keeps_its_sign():
    assert signal({"a.b": series(-2.0)}, "max", at_most=0.0).value == -2.0


def test_only_the_window_counts():
    """A spike is seen exactly by the windows that hold it."""
    spike_s = 10.0
    signals = {"a.b": series(np.where(np.isclose(TIMES, spike_s), 7.0, 0.0))}
    for from_s, to_s in itertools.product(np.arange(0.0, 20.0, 2.5), np.arange(2.5, 20.1, 2.5)):
        if from_s < to_s:
            result = signal(signals, "max", at_most=1.0, from_s=float(from_s), to_s=float(to_s))
            inside = from_s <= spike_s <= to_s
            assert result.verdict == ("FAIL" if inside else "PASS")
            assert result.value == (7.0 if inside else 0.0)


@pytest.mark.parametrize("limit", [0.1, 1.0, -3.0, 1e300])
def test_the_limit_itself_passes_and_the_next_number_fails(limit):
    beyond, within = np.nextafter(limit, np.inf), np.nextafter(limit, -np.inf)
    for value, at_most, at_least in ((limit, "PASS", "PASS"), (beyond, "FAIL", "PASS"), (within, "PASS", "FAIL")):
        signals = {"a.b": series(value)}
        assert signal(signals, "final", at_most=limit).verdict == at_most
        assert signal(signals, "final", at_least=limit).verdict == at_least


def test_margin_is_positive_inside_for_both_kinds_of_limit():
    signals = {"a.b": series(2.0)}
    assert signal(signals, "mean", at_most=5.0).margin == 3.0
    assert signal(signals, "mean", at_least=5.0).margin == -3.0


# What cannot be judged


def poisoned(value):
    bad = series(1.0)
    bad[500, 1] = value
    return {"a.b": bad}


@pytest.mark.parametrize(
    ("signals", "asked", "reason"),
    [
        ({}, {}, "no signal a.b; recorded: none"),
        ({"a.c": series(1.0), "x.y": series(1.0)}, {}, "no signal a.b; nearest: a.c"),
        ({"pose.position": series(1.0)}, {}, "no signal a.b; recorded: pose.position"),
        ({"a.b": np.empty((0, 2))}, {}, "a.b holds no samples"),
        ({"a.b": np.zeros(5)}, {}, "a.b holds no samples"),
        ({"a.b": series()}, {}, "a.b holds no samples"),
        ({"a.b": series(1.0)[:1]}, {}, "a.b has one sample, needs two or more"),
        ({"a.b": series(1.0)[::-1]}, {}, "the times of a.b do not increase"),
        ({"a.b": np.repeat(series(1.0), 2, axis=0)}, {}, "the times of a.b do not increase"),
        ({"a.b": np.full((5, 2), np.nan)}, {}, "the times of a.b do not increase"),
        (poisoned(np.nan), {}, "a.b is not finite at 10 s"),
        (poisoned(np.inf), {}, "a.b is not finite at 10 s"),
        (poisoned(-np.inf), {"statistic": "final"}, "a.b is not finite at 10 s"),
        ({"a.b": series(1e200)}, {"statistic": "rms"}, "the value is not finite"),
        ({"a.b": series(1.0)}, {"component": 1}, "a.b has 1 column, no component 1"),
        ({"a.b": series(1.0)}, {"from_s": 30.0}, "window 30 s to the end is outside the run, 0 s to 20 s"),
        ({"a.b": series(1.0)}, {"to_s": 30.0}, "window 0 s to 30 s is outside the run, 0 s to 20 s"),
        ({"a.b": series(1.0)}, {"from_s": 5.001, "to_s": 5.002}, "window 5.001 s to 5.002 s holds 0 samples, needs 2"),
        ({"a.b": series(1.0)}, {"from_s": 5.0, "to_s": 5.01}, "window 5 s to 5.01 s holds 1 samples, needs 2"),
        ({"a.b": series(1.0)[:-5]}, {"duration_s": RUN_S}, "a.b ends at 19.9 s, the run should last 20 s"),
    ],
)
def test_what_cannot_be_judged_is_an_error(signals, asked, reason):
    for limit in ({"at_most": 1e300}, {"at_least": -1e300}):
        result = signal(signals, **{"statistic": "max", **limit, **asked})
        assert result.verdict == "ERROR"
        assert reason in result.detail
        assert (result.value, result.margin, result.at_s) == (None, None, None)


def test_poison_outside_the_window_does_not_matter():
    assert signal(poisoned(np.nan), "max", at_most=2.0, from_s=10.5).verdict == "PASS"


def test_a_run_may_end_one_tick_before_its_duration():
    """A recording may hold the starts of ticks only, or the end of the last one as well."""
    full = series(1.0)
    for rows in (full, full[:-1]):
        assert signal({"a.b": rows}, "max", at_most=2.0, to_s=RUN_S, duration_s=RUN_S).verdict == "PASS"


# Allowed forces


def allowed_brute_force(force, limits, allow_off, step):
    """Distance to a dense sampling of the allowed set: right to within half a step."""
    lowest, below, above, highest = limits
    points = [np.arange(lowest, below + step / 2, step), np.arange(above, highest + step / 2, step)]
    if allow_off:
        points.append(np.zeros(1))
    return np.min(np.abs(np.concatenate(points) - force))


@pytest.mark.parametrize("allow_off", [False, True])
def test_distance_to_the_allowed_set_is_that_to_its_nearest_point(allow_off):
    step = 0.01
    for limits in ([-40.0, -2.0, 2.0, 50.0], [-1.0, -0.0, 0.0, 1.0], [-3.0, -3.0, 0.5, 0.5], [0.0, 0.0, 0.0, 0.0]):
        for force in np.linspace(-60.0, 60.0, 97):
            found = distance_to_allowed(np.array([[force]]), np.array([[limits]]), allow_off)[0, 0]
            assert found == pytest.approx(allowed_brute_force(force, limits, allow_off, step), abs=step / 2 + 1e-12)


LIMITS = [-40.0, -2.0, 2.0, 50.0]


def forces(force, limits=LIMITS, **asked):
    force = np.asarray(force, dtype=float)
    m = force.shape[1]
    return judge(
        {
            "thrusters.force_demanded": np.column_stack([np.arange(len(force)) * DT, force]),
            "actuation.limits": np.concatenate([[0.0], np.tile(limits, m)])[None],
        },
        kind="allowed_forces",
        **asked,
    )


def test_allowed_forces_at_every_edge():
    edges = [[-40.0, -2.0, 2.0, 50.0], [-40.0, -40.0, 50.0, 50.0]]
    assert forces(edges, tolerance_N=0.0, allow_off=False).verdict == "PASS"
    for column, outside in enumerate((-np.inf, np.inf, -np.inf, np.inf)):
        moved = np.array(edges)
        moved[0, column] = np.nextafter(moved[0, column], outside)
        result = forces(moved, tolerance_N=0.0, allow_off=False)
        assert (result.verdict, result.at_s) == ("FAIL", 0.0)
        assert f"thruster {column + 1} " in result.detail


def test_zero_is_allowed_only_where_thrusters_may_rest():
    assert forces(np.zeros((3, 8)), allow_off=True).verdict == "PASS"
    result = forces(np.zeros((3, 8)), allow_off=False)
    assert (result.verdict, result.value) == ("FAIL", 2.0)


def test_one_violation_at_one_tick_is_found():
    """Every (tick, thruster) in turn."""
    for tick, thruster in itertools.product(range(5), range(3)):
        force = np.full((5, 3), 10.0)
        force[tick, thruster] = 1.5
        result = forces(force)
        assert (result.verdict, result.value, result.at_s) == ("FAIL", 0.5, tick * DT)
        assert f"thruster {thruster + 1} asked for 1.5 N" in result.detail


def test_limits_hold_until_they_change():
    signals = {
        "thrusters.force_demanded": series(10.0),
        "actuation.limits": np.array([[0.0, *LIMITS], [10.0, -40.0, -12.0, 12.0, 50.0], [15.0, *LIMITS]]),
    }
    result = judge(signals, kind="allowed_forces", allow_off=False)
    assert (result.verdict, result.value, result.at_s) == ("FAIL", 2.0, pytest.approx(10.0))
    signals["actuation.limits"][1, 0] = 20.1
    signals["actuation.limits"][2, 0] = 20.2
    assert judge(signals, kind="allowed_forces").verdict == "PASS"


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        ([[0.0, 1.0, 2.0]], "actuation.limits has 2 columns, 1 thrusters need 4 each"),
        ([[0.0, -2.0, -40.0, 2.0, 50.0]], "actuation.limits are not in the order"),
        ([[0.0, -40.0, np.nan, 2.0, 50.0]], "actuation.limits is not finite at 0 s"),
        ([[1.0, *LIMITS]], "actuation.limits starts at 1 s, the run at 0 s"),
        (None, "no signal actuation.limits"),
    ],
)
def test_limits_that_mean_nothing_are_an_error(limits, reason):
    signals = {"thrusters.force_demanded": series(10.0)}
    if limits is not None:
        signals["actuation.limits"] = np.array(limits)
    result = judge(signals, kind="allowed_forces")
    assert result.verdict == "ERROR"
    assert reason in result.detail


# Exact wrench


def wrenches(seed=3, m=8):
    """A run whose demanded wrench is what random forces make with a matrix that changes half way."""
    source = np.random.default_rng(seed)
    force = source.normal(size=(len(TIMES), m)) * 20
    matrices = source.normal(size=(2, 6, m))
    half = TIMES >= RUN_S / 2
    wrench = np.where(half[:, None], force @ matrices[1].T, force @ matrices[0].T)
    return {
        "thrusters.force_demanded": series(*force.T),
        "wrench.demanded": series(*wrench.T),
        "allocation.status": series(0.0),
        "actuation.matrix": np.column_stack([[0.0, RUN_S / 2], matrices.reshape(2, -1)]),
    }


def test_exact_wrench_over_a_changing_matrix():
    result = judge(wrenches(), kind="exact_wrench", at_most=1e-9)
    assert result.verdict == "PASS"
    assert result.detail == "attainable at 1001 of 1001 ticks"
    # With the first matrix alone the second half is wrong.
    signals = wrenches()
    signals["actuation.matrix"] = signals["actuation.matrix"][:1]
    assert judge(signals, kind="exact_wrench").at_s >= RUN_S / 2


def test_exact_wrench_is_the_norm_of_the_worst_attainable_tick():
    signals = wrenches()
    signals["wrench.demanded"][700, 1:] += [3.0, 0.0, 0.0, 0.0, 4.0, 0.0]
    signals["wrench.demanded"][300, 1:] += 1.0
    result = judge(signals, kind="exact_wrench")
    assert (result.verdict, result.value, result.at_s) == ("FAIL", pytest.approx(5.0), TIMES[700])
    signals["allocation.status"][700, 1] = 1.0
    result = judge(signals, kind="exact_wrench")
    assert (result.value, result.at_s) == (pytest.approx(np.sqrt(6.0)), TIMES[300])
    signals["allocation.status"][300, 1] = 1.0
    assert judge(signals, kind="exact_wrench").detail == "attainable at 999 of 1001 ticks"


def test_a_demand_that_is_not_finite_matters_only_where_attainable():
    signals = wrenches()
    signals["wrench.demanded"][10, 3] = np.nan
    assert judge(signals, kind="exact_wrench").verdict == "ERROR"
    signals["allocation.status"][10, 1] = 2.0
    assert judge(signals, kind="exact_wrench").verdict == "PASS"


def test_no_attainable_tick_is_an_error():
    signals = wrenches()
    signals["allocation.status"] = series(1.0)
    result = judge(signals, kind="exact_wrench")
    assert (result.verdict, result.detail) == ("ERROR", "no wrench of 1001 was attainable")


@pytest.mark.parametrize(
    "name", ["thrusters.force_demanded", "wrench.demanded", "allocation.status", "actuation.matrix"]
)
def test_exact_wrench_needs_each_of_its_signals(name):
    signals = wrenches()
    whole = signals.pop(name)
    assert f"no signal {name}" in judge(signals, kind="exact_wrench").detail
    signals[name] = whole[:, :-1]
    assert judge(signals, kind="exact_wrench").verdict == "ERROR"
    if len(whole) > 2:
        signals[name] = whole[1:]
        assert "not sampled at the same times" in judge(signals, kind="exact_wrench").detail


# Path end


def approach(end_s, lag_m=0.0):
    """A target that runs 10 m along x and reaches the end at end_s; the vehicle flies lag_m beside it."""
    along = np.minimum(TIMES / end_s, 1.0) * 10.0
    return {
        "target.remaining": series(10.0 - along),
        "target.position": series(along, 0.0, -5.0),
        "pose.position": series(along, lag_m, -5.0),
    }


def test_path_end_is_reached_when_target_and_vehicle_are_there():
    result = judge(approach(15.0, lag_m=0.25), kind="path_end", reach_m=0.25)
    assert (result.verdict, result.value, result.at_s) == ("PASS", pytest.approx(0.25), pytest.approx(15.0))
    assert judge(approach(15.0, lag_m=0.25), kind="path_end", reach_m=0.2499).verdict == "FAIL"


def test_path_end_is_not_reached_by_being_there_with_the_path_still_ahead():
    """On a closed path the vehicle starts where the path ends."""
    signals = approach(40.0)
    signals["pose.position"] = series(10.0, 0.0, -5.0)
    result = judge(signals, kind="path_end", reach_m=0.5)
    assert (result.verdict, result.value) == ("FAIL", pytest.approx(10.0))


def test_path_end_never_understates_the_distance_to_the_end():
    """On a curve the arc left is at least the chord: compare with the distance itself."""
    source = np.random.default_rng(7)
    angle = np.linspace(0.0, 1.7 * np.pi, len(TIMES))
    target = 3.0 * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    for _ in range(20):
        vehicle = target + source.normal(size=3)
        signals = {
            "target.remaining": series(3.0 * (angle[-1] - angle)),
            "target.position": series(*target.T),
            "pose.position": series(*vehicle.T),
        }
        result = judge(signals, kind="path_end", reach_m=1.0)
        nearest = np.linalg.norm(vehicle - target[-1], axis=1)[np.isclose(TIMES, result.at_s)][0]
        assert result.value >= nearest - 1e-12


# Verdicts


def result(verdict, value=1.0):
    return CheckResult("c", verdict, value, "<=", 2.0, 1.0, 0.5, "")


def test_overall_verdict_over_every_combination():
    assert overall([]) == "ERROR"
    rank = {"PASS": 0, "ERROR": 1, "FAIL": 2}
    for count in (1, 2, 3):
        for verdicts in itertools.product(rank, repeat=count):
            assert overall(map(result, verdicts)) == max(verdicts, key=rank.__getitem__)
            assert overall(map(result, verdicts), complete=False) == "ERROR"


def test_results_come_in_the_order_of_the_checks():
    checks = [
        TypeAdapter(AnyCheck).validate_python(
            {"kind": "signal", "name": f"n{k}", "signal": "a.b", "statistic": "max", "at_most": float(k)}
        )
        for k in range(5)
    ]
    results = evaluate(checks, {"a.b": series(2.0)})
    assert [(item.name, item.limit, item.verdict) for item in results] == [
        ("n0", 0.0, "FAIL"),
        ("n1", 1.0, "FAIL"),
        ("n2", 2.0, "PASS"),
        ("n3", 3.0, "PASS"),
        ("n4", 4.0, "PASS"),
    ]


def test_verdict_json_says_how_long_a_run_lasted_and_what_it_warned_of():
    lines = (LogLine(1.0, "WARNING", "lost"), LogLine(2.0, "ERROR", "over"), LogLine(2.5, "WARNING", "lost"))
    text = to_json("ERROR", [], 1.0, {}, Flown(2.5, EarlyEnd(2.5, "over"), lines))
    content = json.loads(text)
    assert content["simulated_s"] == 2.5
    assert content["ended_early"] == {"time_s": 2.5, "reason": "over", "verdict": "ERROR"}
    assert content["log"] == [
        {"time_s": 1.0, "level": "WARNING", "text": "lost", "count": 2, "last_s": 2.5},
        {"time_s": 2.0, "level": "ERROR", "text": "over", "count": 1, "last_s": 2.0},
    ]


def test_verdict_json_is_strict_and_complete():
    error = CheckResult("e", "ERROR", None, "<=", 2.0, None, None, "no signal")
    text = to_json("ERROR", [result("PASS"), error], 12.5, {"mujoco": "4.0"})

    def refuse(constant):
        raise AssertionError(constant)

    content = json.loads(text, parse_constant=refuse)
    assert list(content) == [
        "verdict", "checks", "simulated_s", "ended_early", "log", "real_time_factor", "versions",
    ]  # fmt: skip
    assert (content["simulated_s"], content["ended_early"], content["log"]) == (None, None, [])
    assert [set(check) for check in content["checks"]] == [
        {"name", "verdict", "value", "relation", "limit", "margin", "at_s", "detail", "unit"}
    ] * 2
    assert content["checks"][1]["value"] is None
    with pytest.raises(ValueError, match="JSON"):
        to_json("PASS", [result("PASS", value=float("nan"))], 12.5, {})
