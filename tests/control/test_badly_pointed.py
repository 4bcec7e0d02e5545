"""A vehicle that would have to turn far for little is not said to follow a path, by the analysis and by the run."""

from __future__ import annotations

import pytest
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY, thruster_event, values

import cube_sim
from cube_sim.commands.analysis_report import report_on

WORDS = "no attitude points the thrust well on a level course"
SPEED_M_S = 0.4


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """Two thrusters astern, two verticals to the sides: without one astern the other turns it as hard as it pushes."""
    path = tmp_path_factory.mktemp("abeam") / "abeam.xml"
    path.write_text(catalogue()["four_astern_verticals_abeam"].make())
    return path


@pytest.mark.parametrize(("dead", "follows"), [("T1", False), ("T2", False), ("T3", True)])
def test_the_analysis_says_no_where_a_little_force_takes_a_large_turn(model, dead, follows):
    verdict = report_on(model, lost=dead, speed_m_s=SPEED_M_S).analysis.verdict
    assert verdict.follows is follows
    assert (WORDS in verdict.reason) is not follows


def test_the_table_of_losses_says_the_same(model):
    table = report_on(model, losses=1, speed_m_s=SPEED_M_S).table
    said = {case.lost: case.verdict.follows for case in table.cases if len(case.lost) == 1}
    assert said == {("T1",): False, ("T2",): False, ("T3",): True, ("T4",): True}


@pytest.mark.parametrize(("dead", "follows"), [("T1", False), ("T3", True)])
def test_the_run_says_it_too_and_flies_accordingly(model, tmp_path, dead, follows):
    scenario = {
        "schema_version": 1,
        "name": "abeam",
        "description": "A level line, half a metre off at the start.",
        "model": str(model),
        "duration_s": 66.0,
        "path": {"type": "line", "start_m": [0, 0, -20], "end_m": [60, 0, -20]},
        "initial": {"position_m": [0, 0.5, -20]},
        "guidance": {"speed_m_s": SPEED_M_S},
        "control": {"faults": "told"},
        "events": [thruster_event(0.0, [dead])],
        "checks": FORCES_ONLY,
    }
    run = cube_sim.fly(scenario, record="none")
    arc = values(run)["target.arc_length"][:, 0]
    assert any(WORDS in line.text for line in run.log) is not follows
    assert bool(arc[-1] - arc[len(arc) // 2] > 0.5 * SPEED_M_S * 33.0) is follows
