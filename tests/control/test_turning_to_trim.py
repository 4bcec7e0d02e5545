"""A hull that is far from the trim of its course turns there first, evenly, and comes to fly its line in it."""

from __future__ import annotations

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY, thruster_event, values

import cube_sim
from cube_sim.control.turning_to_trim import FAR_RAD, TURNING_RAD_S, TurningToTrim
from cube_sim.spatial import rotation_about, rotation_from_quaternion

SPEED_M_S = 0.19


def angle(R, other):
    return float(np.arccos(np.clip((np.trace(R.T @ other) - 1.0) / 2.0, -1.0, 1.0)))


def test_the_attitude_turns_evenly_and_ends_in_the_trim():
    trim = rotation_about(np.array([0.0, 0.0, 1.0]), 1.5)
    way, before = TurningToTrim(np.eye(3), trim, 1.0), np.eye(3)
    for _ in range(500):
        R = rotation_from_quaternion(way.attitude(_nowhere(), 0.02).quaternion)
        assert angle(before, R) <= 0.02 * TURNING_RAD_S * 1.001
        before = R
    assert angle(before, trim) < 0.01


def test_it_turns_no_faster_than_the_hull_can():
    way = TurningToTrim(np.eye(3), rotation_about(np.array([1.0, 0.0, 0.0]), 1.5), 0.1)
    assert np.linalg.norm(way.attitude(_nowhere(), 0.02).rates) == pytest.approx(0.1)


def test_a_hull_near_its_trim_has_no_way_to_go():
    for turned, far in ((0.9 * FAR_RAD, False), (1.1 * FAR_RAD, True)):
        assert TurningToTrim.is_far(np.eye(3), rotation_about(np.array([0.0, 0.0, 1.0]), turned)) is far


@pytest.mark.flight
@pytest.mark.parametrize("dead", [["T1", "T3"], ["T2", "T4"]])
def test_a_hull_of_three_thrusters_keeps_its_line(dead, tmp_path):
    """Sent to its trim at once it swung about its line by 0.4 to 0.7 m for ever."""
    model = tmp_path / "model.xml"
    model.write_text(catalogue()["five_three_hulls"].make())
    scenario = {
        "schema_version": 1,
        "name": "three_left",
        "description": "A level line, half a metre off at the start.",
        "model": str(model),
        "duration_s": 100.0,
        "path": {"type": "line", "start_m": [0, 0, -20], "end_m": [60, 0, -20]},
        "initial": {"position_m": [0, 0.5, -20]},
        "guidance": {"speed_m_s": SPEED_M_S},
        "control": {"faults": "told"},
        "events": [thruster_event(0.0, dead)],
        "checks": FORCES_ONLY,
    }
    run = cube_sim.fly(scenario, record="none")
    late = values(run)["path_error.cross_track"][3500:, 0]
    assert len(late) > 1000
    assert np.sqrt(np.mean(late**2)) < 0.03


def _nowhere():
    from cube_sim.control.attitude_mode import Situation

    nothing = np.zeros(3)
    return Situation(None, np.eye(3), nothing, nothing, nothing, np.eye(6), 1.0, nothing)
