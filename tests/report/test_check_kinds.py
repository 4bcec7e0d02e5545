"""What each kind of check judges is drawn over its window, with the limit where it is a number of the plot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.synthetic_run import synthetic_run

from cube_sim.report import colours
from cube_sim.report.check_panels import check_panels
from cube_sim.report.guides import captions, drawn_levels
from cube_sim.report.subject import Subject
from cube_sim.report.tables import check_table


def subject(check):
    """The synthetic run, judged by one check instead of its own."""
    run = synthetic_run()
    resolved = run.header.resolved
    resolved = f"{resolved[: resolved.index('checks:')]}checks:\n  - {check}\n"
    header = replace(run.header, resolved=resolved)
    return Subject(replace(run, recording=replace(run.recording, header=header)), "a", colours.BLUE)


ERROR = "signal: path_error.cross_track"


@pytest.mark.parametrize(
    ("check", "title", "levels", "windows", "said"),
    [
        (f"{{kind: signal, {ERROR}, statistic: percentile, percent: 90, at_most: 0.6, from_s: 1}}",
         "path_error.cross_track", (0.6,), [], "≤ 0.6, margin"),
        (f"{{kind: signal, {ERROR}, statistic: share_above, level: 0.5, at_most: 0.2, to_s: 8}}",
         "path_error.cross_track", (0.5,), [(0.0, 8.0)], "≤ 0.2, margin"),
        (f"{{kind: signal, {ERROR}, statistic: settling, band: [0, 0.4], at_most: 8}}",
         "path_error.cross_track", (0.0, 0.4), [], "≤ 8 s, margin"),
        ("{kind: signal, signal: power.motor, combine: sum, statistic: integral, at_most: 700}",
         "sum of power.motor", (), [], "≤ 700 J, margin"),
        ("{kind: signal, signal: actuation.limits, component: 3, statistic: min, at_most: 1, from_event: 0, to_s: 9}",
         "actuation.limits.T1/F_max+", (1.0,), [], "≤ 1, margin"),
        (f"{{kind: always, all: [{{{ERROR}, at_most: 1}}]}}", "path_error.cross_track", (1.0,), [], "≤ 1, margin"),
        (f"{{kind: eventually, any: [{{{ERROR}, at_least: 0.8}}, {{signal: pose.position, at_least: 9}}]}}",
         "Margin of: path_error.cross_track >= 0.8 or pose.position >= 9", (0.0,), [], "≥ 0, margin"),
        (f"{{kind: before_after, event: 0, {ERROR}, statistic: max, before_s: 1, after_s: 5, at_most: 1}}",
         "path_error.cross_track", (), [(1.0, float(np.nextafter(2.0, 0.0))), (2.0, 7.0)], "≤ 1 m, margin"),
    ],
)  # fmt: skip
def test_a_check_is_drawn_on_what_it_judges(check, title, levels, windows, said):
    drawn = subject(check)
    assert drawn.results[0].verdict == "PASS", drawn.results[0].detail
    (panel,) = check_panels([drawn])
    (guide,) = panel.guides
    assert (panel.title, drawn_levels(guide)) == (title, levels)
    assert [(shade.start_s, shade.end_s) for shade in panel.shades] == windows
    ((words, _),) = captions(panel)
    assert said in words
    assert len(panel.curves[0].times)
    assert panel.curves[0].steps == title.startswith("actuation")
    assert drawn.results[0].name.split("[")[0].replace("<", "&lt;").replace(">", "&gt;")[:8] in check_table(drawn)


def test_both_signals_of_a_ratio_are_drawn():
    above = "{signal: power.motor, statistic: mean, from_s: 1, to_s: 3}"
    below = "{signal: pose.position, component: 0, statistic: final}"
    drawn = subject(f"{{kind: ratio, name: so, numerator: {above}, denominator: {below}, at_most: 20}}")
    panels = check_panels([drawn])
    assert [panel.title for panel in panels] == ["|power.motor|", "pose.position.x"]
    assert [[(s.start_s, s.end_s) for s in panel.shades] for panel in panels] == [[(1.0, 3.0)], []]
    assert all("≤ 20 W/m" in captions(panel)[0][0] for panel in panels)


def test_a_baseline_that_is_not_at_hand_leaves_an_empty_plot():
    drawn = subject(f"{{kind: baseline, record: nowhere, {ERROR}, tolerance: 1}}")
    assert drawn.results[0].verdict == "ERROR"
    (panel,) = check_panels([drawn])
    assert not len(panel.curves[0].times)
    assert "no such file" in check_table(drawn)
