"""Checks that no flight could answer are refused before it."""

from __future__ import annotations

from pathlib import Path

import pytest

from cube_sim.errors import ScenarioError
from cube_sim.mission import prepare
from cube_sim.scenario import load

SCENARIOS = Path(__file__).parents[2] / "scenarios"


def prepared(check, scenario="cube_navigated"):
    checks = [{"kind": "signal", "at_most": 1.0, **check}]
    return prepare(load(SCENARIOS / f"{scenario}.yaml", {"checks": checks, "duration_s": 20.0, "events": []}))


@pytest.mark.parametrize(
    ("check", "said"),
    [
        (
            {"signal": "pose.position", "statistic": "rms", "from_s": 5.001, "to_s": 5.015},
            "to_s: the window 5.001 s to 5.015 s holds no sample of pose.position, which has one every 0.02 s; "
            "rms needs 2",
        ),
        (
            {"signal": "pose.position", "statistic": "mean", "from_s": 19.99},
            "from_s: the window 19.99 s to 20 s holds one sample of pose.position, which has one every 0.02 s; "
            "mean needs 2",
        ),
        (
            {"signal": "sensor_dvl.velocity", "statistic": "max", "to_s": 0.1},
            "to_s: the window 0 s to 0.1 s holds at most one sample of sensor_dvl.velocity, which has one every 0.2 s; "
            "max needs 2",
        ),
    ],
)
def test_a_window_without_its_samples_is_refused(check, said):
    with pytest.raises(ScenarioError) as refused:
        prepared(check)
    assert str(refused.value) == f"override checks: checks.0.{said}"


@pytest.mark.parametrize(
    ("check", "said"),
    [
        (
            {"kind": "always", "all": [{"signal": "pose.position", "at_most": 1},
             {"signal": "pose.speed", "at_most": 1}]},
            "all.1.signal: no signal 'pose.speed' is recorded, the nearest of",
        ),
        (
            {"kind": "always", "any": [{"signal": "pose.position", "at_most": 1}, {"signal": "velocity.linear",
             "at_most": 1}]},
            "any.1: m/s beside m: give every comparison a scale, by which margins compare",
        ),
        (
            {"kind": "signal", "signal": "pose.position", "minus": "velocity.linear", "statistic": "max", "at_most": 1},
            "minus: velocity.linear in m/s cannot be taken away from pose.position in m",
        ),
        (
            {"kind": "signal",
             "signal": "pose.position", "minus": "path_error.along", "statistic": "rms", "at_most": 1},
            "minus: path_error.along has 1 column and cannot be taken away from pose.position, which has 3",
        ),
        (
            {"kind": "always", "all": [{"signal": "velocity.linear", "minus": "sensor_dvl.velocity", "at_most": 1}]},
            "all.0.minus: sensor_dvl.velocity and velocity.linear have no rows at the same times: one",
        ),
        (
            {"kind": "signal", "signal": "pose.position", "minus": "target.positin", "statistic": "max", "at_most": 1},
            "minus: no signal 'target.positin' is recorded, did you mean target.position?",
        ),
        (
            {"kind": "ratio", "numerator": {"signal": "power.charge", "statistic": "max"}, "denominator": {
                "signal": "pose.position", "statistic": "max", "component": 3}, "at_most": 1},
            "numerator.signal: 'power.charge' is not recorded: the scenario has no battery\n"
            "override checks: checks.0.denominator.component: pose.position has columns 0 to 2",
        ),
        (
            {"kind": "ratio", "numerator": {"signal": "pose.position", "statistic": "std", "from_s": 4, "to_s": 4.01},
             "denominator": {"signal": "pose.position", "statistic": "max"}, "at_most": 1},
            "numerator.to_s: the window 4 s to 4.01 s holds one sample of pose.position, which has one every 0.02 s;"
            " std needs 2",
        ),
    ],
)  # fmt: skip
def test_a_signal_inside_a_check_is_refused_at_its_place(check, said):
    with pytest.raises(ScenarioError) as refused:
        prepare(load(SCENARIOS / "cube_navigated.yaml", {"checks": [check], "duration_s": 20.0, "events": []}))
    assert f"override checks: checks.0.{said}" in str(refused.value)


@pytest.mark.parametrize(
    "check",
    [
        {"signal": "actuation.limits", "statistic": "max"},
        {"signal": "actuation.limits", "statistic": "mean", "from_s": 5.001, "to_s": 5.002},
        {"signal": "pose.position", "statistic": "final", "from_s": 5.001, "to_s": 5.021},
        {"signal": "pose.position", "statistic": "max", "from_s": 5.001, "to_s": 5.045},
        {"signal": "pose.position", "statistic": "final", "from_s": 19.99},
        {"signal": "sensor_dvl.velocity", "statistic": "final", "to_s": 0.1},
        {"signal": "sensor_dvl.velocity", "statistic": "max", "to_s": 0.3},
    ],
)
def test_a_window_that_may_hold_them_is_not(check):
    assert prepared(check).scenario.checks
