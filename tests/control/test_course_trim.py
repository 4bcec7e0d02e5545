"""The trim of a course that is wished for where the one next to the mission's wish is not held, or steers badly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.flights import FORCES_ONLY
from support.places import MODELS, SCENARIOS
from support.vehicles import vehicle

import cube_sim
from cube_sim import Vehicle, load_model
from cube_sim.control.attitude_mode import DESIRED
from cube_sim.control.balancing import BALANCE, MEMORY
from cube_sim.control.course_trim import BLUNT, ENOUGH, FIRM, SHARP, CourseTrims, seeks_trim
from cube_sim.control.course_wish import ENDING_S, SELDOM_S, wish_for_trim
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.roomiest_attitude import spread_attitudes
from cube_sim.control.yielding import WaterHold
from cube_sim.guidance.view_record import VIEW
from cube_sim.wrench.health import Health

LEVEL = np.eye(3)
APART = 2.5
"""How many times farther apart the two vertical thrusters sit than BlueROV2's. On so long a lever it is heave that is
missing without one of them, not roll."""


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """A BlueROV2 with six thrusters, the vertical ones on outriggers."""
    near = 'pos="0 {}0.109 0.077"'
    text = (MODELS / "bluerov2_vectored.xml").read_text()
    for side in ("-", ""):
        assert near.format(side) in text
        text = text.replace(near.format(side), f'pos="0 {side}{APART * 0.109} 0.077"')
    path = tmp_path_factory.mktemp("apart") / "apart.xml"
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def apart(model):
    return Vehicle.from_model(load_model(model))


def left_of(hull, dead, speed_m_s, stuck_N=None):
    """What is left of a vehicle without some thrusters; those stuck at a force are not without."""
    names = hull.thrusters.names
    efficiency = np.array([0.0 if name in dead else 1.0 for name in names])
    stuck = np.array([np.nan if stuck_N is None or name not in stuck_N else stuck_N[name] for name in names])
    hold = WaterHold.of(hull.dynamics, speed_m_s)
    return remaining_capability(hull.actuation_matrix, hull.thrusters.limits, Health(efficiency, stuck), hold=hold)


def trims_of(hull, dead, speed_m_s, climb_rad=0.0):
    trims = CourseTrims.of(left_of(hull, dead, speed_m_s), hull.dynamics, speed_m_s, climb_rad)
    assert trims is not None
    return trims


def test_where_the_munk_moment_outgrows_the_righting_one_another_trim_is_wished_for(apart):
    """Nothing pitches this hull but the water, and at 0.7 m/s level ahead that turns it further."""
    trims = trims_of(apart, ["T5"], 0.7)
    _, stiffness, _, _ = trims.qualities(LEVEL[None])
    assert stiffness[0] < 0.0
    trim = trims.nearest(LEVEL)
    share, stiffness, turn, decay = trims.qualities(trim[None])
    assert share[0] >= ENOUGH
    assert stiffness[0] > FIRM * trims.righting
    assert turn[0] <= SHARP
    assert decay[0] > 0.0
    assert np.max(np.abs(trims.attitudes.wrenches(trim[None]) @ trims.left.lost)) <= trims.attitudes.rounding


def test_where_the_force_hardly_turns_with_the_hull_another_trim_is_wished_for():
    """Without three horizontal thrusters it can go nose up; but then a share of its force asks for five of a turn."""
    trims = trims_of(vehicle("bluerov2_heavy"), ["T1", "T2", "T3"], 0.1)
    R, found = trims.attitudes.trimmed(LEVEL[None])
    assert found[0]
    assert trims.qualities(R)[2][0] > BLUNT
    assert trims.qualities(trims.nearest(LEVEL)[None])[2][0] <= SHARP


def test_a_trim_that_the_loop_would_hasten_is_left_for_one_that_is_steered_as_slowly_as_that():
    """Without two thrusters of a side, turned by 51 degrees its place answers at 0.7 rad/s; side ahead, at 1.8."""
    trims = trims_of(vehicle("bluerov2_vectored"), ["T1", "T3"], 0.3)
    R, found = trims.attitudes.trimmed(LEVEL[None])
    assert found[0]
    assert trims.nearest(LEVEL) is None  # of a loop of which nothing is known
    hastened = replace(trims, time=0.75)
    assert hastened.hastened(R[0])
    trim = hastened.nearest(LEVEL)
    assert not hastened.hastened(trim)
    assert abs(trim[0, 1]) > 0.99  # its side ahead
    assert replace(trims, time=10.0).nearest(LEVEL) is None  # it hastens none


def test_where_the_trim_next_to_the_wish_will_do_the_wish_is_kept(apart):
    """The hull of the first test, going slowly."""
    slow = CourseTrims.of(left_of(apart, ["T5"], 0.7), apart.dynamics, 0.2, 0.0)
    assert slow is not None
    assert slow.nearest(LEVEL) is None


def test_the_stiffness_is_the_torque_that_the_water_turns_back_with(apart):
    """Pitched by a little at rest, nothing but the righting moment r sin(angle) is there."""
    trims = CourseTrims.of(left_of(apart, ["T5"], 0.7), apart.dynamics, 1e-6, 0.0)
    assert trims is not None
    assert trims.qualities(LEVEL[None])[1][0] == pytest.approx(trims.righting, rel=1e-4)


def test_a_trim_that_will_do_is_kept_where_others_are_nearer_to_the_wish(apart):
    """Turned to its course by 64 degrees or by 120: whichever it was, it stays."""
    fast, slower = trims_of(apart, ["T5"], 0.7), trims_of(apart, ["T5"], 0.68)
    first = fast.nearest(LEVEL)
    R, found = fast.attitudes.trimmed(spread_attitudes())
    R = R[found][fast.good(R[found])]
    farthest = R[np.argmin(np.einsum("kij,ij->k", R, first))]
    assert np.trace(first.T @ farthest) < 1.0 + 2.0 * np.cos(0.7)
    for before in (first, farthest):
        after = slower.nearest(LEVEL, before)
        assert np.trace(before.T @ after) > 1.0 + 2.0 * np.cos(0.1)


def test_none_is_sought_with_all_components_nor_with_a_thruster_stuck(apart):
    cube = vehicle("cube")
    assert not seeks_trim(left_of(cube, [], 0.4))
    assert seeks_trim(left_of(apart, ["T5"], 0.7))
    assert not seeks_trim(left_of(apart, ["T5"], 0.7, {"T5": 5.0}))


def stale(remaining_m, arc_length_m, since_s=60.0):
    """Whether a course that has turned by a right angle from the one judged is judged anew, at 0.4 m/s."""
    p, m, out, view = np.zeros(1, BALANCE), np.zeros(1, MEMORY), np.zeros(1, DESIRED), np.zeros(1, VIEW)
    p["judged_wish"], p["judged_speed"], m["since"] = LEVEL, 0.4, since_s
    out["quaternion"] = np.sqrt([0.5, 0.0, 0.0, 0.5])
    view["frame"], view["remaining"], view["arc_length"] = LEVEL, remaining_m, arc_length_m
    wish_for_trim(p[0], m[0], out[0], view, np.eye(3), 0.4, np.array([0.4, 0.0, 0.0]) * (remaining_m <= 0.0), 0.02)
    return bool(m["stale"][0])


def test_a_course_is_judged_anew_as_it_turns_but_not_at_once_nor_where_its_path_ends():
    """To turn over for what is left of a path would move the hull farther off it than the trim it has."""
    seconds_left = 0.4 * ENDING_S
    assert stale(seconds_left + 1.0, 20.0)
    assert not stale(seconds_left + 1.0, 20.0, since_s=0.5 * SELDOM_S)
    assert not stale(seconds_left - 1.0, 20.0)
    assert not stale(-0.1, 20.0)


def test_at_a_point_it_is_judged_anew_as_the_current_turns():
    assert stale(0.0, 0.0)


@pytest.mark.flight
def test_a_hull_that_does_not_hold_level_flies_a_circle_in_another_trim(model, tmp_path):
    """Wishing for level at all times, it swings about its circle by 10 cm RMS."""
    settings = {
        "model": str(model),
        "path": {
            "type": "circle",
            "centre_m": [0.0, 0.0, -20.0],
            "radius_m": 9.8,
            "axis": [0.17, -0.07, 0.98],
            "start_angle_deg": -45.0,
        },
        "initial": {"position_m": [6.6, -7.4, -21.7], "attitude_deg": [0.0, 0.0, -44.0]},
        "guidance.speed_m_s": 0.69,
        "events": [{"kind": "thrusters", "at_s": 0.0, "thrusters": ["T5"], "state": "dead"}],
        "duration_s": 80.0,
        "checks": FORCES_ONLY,
    }
    run = cube_sim.run(SCENARIOS / "bluerov2_vectored_line.yaml", settings, out=tmp_path / "run")
    late = run.signals["path_error.cross_track"]
    assert np.sqrt(np.mean(late[late[:, 0] >= 45.0, 1] ** 2)) < 0.05


@pytest.mark.flight
@pytest.mark.parametrize("dead", [["T1", "T3"], ["T2", "T4"]])
def test_a_hull_without_two_thrusters_of_a_side_flies_its_line_side_ahead(dead, tmp_path):
    """Turned halfway aside, it swung about its line by half a metre for ever."""
    settings = {
        "path": {"type": "line", "start_m": [0, 0, -15], "end_m": [40, 0, -15]},
        "initial": {"position_m": [0, 0, -15], "attitude_deg": [0, 0, 0]},
        "guidance.speed_m_s": 0.3,
        "events": [{"kind": "thrusters", "at_s": 1.0, "thrusters": dead, "state": "dead"}],
        "duration_s": 70.0,
        "checks": FORCES_ONLY,
    }
    run = cube_sim.run(SCENARIOS / "bluerov2_vectored_line.yaml", settings, out=tmp_path / "run")
    late = run.signals["path_error.cross_track"]
    assert np.max(late[late[:, 0] >= 40.0, 1]) < 0.01
