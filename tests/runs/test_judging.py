"""A record of which a part is missing: what its rows show is said, and no more."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.synthetic_run import synthetic_run

from cube_sim.recording.reading import ALTERED
from cube_sim.recording.run_end import RunEnd
from cube_sim.runs.judging import judged
from cube_sim.scenario.check_blocks import (
    AllowedForcesCheckBlock,
    AlwaysCheckBlock,
    BeforeAfterCheckBlock,
    ComparisonBlock,
    EventuallyCheckBlock,
    PathEndCheckBlock,
    SignalCheckBlock,
)

BEYOND_S = 6.2, 7.0
"""When the cross-track error of the synthetic run is beyond 0.5 m; at 6.6 s it is 0.9 m, elsewhere 0.01 m."""

UNDER = ComparisonBlock(signal="path_error.cross_track", at_most=0.5)
OVER = ComparisonBlock(signal="path_error.cross_track", at_least=0.5)


def cross_track(statistic, **rest):
    return SignalCheckBlock(kind="signal", signal="path_error.cross_track", statistic=statistic, **rest)


def without(start, end, how="recovered", channel=None, simulated_s=10.0):
    """The synthetic run without the rows of [start, end), of one channel or of all."""
    run = synthetic_run(verdict=None)
    rows = {
        name: values if channel not in (None, name) else values[(values[:, 0] < start) | (values[:, 0] >= end)]
        for name, values in run.recording.rows.items()
    }
    return replace(run, recording=replace(run.recording, rows=rows, end=RunEnd(how, "x", 501, simulated_s), flaw=how))


@pytest.mark.parametrize(
    ("check", "gap", "verdict"),
    [
        (cross_track("max", at_most=0.5), (3.0, 4.0), "FAIL"),  # it stays beyond its limit
        (cross_track("max_abs", at_most=0.5), (3.0, 4.0), "FAIL"),
        (cross_track("max", at_most=0.5), (6.0, 7.5), "ERROR"),  # it passes by the rows that are left
        (cross_track("max", at_most=0.5, to_s=5.0), (6.0, 7.5), "PASS"),  # its window is whole
        (cross_track("max", at_least=0.8), (3.0, 4.0), "PASS"),
        (cross_track("max", at_least=0.95), (3.0, 4.0), "ERROR"),
        (cross_track("min", at_least=0.5), (3.0, 4.0), "FAIL"),
        (cross_track("min", at_most=0.5), (3.0, 4.0), "PASS"),
        (cross_track("min", at_most=0.001), (3.0, 4.0), "ERROR"),
        (cross_track("rms", at_most=0.001), (3.0, 4.0), "ERROR"),
        (cross_track("mean", at_most=0.5), (3.0, 4.0), "ERROR"),
        (cross_track("mean", at_most=0.5, from_s=8.0), (3.0, 4.0), "PASS"),
        (cross_track("final", at_most=0.5), (3.0, 4.0), "PASS"),
        (cross_track("final", at_most=0.001), (3.0, 4.0), "FAIL"),
        (cross_track("final", at_most=0.5), (9.0, 10.5), "ERROR"),
        (cross_track("final", at_most=0.5, to_s=5.0), (4.9, 6.0), "ERROR"),
        (cross_track("min_abs", at_most=0.5), (3.0, 4.0), "PASS"),
        (cross_track("std", at_most=0.001), (3.0, 4.0), "ERROR"),
        (cross_track("percentile", percent=50.0, at_most=0.5), (3.0, 4.0), "ERROR"),
        (cross_track("share_above", level=0.5, at_most=0.5), (3.0, 4.0), "ERROR"),
        (cross_track("crossings", level=0.5, at_most=1.0), (3.0, 4.0), "FAIL"),
        (cross_track("crossings", level=0.5, at_most=2.0), (3.0, 4.0), "ERROR"),
        (cross_track("settling", band=(0.0, 0.5), at_most=6.9), (3.0, 4.0), "FAIL"),
        (cross_track("settling", band=(0.0, 0.5), at_most=7.5), (8.0, 9.0), "ERROR"),
        (cross_track("settling", band=(0.0, 0.5), at_least=7.0), (8.0, 9.0), "PASS"),
        (cross_track("integral", at_most=100.0), (3.0, 4.0), "ERROR"),
        (AlwaysCheckBlock(kind="always", all=(UNDER,)), (3.0, 4.0), "FAIL"),
        (AlwaysCheckBlock(kind="always", all=(UNDER,), to_s=5.0), (3.0, 4.0), "ERROR"),
        (AlwaysCheckBlock(kind="always", all=(UNDER,), to_s=5.0), (6.0, 7.5), "PASS"),
        (EventuallyCheckBlock(kind="eventually", all=(OVER,)), (3.0, 4.0), "PASS"),
        (EventuallyCheckBlock(kind="eventually", all=(OVER,)), (6.0, 7.5), "ERROR"),
        (EventuallyCheckBlock(kind="eventually", all=(OVER,), within_s=5.0), (7.0, 7.5), "FAIL"),
        (BeforeAfterCheckBlock(kind="before_after", event=0, signal="path_error.cross_track", statistic="max",
                               before_s=1.0, after_s=2.0, at_most=0.5), (3.0, 3.5), "ERROR"),
        (BeforeAfterCheckBlock(kind="before_after", event=0, signal="path_error.cross_track", statistic="max",
                               before_s=1.0, after_s=2.0, at_most=0.5), (5.0, 5.5), "PASS"),
        (PathEndCheckBlock(kind="path_end", reach_m=0.001), (3.0, 4.0), "ERROR"),
        (AllowedForcesCheckBlock(kind="allowed_forces"), (7.5, 8.0), "ERROR"),
    ],
)  # fmt: skip
def test_what_the_rows_show_is_said_and_no_more(check, gap, verdict):
    _, (result,), _ = judged(without(*gap), [check])
    assert result.verdict == verdict, result.detail
    told, results, remarks = judged(without(*gap), [check])
    assert told == ("FAIL" if verdict == "FAIL" else "ERROR")  # the whole is never a PASS
    assert remarks == ("recovered",)
    assert ("nothing is recorded from" in results[0].detail) == (verdict == "ERROR")


def test_rows_that_one_channel_alone_lacks_count_as_well():
    check = cross_track("max", at_most=0.95)
    assert judged(without(3.0, 4.0, channel="path_error"), [check])[1][0].verdict == "ERROR"
    assert judged(without(3.0, 4.0, channel="pose"), [check])[1][0].verdict == "PASS"


def test_a_run_that_was_interrupted_fails_by_what_was_flown_and_never_passes():
    run = without(7.5, 11.0, how="interrupted", simulated_s=7.5)
    verdict, (fails, passes), _ = judged(run, [cross_track("max", at_most=0.5), cross_track("max", at_most=0.95)])
    assert (verdict, fails.verdict, passes.verdict) == ("FAIL", "FAIL", "ERROR")


def test_forces_out_of_their_sets_are_shown_before_a_gap_alone():
    """Behind it the limits may be others, told in rows that are lost."""
    check = AllowedForcesCheckBlock(kind="allowed_forces")
    for gap, verdict in (((7.5, 8.0), "FAIL"), ((3.0, 4.0), "ERROR")):
        run = without(*gap)
        thrusters = run.recording.rows["thrusters"]
        thrusters[thrusters[:, 0] == 6.0, 2] = 60.0
        assert judged(run, [check])[1][0].verdict == verdict


def test_what_was_altered_shows_nothing():
    run = without(20.0, 21.0)
    checks = [cross_track("max", at_most=0.5), cross_track("max", at_most=0.95)]
    for end, flaw in ((run.end, f"{ALTERED}: so"), (replace(run.end, reason=f"{ALTERED}: so"), "recovered")):
        changed = replace(run, recording=replace(run.recording, end=end, flaw=flaw))
        verdict, results, _ = judged(changed, checks)
        assert (verdict, [each.verdict for each in results]) == ("ERROR", ["ERROR", "ERROR"])
