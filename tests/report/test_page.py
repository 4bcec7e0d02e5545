"""The page: well formed, alone, the same every time, and saying what the run says."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from support.synthetic_run import LIMIT_M, synthetic_run

from cube_sim.recording.run_end import RunEnd
from cube_sim.report.check_panels import check_panels
from cube_sim.report.circumstances import circumstances
from cube_sim.report.happenings import happenings
from cube_sim.report.motion_panels import DEAD_ZONE
from cube_sim.report.page import report
from cube_sim.report.parameters import set_parameters
from cube_sim.report.subject import NO_VERDICT, Subject
from cube_sim.report.thruster_use import UNKNOWN, UPPER
from cube_sim.run_log import LogLine
from cube_sim.runs.judging import judged


def subject(**options):
    return Subject(synthetic_run(**options), "run", "#000")


def parsed(page):
    """The page as XML, which every browser's HTML parser reads alike."""
    assert page.startswith("<!DOCTYPE html>\n")
    return ET.fromstring(page.partition("\n")[2])


def words(page):
    return " ".join(" ".join(parsed(page).find("body").itertext()).split())


@pytest.fixture(scope="module")
def page():
    return report([synthetic_run()], ["made_up"])


def test_it_is_well_formed_and_has_every_section(page):
    root = parsed(page)
    sections = [section.get("id") for section in root.iter("section")]
    assert sections == [
        *("checks", "events", "margins", "path", "errors", "thrusters", "wrench", "velocity", "power", "water", "log"),
        *("parameters", "build"),
    ]
    assert [link.get("href") for link in root.find("body/nav")] == [f"#{name}" for name in sections]
    plots = [svg for svg in root.iter("svg") if "time" in (svg.get("class") or "")]
    assert len(plots) > 15
    # What happened is marked on every plot over time: the event, the belief.
    assert {sum(path.get("class") == "m" for path in plot.iter("path")) for plot in plots} == {2}


def test_it_needs_nothing_beside_it(page):
    assert not re.search(r"https?:|\bfile:|@import|url\((?!#)|//[a-z]", page)
    root = parsed(page)
    for element in root.iter():
        assert element.tag not in ("link", "img", "iframe", "object", "image", "use")
        assert "src" not in element.attrib
        assert element.get("href", "#").startswith("#")


def test_the_same_run_gives_the_same_bytes(page):
    assert report([synthetic_run()], ["made_up"]) == page
    assert "nowhere" not in page


def test_it_is_small(page):
    assert len(page.encode()) < 300_000


def test_it_says_why_it_fails(page):
    said = words(page)
    assert "made_up FAIL" in said
    assert "Beyond the limit from 6.2 s : T3 at its upper limit since 6 s; T1 dead or stuck, since 2 s" in said
    assert "Worst at 6.6 s : T3 at its upper limit since 6 s; T1 dead or stuck, since 2 s" in said
    assert f"FAIL cross-track error: 0.9, must be ≤ {LIMIT_M}, margin −0.4, worst at 6.6 s" in said
    assert "PASS thruster forces inside their allowed sets: 0 ≤ 1e−6" in said
    assert "2 s event T1: dead" in said
    assert "2.5 s belief the controller believes: T1 dead" in said
    assert "control.velocity_time_s 0.7 none" in said


def test_the_circumstances_are_those_of_the_time():
    run = subject()
    assert circumstances(run, 1.0) == []
    assert circumstances(run, 2.2) == ["T1 dead or stuck, believed to give 100 %, since 2 s", "at 2 s: T1: dead"]
    assert circumstances(run, 9.0) == ["T1 dead or stuck, since 2 s", "T3 at its upper limit for 1 s of the 5 s before"]


def test_time_at_a_limit_is_counted():
    third = subject().thrusters[2]
    assert third.time_in(UPPER) == pytest.approx(1.0)
    ((start, end),) = third.spans(UPPER)
    assert (start, end) == pytest.approx((6.0, 7.0))
    assert third.energy_J == pytest.approx(20.0 * 10.02)


def test_what_happened_is_in_the_order_of_time():
    assert [(each.t, each.kind) for each in happenings(subject())] == [(2.0, "event"), (2.5, "belief")]
    cut = happenings(subject(complete=False, until_s=1.5))
    assert [(each.t, each.kind) for each in cut] == [(1.5, "end")]


