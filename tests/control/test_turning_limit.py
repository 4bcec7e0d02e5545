"""Turns that a path asks for and a vehicle does not keep: said beforehand, in the analysis and in the run."""

from __future__ import annotations

import json

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY
from support.places import SCENARIOS
from support.vehicles import vehicle

import cube_sim
from cube_sim.commands.analysis_report import report_on, to_dict
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.turning_limit import too_tight, turning_of
from cube_sim.control.yielding import WaterHold
from cube_sim.wrench.health import Health

TIGHT = {
    "duration_s": 0.2,
    "checks": FORCES_ONLY,
    "path": {"type": "circle", "centre_m": [0.0, 0.0, -8.0], "radius_m": 0.6},
    "guidance.speed_m_s": 0.4,
}


def left_of(hull, speed_m_s):
    whole = Health.whole(len(hull.thrusters.names))
    hold = WaterHold.of(hull.dynamics, speed_m_s)
    return remaining_capability(hull.actuation_matrix, hull.thrusters.limits, whole, hold=hold)


def test_a_torpedo_says_which_turns_are_too_tight():
    hull = vehicle("torpedo")
    left = left_of(hull, 0.4)
    widest = turning_of(left, hull.dynamics, 0.4)
    assert widest is not None
    assert 1.0 < widest.radius_m < 2.0
    assert too_tight(left, hull.dynamics, 0.4, 3.0) is None
    assert too_tight(left, hull.dynamics, 0.4, np.inf) is None
    said = too_tight(left, hull.dynamics, 0.4, 0.6)
    assert said is not None
    assert said.startswith("the path turns within 0.6 m, and at 0.4 m/s the thrusters keep turns of 1.")


def test_a_vehicle_with_all_it_needs_says_nothing():
    hull = vehicle("cube")
    assert too_tight(left_of(hull, 0.4), hull.dynamics, 0.4, 0.6) is None


def test_the_analysis_says_the_same(tmp_path):
    (tmp_path / "hull.xml").write_text(catalogue()["five_survey-T1"].make())
    report = report_on(tmp_path / "hull.xml", lost="T1", speed_m_s=0.187)
    turning = to_dict(report)["turning"]
    assert turning["radius_m"] == 0.5
    assert np.degrees(turning["heading_rad"]) == pytest.approx(75.0, abs=2.0)
    assert to_dict(report_on(tmp_path / "hull.xml", lost="T1,T2,T3"))["turning"] is None


@pytest.mark.flight
def test_a_run_warns_of_them_before_it_flies():
    run = cube_sim.run(SCENARIOS / "torpedo_helix.yaml", TIGHT)
    assert [line.text for line in run.log if "the path turns within 0.6 m" in line.text]
    wide = TIGHT | {"path": TIGHT["path"] | {"radius_m": 4.0}}
    run = cube_sim.run(SCENARIOS / "torpedo_helix.yaml", wide)
    assert not [line.text for line in run.log if "turns within" in line.text]


@pytest.mark.flight
def test_a_hull_that_turns_in_one_trim_only_takes_that_one(tmp_path):
    """Five thrusters without the first: level and ahead is no trim, and of the others one is left on a curve."""
    (tmp_path / "hull.xml").write_text(catalogue()["five_survey-T1"].make())
    run = cube_sim.run(
        SCENARIOS / "cube_helix.yaml",
        {
            "model": str(tmp_path / "hull.xml"),
            "duration_s": 90.0,
            "checks": FORCES_ONLY,
            "current_m_s": [0.0, 0.0, 0.0],
            "guidance.speed_m_s": 0.187,
            "initial": {"position_m": [3.5, 0.0, -8.0], "attitude_deg": [0.0, 0.0, 90.0]},
            "control": {"faults": "told"},
            "events": [{"kind": "thrusters", "at_s": 0.0, "thrusters": ["T1"], "state": "dead"}],
        },
    )
    rows = run.signals["path_error.cross_track"]
    assert np.sqrt(np.mean(rows[rows[:, 0] >= 70.0, 1] ** 2)) < 0.03


@pytest.mark.flight
def test_an_attitude_that_is_not_along_the_course_is_left_to_the_search_for_balance(tmp_path):
    """The wish is ahead at one side of the circle and astern at the other; a trim for each makes it jump, 0.7 m off."""
    (tmp_path / "hull.xml").write_text(catalogue()["torpedo_four_fins"].make())
    mission = {
        "schema_version": 1,
        "name": "across",
        "model": "hull.xml",
        "duration_s": 120.0,
        "path": {"type": "circle", "centre_m": [0.0, 0.0, -20.0], "radius_m": 4.33, "direction": "right"}
        | {"axis": [0.19, 0.01, 0.98], "start_angle_deg": 168.5},
        "initial": {"position_m": [-3.98, 0.54, -18.24], "attitude_deg": [0.0, 0.0, 196.6]},
        "guidance": {"speed_m_s": 0.1},
        "control": {"attitude": {"mode": "fixed", "attitude_deg": [0.0, 0.0, 121.2]}},
        "checks": FORCES_ONLY,
    }
    (tmp_path / "across.yaml").write_text(json.dumps(mission))
    rows = cube_sim.run(tmp_path / "across.yaml").signals["path_error.cross_track"]
    assert np.sqrt(np.mean(rows[rows[:, 0] >= 70.0, 1] ** 2)) < 0.02
