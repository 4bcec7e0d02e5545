"""Turns that fins do not make in a current are told before the flight, and only those."""

from __future__ import annotations

import numpy as np
import pytest
from support.drawn_torpedo import drawn_torpedo
from support.places import SCENARIOS

from cube_sim.control.course_keeping import CourseKeeping
from cube_sim.control.tight_turns import tightest_turn
from cube_sim.flight import Flight

LINE = SCENARIOS / "remus100_line.yaml"
TOLD = "times as fast"
FORCES = [{"kind": "allowed_forces"}]


def changes_of(seed, tmp_path, current, radius):
    """Square corners, their radius by lengths, the current by shares of the speed; length [m] and speed [m/s]."""
    drawn = drawn_torpedo(seed)
    L, u, z = drawn.length_m, drawn.speed_m_s, -60.0
    (tmp_path / "drawn.xml").write_text(drawn.text)
    points = [[0, 0, z], [30 * L, 0, z], [30 * L, 30 * L, z], [0, 30 * L, z], [0, 0, z]]
    return (
        {
            "model": str(tmp_path / "drawn.xml"),
            "parameters": {},
            "duration_s": round(110 * L / u, 1),
            "initial": {"position_m": [0.0, 0.0, z], "velocity_m_s": [u, 0.0, 0.0]},
            "path": {"type": "polyline", "points_m": points, "corner_radius_m": radius * L},
            "guidance": {"speed_m_s": u, "stop_at_end": False},
            "current_m_s": [share * u for share in current],
            "control.safe_mode.distance_limit_m": None,
            "stop": [{"kind": "path_end", "reach_m": L}],
            "checks": FORCES,
        },
        L,
        u,
    )


def flown(changes, from_s):
    """Whether it is told, and the largest cross-track error from then on [m]."""
    flight = Flight(LINE, changes)
    flight.fly_to_its_end()
    rows = flight.signals["path_error.cross_track"]
    return any(TOLD in line.text for line in flight.log), float(rows[rows[:, 0] > from_s, 1].max())


@pytest.mark.flight
@pytest.mark.parametrize("seed", [1, 5, 6, 7, 8])
@pytest.mark.parametrize("current", [(0.0, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.4, 0.0)], ids=["still", "0.3", "0.4"])
@pytest.mark.parametrize("radius", [3.0, 8.0])
def test_what_is_told_is_left_and_what_is_not_is_kept(seed, current, radius, tmp_path):
    changes, L, u = changes_of(seed, tmp_path, current, radius)
    told, error = flown(changes, 22.0 * L / u)  # before, a current that hits it at once is what throws it
    assert told == (error > 0.25 * L)


def test_the_rate_is_that_of_a_circle_and_of_its_current_by_hand(tmp_path):
    """Through the water it is u / R in still water; with a current c behind, u^2 / ((u - c) R), and less is made."""
    circle = {"type": "circle", "centre_m": [0, 0, -60], "radius_m": 30.0}
    flight = Flight(LINE, {"duration_s": 1, "path": circle, "checks": FORCES})
    law = flight.mission.controller
    keeping = CourseKeeping.of(law.capability, law.loops.dynamics, law.fins_speed)
    assert keeping is not None
    still = tightest_turn(keeping, flight.mission.path, np.zeros(3))
    assert still.times == pytest.approx(1.2 / 30.0 / keeping.most_rate[1], rel=1e-3)
    small = 0.01
    some = tightest_turn(keeping, flight.mission.path, np.array([small, 0.0, 0.0]))
    assert some.times == pytest.approx(still.times * 1.2**2 / (1.2 - small) ** 2, rel=2e-3)


def test_nothing_is_told_of_hulls_that_thrusters_steer():
    flight = Flight(SCENARIOS / "cube_helix.yaml", {"duration_s": 1, "checks": FORCES})
    assert not any(TOLD in line.text for line in flight.log)