def test_an_event_that_ends_the_flight_at_once_is_told():
    """Its last row is that of the period before."""
    run = synthetic_run(until_s=1.98, log=(LogLine(2.0, "ERROR", "left all bounds: the run ends here"),))
    ended = replace(run, recording=replace(run.recording, end=RunEnd("ended early", "left all bounds", 100, 2.0)))
    told = [(each.t, each.kind, each.text) for each in happenings(Subject(ended, "run", "#000"))]
    assert told == [(2.0, "event", "T1: dead"), (2.0, "end", "the run ends: left all bounds")]


def test_a_check_whose_window_was_not_reached_is_drawn_on_all_that_was_flown():
    run = synthetic_run(until_s=0.5)
    asked = replace(run.header, resolved=run.header.resolved.replace("at_most: 0.5", "at_most: 0.02"))
    short = replace(run, recording=replace(run.recording, header=asked))
    panel = check_panels([Subject(short, "run", "#000")])[0]
    assert (panel.logarithmic, panel.focus) == (False, None)


@pytest.mark.parametrize(
    ("options", "verdict", "remark"),
    [
        ({}, "FAIL", None),
        ({"verdict": "PASS"}, "FAIL", "verdict.json says PASS; judged from the record now, it is FAIL"),
        ({"verdict": None}, NO_VERDICT, "nothing says what it was judged; judged from the record now, it is FAIL"),
        ({"verdict": ["PASS"]}, "FAIL", "verdict.json says"),
        ({"verdict": "PASS", "complete": False, "until_s": 4.0}, "ERROR", "the record ends early, at 4 s of 10 s"),
        ({"verdict": "PASS", "until_s": 4.0}, "ERROR", "judged from the record now, it is ERROR"),
        (
            {"verdict": "ERROR", "until_s": 4.0, "log": (LogLine(4.0, "ERROR", "left all bounds"),)},
            "ERROR",
            "ended early, at 4 s: left all bounds",
        ),
    ],
)
def test_it_passes_only_what_passed(options, verdict, remark):
    said = words(report([synthetic_run(**options)], ["run"]))
    assert f"made_up {verdict}" in said
    assert subject(**options).verdict == verdict
    assert remark is None or remark in said


def test_sensors_show_what_they_said_and_what_was_kept_out():
    page = report([synthetic_run(navigated=True)], ["run"])
    plots = {svg.get("aria-label"): svg for svg in parsed(page).iter("svg")}
    said = words(page)
    assert "position 21 1 0 0.245 m" in said
    assert "position estimate off by 0.3 m" in said
    assert len([path for path in plots["position: innovation"].iter("path") if path.get("class") == "k"]) == 3
    texts = [element.text for element in plots["Error of the estimated position, y"].iter("text")]
    assert "± 2 sigma of the filter" in texts
    assert "95 % stay below" in [element.text for element in plots["position: surprise, chi-square"].iter("text")]


def test_bands_follow_the_limits_over_time():
    """The dead zone of a thruster that is believed lost from 2.5 s on ends there."""
    plots = {svg.get("aria-label"): svg for svg in parsed(report([synthetic_run()], ["run"])).iter("svg")}

    def ends(name, colour):
        (path,) = [path for path in plots[name].iter("path") if path.get("fill") == colour]
        d = path.get("d")
        first = int(re.match(r"M(-?\d+)", d)[1])
        steps = [int(x) for x in re.findall(r"-?\d+", d.partition("l")[2])][0::2]
        return (first + max(np.cumsum(steps))) / (10 * (532 - 62 - 14)) * 10.0

    assert ends("T2", DEAD_ZONE) == pytest.approx(10.0, abs=0.05)
    assert ends("T1", DEAD_ZONE) == pytest.approx(2.5, abs=0.05)


def test_a_record_without_rows_is_reported():
    said = words(report([synthetic_run(until_s=-1.0, complete=False, verdict=None)], ["run"]))
    assert "recorded to" in said
    assert f"made_up {NO_VERDICT}" in said


def test_a_record_that_ends_before_its_first_channel_is_reported():
    run = synthetic_run(complete=False, verdict="PASS")
    nothing = replace(run, recording=replace(run.recording, channels=(), rows={}, log=()))
    page = report([nothing], ["run"])
    assert "made_up ERROR the record ends early, at 0 s of 10 s" in words(page).replace("none ", "", 1)
    assert next(section.get("id") for section in parsed(page).iter("section")) == "checks"
    # Beside a whole one it takes nothing from it.
    assert "T3" in {svg.get("aria-label") for svg in parsed(report([run, nothing], ["whole", "none"])).iter("svg")}


