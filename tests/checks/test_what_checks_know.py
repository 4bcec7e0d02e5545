"""Checks that know themselves what to look at: progress along the path, false alarms."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import TypeAdapter

from cube_sim.checks import Beforehand, SignalsInBlocks, evaluate
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.scenario.event_blocks import ThrusterEventBlock

T = np.arange(0.0, 20.01, 0.1)


def rows(*columns):
    return np.column_stack([T, *(np.broadcast_to(column, T.shape) for column in columns)]).astype(float)


class Blocks(dict):
    """The same signals in blocks of five rows."""

    def blocks(self, names):
        for start in range(0, len(T), 5):
            yield {name: self[name][start : start + 5] for name in names}


def judge(signals, events=(), **asked):
    assert isinstance(Blocks(signals), SignalsInBlocks)
    check = TypeAdapter(AnyCheck).validate_python(asked)
    found = [evaluate([check], each, beforehand=Beforehand(events))[0] for each in (signals, Blocks(signals))]
    assert found[0] == found[1]
    return found[0]


def target(gone, length=100.0):
    return {"target.arc_length": rows(gone), "target.remaining": rows(length - np.asarray(gone))}


def test_progress_is_the_mean_speed_of_the_target_in_the_window():
    gone = np.where(T < 10.0, 0.5 * T, 5.0 + 0.1 * (T - 10.0))
    found = judge(target(gone), kind="progress", at_least_m_s=0.3)
    assert (found.verdict, found.value) == ("PASS", pytest.approx(0.3))
    late = judge(target(gone), kind="progress", at_least_m_s=0.11, from_s=10)
    assert (late.verdict, late.value, late.at_s) == ("FAIL", pytest.approx(0.1), 20.0)
    assert judge(target(gone), kind="progress", at_least_m_s=0.4, to_s=9.95).value == pytest.approx(0.5)


def test_laps_of_a_closed_path_count():
    round_and_round = {**target((0.7 * T) % 6.0), "target.remaining": rows(np.inf)}
    found = judge(round_and_round, kind="progress", at_least_m_s=0.69)
    assert (found.verdict, found.value) == ("PASS", pytest.approx(0.7, rel=0.011))  # the steps over the seam are none


def test_at_the_end_of_the_path_nothing_more_is_asked():
    """It comes to the end at 8 s, and waits there."""
    found = judge(target(np.minimum(0.5 * T, 4.0), length=4.0), kind="progress", at_least_m_s=0.45)
    assert (found.verdict, found.value) == ("PASS", pytest.approx(0.5))
    never = judge(target(np.full_like(T, 4.0), length=4.0), kind="progress", at_least_m_s=0.45)
    assert (never.verdict, never.detail) == ("ERROR", "the target is at the end of its path by 0 s, before it moves")


@pytest.mark.parametrize(
    ("wrong", "detail"),
    [
        ({"target.remaining": rows(1.0, 2.0)}, "target.remaining has 2 columns, needs 1"),
        ({"target.remaining": rows(np.where(T > 5, np.nan, 50.0))}, "target.remaining is not finite at 5.1 s"),
        ({"target.arc_length": rows(0.1 * T)[:-9]}, "gone and left are not sampled at the same times"),
    ],
)
def test_progress_that_cannot_be_told_is_an_error(wrong, detail):
    found = judge({**target(0.1 * T), **wrong}, kind="progress", at_least_m_s=0.05)
    assert (found.verdict, found.detail) == ("ERROR", detail)


def health(believed, true=(1.0, 1.0)):
    return {"health.believed": rows(*believed), "health.efficiency": rows(*true)}


def test_a_whole_thruster_that_is_doubted_is_a_false_alarm_and_a_broken_one_is_not():
    doubt = np.where((T > 7.0) & (T < 8.0), 0.5, 1.0)
    found = judge(health((1.0, doubt)), kind="false_alarms")
    assert (found.verdict, found.value, found.at_s) == ("FAIL", 1.0, pytest.approx(7.1))
    assert found.detail == "2 thrusters; columns 1 of health.believed"
    assert judge(health((1.0, doubt)), kind="false_alarms", at_most=1).verdict == "PASS"
    broken = health((1.0, doubt), (1.0, np.where(T > 6.0, 0.9, 1.0)))
    assert judge(broken, kind="false_alarms").value == 0.0


def test_after_a_recovery_there_is_time_to_find_it_out():
    event = ThrusterEventBlock(kind="thrusters", at_s=5.0, thrusters=["T2"], state="recovered")
    doubt = np.where((T > 4.0) & (T < 10.0), 0.0, 1.0)
    signals = health((1.0, doubt), (1.0, np.where((T > 2.0) & (T < 5.0), 0.0, 1.0)))
    assert judge(signals, [event], kind="false_alarms").verdict == "PASS"
    assert judge(signals, [event], kind="false_alarms", recovery_s=4.0).at_s == pytest.approx(9.1)
    assert judge(signals, kind="false_alarms").verdict == "FAIL"


def test_what_is_believed_of_other_thrusters_is_no_answer():
    found = judge({"health.believed": rows(1.0, 1.0), "health.efficiency": rows(1.0)}, kind="false_alarms")
    assert found.verdict == "ERROR"
    assert "of 2 and 1 thrusters" in found.detail


def test_the_horizontal_part_of_a_vector():
    signals = {"a.b": rows(3.0, -4.0, 12.0)}
    asked = {"kind": "signal", "signal": "a.b", "statistic": "max", "at_most": 20}
    assert judge(signals, **asked, combine="horizontal").value == 5.0
    assert judge(signals, **asked).value == 13.0


def test_a_denominator_counts_as_its_least():
    signals = {"a.b": rows(0.04), "c.d": rows(0.01)}
    ratio = {"kind": "ratio", "numerator": {"signal": "a.b", "statistic": "rms"}, "at_most": 3}
    ratio |= {"denominator": {"signal": "c.d", "statistic": "rms"}}
    assert judge(signals, **ratio).verdict == "FAIL"
    found = judge(signals, **ratio, least_denominator=0.05 / 3)
    assert (found.verdict, found.value) == ("PASS", pytest.approx(2.4))
    assert "0.01, counted as 0.0166667" in found.detail
    assert judge(signals, **ratio, least_denominator=0.009).value == pytest.approx(4.0)
