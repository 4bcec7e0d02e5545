"""Where the thrusters are short at any pace, a vehicle does not stand for ever."""

from __future__ import annotations

import pytest
from support.catalogue.known import UP, pair, vectored
from support.catalogue.mjcf import Layout, box_hull, mjcf
from support.flights import FORCES_ONLY, thruster_event, values

import cube_sim
from cube_sim.control.pace import LEAST_PACE

STRONGEST_N, SPEED_M_S = 360.0, 0.4


@pytest.fixture(scope="module")
def stuck(tmp_path_factory):
    """A box with 30 N of thrust per kilogram and thruster on a line, one horizontal thruster stuck at its limit."""
    hull = box_hull(12.0, (0.4, 0.35, 0.3), 0.02, added_share=0.7)
    layout = Layout(hull, [*vectored(0.15, 0.12, 0.0), *pair(0.0, 0.14, 0.03, UP)], STRONGEST_N, 0.05)
    model = tmp_path_factory.mktemp("box") / "box.xml"
    model.write_text(mjcf("box", layout))
    scenario = {
        "schema_version": 1,
        "name": "box",
        "description": "A line, T1 stuck at its limit from 20 s on.",
        "model": str(model),
        "duration_s": 80.0,
        "path": {"type": "line", "start_m": [0, 0, -20], "end_m": [60, 0, -20]},
        "initial": {"position_m": [0, 0.5, -20]},
        "guidance": {"speed_m_s": SPEED_M_S},
        "control": {"faults": "told"},
        "events": [thruster_event(20.0, ["T1"], "stuck", force_N=STRONGEST_N)],
        "checks": FORCES_ONLY,
    }
    return cube_sim.fly(scenario, record="none")


def test_it_goes_on_along_its_path(stuck):
    """It stood: what is stuck leaves no pace within the reserve, 0 no more than any other."""
    arc = values(stuck)["target.arc_length"][:, 0]
    assert arc[-1] - arc[len(arc) // 2] > 0.8 * LEAST_PACE * SPEED_M_S * 40.0


def test_it_stays_near_its_path_and_says_how_slowly_it_goes_on(stuck):
    off = values(stuck)["path_error.cross_track"][:, 0]
    assert off[-1000:].max() < 0.2
    assert any("it goes on at 0.1" in line.text for line in stuck.log)