def test_what_comes_from_files_is_text():
    evil = "<script>alert(1)</script>&\x07"
    run = synthetic_run(description="'<img src=x onerror=alert(1)>'", log=(LogLine(1.0, "INFO", evil),))
    page = report([run], ["<b>label"])
    root = parsed(page)
    assert len(list(root.iter("script"))) == 1
    assert list(root.iter("img")) == []
    assert "<script>alert(1)</script>&\ufffd" in words(page)


def test_no_numbers_are_gaps():
    run = synthetic_run()
    for rows in run.recording.rows.values():
        rows[100:200, 2:] = np.nan
        rows[300:301, 2:] = np.inf
    assert "nan" not in re.sub(r"<script>.*</script>", "", report([run], ["run"]), flags=re.DOTALL).lower()


def with_gap(start=3.0, end=4.0):
    """The run, what was recorded in between being lost."""
    run = synthetic_run(verdict=None)
    rows = {name: r[(r[:, 0] < start) | (r[:, 0] >= end)] for name, r in run.recording.rows.items()}
    recording = replace(run.recording, rows=rows, end=RunEnd("recovered"), flaw="recovered: a chunk is lost")
    return replace(run, recording=recording)


def test_what_is_not_recorded_is_not_drawn_as_flown():
    run = with_gap()
    assert run.missing_s == ((3.0, 4.0),)
    page = report([run], ["run"])
    assert "not recorded: 3 s to 4 s, 1 s in all" in words(page)
    assert "the record ends here" not in page
    for svg in parsed(page).iter("svg"):
        if "time" in (svg.get("class") or ""):
            hatched = [rect for rect in svg.iter("rect") if rect.get("class") == "gap"]
            assert len(hatched) == 1
            if "Cross-track error" in svg.get("aria-label"):
                (curve,) = (path for path in svg.iter("path") if path.get("class") == "c")
                assert curve.get("d").count("M") == 2
    plan = next(svg for svg in parsed(page).iter("svg") if svg.get("class") == "plan")
    (track,) = (path for path in plan.iter("path") if path.get("class") == "c")
    assert track.get("d").count("M") == 2
    whole = report([synthetic_run(verdict=None)], ["run"])
    assert "not recorded" not in words(whole)
    assert 'class="gap"' not in whole
    one = Subject(run, "run", "#000")
    assert [use.time_in(UNKNOWN) for use in one.thrusters] == pytest.approx([0.02] * 3)
    assert [each.kind for each in happenings(one)] == [each.kind for each in happenings(subject())]


def test_a_check_is_not_shown_to_hold_where_nothing_is_recorded():
    verdict, (cross_track, forces), _ = judged(with_gap())
    assert (verdict, cross_track.verdict, forces.verdict) == ("FAIL", "FAIL", "ERROR")
    assert forces.detail.endswith("nothing is recorded from 3 s to 4 s")
    verdict, (cross_track, forces), _ = judged(with_gap(6.0, 7.5))
    assert (verdict, cross_track.verdict, forces.verdict) == ("ERROR", "ERROR", "ERROR")


def test_a_check_that_cannot_be_judged_says_why():
    for page in (report([with_gap(6.0, 7.5)], ["run"]), report([with_gap(6.0, 7.5), synthetic_run()], ["a", "b"])):
        assert words(page).count("nothing is recorded from 6 s to 7.5 s") == 2


def test_several_runs_share_their_plots():
    runs = [synthetic_run(), synthetic_run(name="other", noise=3.0, complete=False, until_s=8.0)]
    page = report(runs, ["first", "second"])
    root = parsed(page)
    plot = next(svg for svg in root.iter("svg") if svg.get("aria-label") == "T2")
    colours = {path.get("stroke") for path in plot.iter("path") if (path.get("class") or "").startswith("c")}
    assert len(colours) == 2
    header = [cell.text for cell in root.find("body/section[@id='checks']").iter("th")]
    assert header == [None, "first", "second"]
    said = words(page)
    assert "second: the record ends early, at 8 s of 10 s" in said
    assert "8 s end the record ends here second" in said
    # The event of both is told once.
    assert said.count("T1: dead all") == 1


def test_parameters_that_are_not_the_default():
    found = {each.key: (each.value, each.default) for each in set_parameters(synthetic_run().scenario)}
    assert found["control.velocity_time_s"] == ("0.7", "none")
    assert found["guidance.speed_m_s"] == ("0.4", None)
    assert found["path.type"] == ("line", None)
    assert found["duration_s"] == ("10", None)
    assert not any(key.startswith(("control.attitude", "allocation", "physics", "checks")) for key in found)
