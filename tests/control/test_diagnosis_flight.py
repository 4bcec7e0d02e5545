"""Stuck, weak and recovering thrusters in flight: found out, flown without, used again."""

import re

import numpy as np
import pytest
from support.flights import FORCES_ONLY, said
from support.flights import thruster_event as event
from support.places import SCENARIOS

import cube_sim

pytestmark = pytest.mark.flight

CUBE, JACK = SCENARIOS / "cube_lose_two.yaml", SCENARIOS / "jack_lose_two.yaml"
CHECKS = [*FORCES_ONLY, {"kind": "exact_wrench", "at_most": 1e-3}]
HOLONOMIC, PLANE, SAFE, TRIM, TURNED = 0, 1, 3, 6, 7


@pytest.fixture
def fly(tmp_path):
    """Signals and the log's lines of a mission with these events."""

    def flown(scenario, duration, events, **changes):
        changes = {"duration_s": duration, "events": events, "checks": CHECKS, **changes}
        run = cube_sim.run(scenario, changes, out=tmp_path)
        assert run.verdict == "PASS", [(check.name, check.value) for check in run.checks]
        return run.signals, said(run)

    return flown


def worst(signals, name, from_s, to_s=np.inf):
    t, values = signals[name][:, 0], signals[name][:, 1]
    return float(np.max(values[(t >= from_s) & (t < to_s)]))


@pytest.mark.parametrize(
    ("thrusters", "force", "bound"),
    [
        (["T1", "T2"], 10.0, 0.02),
        (["T1", "T2", "T5"], 15.0, 0.03),
    ],
)
def test_the_path_is_followed_beside_stuck_thrusters_that_leave_less_than_all_components(fly, thrusters, force, bound):
    signals, log = fly(CUBE, 26, [event(6, thrusters, "stuck", force_N=force)])
    assert signals["health.authority"][-1, 1] == TURNED
    assert worst(signals, "path_error.cross_track", 16.0) < bound
    last = re.compile(rf"{thrusters[-1]} stuck at (\S+) N; TURNED")
    told = [text for text in log if last.search(text)]
    assert len(told) == 1
    assert float(last.search(told[0])[1]) == pytest.approx(force, abs=0.2)
    assert " N always" in told[0]
    assert "= 0 always" not in told[0]


def test_jacks_stuck_motors_are_not_taken_for_weak_ones(fly):
    signals, log = fly(JACK, 38, [event(18, ["T1", "T2"], "stuck", force_N=10.0)])
    assert signals["health.authority"][-1, 1] == TURNED
    assert not any("%" in text for text in log)
    assert worst(signals, "path_error.cross_track", 32.0) < 0.1


def test_a_pair_that_recovers_is_used_again_within_ten_seconds(fly):
    signals, _ = fly(CUBE, 28, [event(6, ["T1", "T2"], "dead"), event(12, ["T1", "T2"], "recovered")])
    authority = signals["health.authority"]
    assert set(authority[(authority[:, 0] > 8.0) & (authority[:, 0] < 12.0), 1]) == {TRIM}
    assert worst(signals, "health.authority", 22.0) == HOLONOMIC
    assert worst(signals, "path_error.cross_track", 26.0) < 0.02


def test_recovery_ends_the_safe_mode(fly):
    four = ["T1", "T2", "T3", "T4"]
    signals, log = fly(CUBE, 40, [event(6, four, "dead"), event(12, four, "recovered")])
    assert "the path is followed again" in log
    assert worst(signals, "health.authority", 8.0, 12.0) == SAFE
    assert worst(signals, "health.authority", 22.0) == HOLONOMIC
    assert worst(signals, "path_error.cross_track", 36.0) < 0.02


def test_what_a_stuck_motor_does_later_is_noticed_from_the_force_it_gives(fly):
    events = [
        event(6, ["T1"], "stuck", force_N=30.0),
        event(9, ["T1"], "dead"),
        event(12, ["T1"], "recovered"),
    ]
    signals, log = fly(CUBE, 21, events)
    found = [text.split(";")[0] for text in log if text.startswith(("T1 ", "all thrusters"))]
    assert found == ["T1 stuck at 30.0 N", "T1 dead", "all thrusters whole"]
    planned, given = signals["thrusters.force_demanded"][:, :2], signals["thrusters.force"][:, :2]
    t = planned[:, 0]
    between = (t > 10.0) & (t < 12.0)
    assert not planned[between, 1].any()
    assert not given[between, 1].any()
    end = t > 19.0
    assert np.abs(planned[end, 1]).max() > 1.0
    np.testing.assert_allclose(given[end][1:, 1], planned[end][:-1, 1], atol=1.0)


def test_motors_without_force_are_flown_without(fly):
    """At one percent they make no torque worth the name, whatever the rank of their columns says."""
    weak = [event(6, ["T1", "T2", "T3"], "weak", efficiency=0.01)]
    signals, _ = fly(CUBE, 24, weak, **{"control.faults": "told"})
    assert worst(signals, "path_error.cross_track", 16.0) < 0.3
    assert signals["health.authority"][-1, 1] == PLANE
