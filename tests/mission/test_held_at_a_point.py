"""What the water holds of a hull that stays in a place is asked at the speed of the water, not of a path."""

from __future__ import annotations

import pytest
from support.catalogue.known import AHEAD, LEFT, UP, pair
from support.catalogue.mjcf import Layout, Thruster, box_hull, mjcf
from support.flights import FORCES_ONLY, thruster_event, values

import cube_sim
from cube_sim.control.authority import Authority


def survey_hull():
    """Two thrusters astern, two verticals in line, one to the side: without a vertical, heave comes with pitch."""
    hull = box_hull(45.0, (1.1, 0.5, 0.5), 0.03, added_share=0.7)
    verticals = Thruster((0.4, 0, 0), UP), Thruster((-0.35, 0, 0), UP)
    return Layout(hull, [*pair(-0.45, 0.2, 0, AHEAD), *verticals, Thruster((0.1, 0, 0), LEFT)], lag_s=0.05)


@pytest.fixture(scope="module")
def scenario(tmp_path_factory):
    model = tmp_path_factory.mktemp("five") / "five.xml"
    model.write_text(mjcf("five", survey_hull()))
    return {
        "schema_version": 1,
        "name": "point",
        "description": "A point, half a metre off at the start.",
        "model": str(model),
        "duration_s": 50.0,
        "path": {"type": "point", "position_m": [0, 0, -20]},
        "initial": {"position_m": [0.5, -0.5, -20.5]},
        "control": {"faults": "told"},
        "events": [thruster_event(0.0, ["T4"])],
        "checks": FORCES_ONLY,
    }


def flown(scenario, **more):
    run = cube_sim.fly(scenario, {"guidance.speed_m_s": 0.4, **more}, record="none")
    signals = values(run)
    off = signals["pose.position"] - signals["target.position"]
    return Authority(int(signals["health.authority"][-1, 0])), abs(off[-500:]).max()


@pytest.mark.parametrize("current", [[0.0, 0.0, 0.0], [0.0, 0.1, 0.0]])
def test_a_point_is_held_at_trim_however_fast_a_path_would_be(scenario, current):
    """Asked at 0.4 m/s, its attitude had to point the thrust, where there is next to nothing to push against."""
    authority, off = flown(scenario, current_m_s=current)
    assert authority is Authority.TRIM
    assert off < 0.02


def test_water_that_will_move_counts_from_the_start(scenario):
    later = [*scenario["events"], {"kind": "current", "at_s": 45.0, "current_m_s": [0.0, 0.0, 0.4]}]
    assert flown(scenario | {"events": later})[0] is not Authority.TRIM
