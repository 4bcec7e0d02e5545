"""Where trims leave a doubt of a hull that points its thrust, the analysis says what comes of it on a level line."""

from __future__ import annotations

import pytest
from support.catalogue.vehicles import catalogue

from cube_sim.commands import as_flown, flown_course
from cube_sim.commands.analysis_report import report_on
from cube_sim.commands.flown_course import WITHIN_M, flown_off_m, leaves_course

SPEED_M_S = 0.4


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """Flat, 2.6 times its critical speed: without two thrusters some attitudes are steady, some swing for ever."""
    path = tmp_path_factory.mktemp("flat") / "flat.xml"
    path.write_text(catalogue()["drawn6_0"].make())
    return path


@pytest.mark.flight
def test_a_hull_that_swings_about_its_line_is_said_to_follow_it_more_slowly(model):
    verdict = report_on(model, lost="T1,T2", speed_m_s=SPEED_M_S).analysis.verdict
    assert not verdict.follows
    assert "flown on a level line at 0.4 m/s, it stays 0." in verdict.reason
    assert "at 0.2 m/s it follows" in verdict.reason
    assert flown_off_m(model, ("T1", "T2"), 0.5 * SPEED_M_S) <= WITHIN_M


@pytest.mark.flight
def test_one_that_keeps_it_is_said_to(model):
    assert report_on(model, lost="T2,T4", speed_m_s=SPEED_M_S).analysis.verdict.follows


@pytest.mark.flight
def test_the_table_of_losses_says_the_same(model):
    table = report_on(model, lost="T1", losses=1, speed_m_s=SPEED_M_S).table
    said = {case.lost: case.verdict.follows for case in table.cases if len(case.lost) == 1}
    assert not said["T2",]
    assert said["T3",]
    assert said["T5",]


@pytest.mark.flight
def test_one_that_comes_to_its_line_slowly_is_waited_for(tmp_path, monkeypatch):
    """At 0.3 m/s a turn of this torpedo brings hardly any force: z is 1 / 13 s, and it comes as exp(-t / 75 s)."""
    torpedo = tmp_path / "torpedo.xml"
    torpedo.write_text(catalogue()["torpedo"].make())
    assert flown_off_m(torpedo, (), 0.3) <= WITHIN_M
    monkeypatch.setattr(flown_course, "MOST_TIMES", 1)
    assert WITHIN_M < flown_off_m(torpedo, (), 0.3) < 2.0 * WITHIN_M


def test_a_model_that_no_scenario_flies_is_judged_without(tmp_path):
    assert leaves_course(tmp_path / "nowhere.xml", (), SPEED_M_S) is None


def test_a_hull_whose_trim_leaves_no_doubt_is_not_flown(tmp_path, monkeypatch):
    model = tmp_path / "model.xml"
    model.write_text(catalogue()["drawn6_1"].make())
    monkeypatch.setattr(as_flown, "leaves_course", lambda *_: pytest.fail("flown"))
    assert report_on(model, lost="T1,T4", speed_m_s=SPEED_M_S).analysis.verdict.follows
