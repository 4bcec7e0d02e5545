"""The law of vehicles that fins steer: what it works out of a model, and where it points a hull."""

from __future__ import annotations

import numpy as np
import pytest
from support.drawn_torpedo import drawn_torpedo
from support.places import SCENARIOS

from cube_sim.control.asked import MEMORY
from cube_sim.control.attitude_mode import DESIRED
from cube_sim.control.course_keeping import CourseKeeping
from cube_sim.control.following import FOLLOWED
from cube_sim.control.steering_by_fins import WAY, drift_in, gliding, keep_course, velocity_through_water
from cube_sim.control.turned_away import STALLED, turns_away
from cube_sim.flight import Flight
from cube_sim.guidance.view_record import VIEW
from cube_sim.spatial import rotation_from_quaternion
from cube_sim.vehicle.laws.hull_motion import steady_wrench_slope

LINE = SCENARIOS / "remus100_line.yaml"
ONE_TICK = {"duration_s": 1, "checks": [{"kind": "allowed_forces"}]}
CURRENT = np.array([0.1, 0.35, -0.05])


@pytest.fixture(scope="module")
def follower():
    return Flight(LINE, ONE_TICK).mission.controller


def kept(follower):
    keeping = CourseKeeping.of(follower.capability, follower.loops.dynamics, follower.fins_speed)
    assert keeping is not None
    return keeping


def test_what_the_fins_make_is_a_torque_each_and_the_surge_force(follower):
    """No roll: nothing of REMUS makes any that does not come with its thrust."""
    makes = kept(follower).makes
    np.testing.assert_allclose(makes[[0, 4, 5]][:, [0, 2, 3]], np.eye(3), atol=1e-9)
    assert not makes[:, 1].any()
    arm = -6.15 / 9.64
    np.testing.assert_allclose(makes[1, 3], 1.0 / arm, rtol=1e-6)
    np.testing.assert_allclose(makes[2, 2], -1.0 / arm, rtol=1e-6)


def test_a_slip_and_a_torque_of_the_fins_balance_a_steady_turn(follower):
    """Sway and yaw of the linear equations at its speed, solved by hand for one rate."""
    keeping, hull = kept(follower), follower.loops.dynamics
    D = steady_wrench_slope(hull.record, np.array([1.2, 0, 0, 0, 0, 0.0]), np.zeros(6))
    r, arm = 0.1, -6.15 / 9.64
    v, N = np.linalg.solve([[D[1, 1], -1.0 / arm], [D[5, 1], -1.0]], [-D[1, 5] * r, -D[5, 5] * r])
    assert keeping.slips[0] @ (keeping.turning[:, 1] * r) == pytest.approx(v, rel=1e-9)
    assert abs(N) < 4.0


def asked(follower, velocity, holds=False, learned=(0.0, 0.0)):
    """The nose (3,) that is asked for straight ahead along x in the current, and the wrench."""
    course = kept(follower).record(1.4)
    course["learned"] = learned
    memory, out, desired, view = (np.zeros(1, kind) for kind in (MEMORY, FOLLOWED, DESIRED, VIEW))
    view["frame"], view["remaining"] = np.eye(3), 100.0
    R = np.eye(3)
    motion = np.array(velocity), np.zeros(3)
    hull, loops, quaternion = follower.loops.dynamics.record, follower.loops.record, np.array([1.0, 0, 0, 0])
    told = np.array([1.2, 0.0, 0.0]), np.zeros(3), *motion, np.zeros(6), CURRENT, 0.02, holds
    keep_course(hull, course, loops, memory, out, desired, view, R, quaternion, *told)
    return rotation_from_quaternion(desired["quaternion"][0])[:, 0], out["wrench"][0]


def test_its_nose_points_along_the_velocity_through_the_water(follower):
    """Aside; up and down it leans by what holds its lift down."""
    velocity = np.array([1.2, 0.0, 0.0])
    nose, wrench = asked(follower, velocity)
    through = velocity - CURRENT
    assert np.arctan2(nose[1], nose[0]) == pytest.approx(np.arctan2(through[1], through[0]), abs=1e-9)
    assert wrench[5] < 0.0
    left, _ = asked(follower, velocity, learned=(0.0, 0.1))
    assert np.arctan2(left[1], left[0]) - np.arctan2(nose[1], nose[0]) == pytest.approx(0.1, abs=3e-3)


@pytest.mark.parametrize("along", [-0.8, -0.3, 0.0, 0.3, 0.8])
def test_with_the_current_behind_it_it_keeps_way_on_and_is_carried_the_right_way(along):
    wanted, water = (1.2, 0.0, 0.0), (along, 0.4, 0.1)
    through = np.array(velocity_through_water(wanted, water, False))
    over_ground = through + water
    assert np.linalg.norm(through) >= WAY * 1.2 - 1e-12
    np.testing.assert_allclose(over_ground[1:], 0.0, atol=1e-12)
    assert over_ground[0] > 0.0


def test_it_glides_to_the_end_along_the_last_tangent():
    view = np.zeros(1, VIEW)
    view["frame"], view["remaining"] = np.eye(3), 1.0
    assert gliding(view, (0.5, 0.2, -0.1), 1.2, 3.0) == ((0.5, 0.0, 0.0), True)
    assert gliding(view, (1.1, 0.2, -0.1), 1.2, 3.0) == ((1.1, 0.2, -0.1), False)
    beyond, ends = gliding(view, (-0.5, 0.2, 0.0), 1.2, 3.0)
    assert ends
    assert 0.0 < beyond[0] < 1e-3
    view["remaining"] = 5.0
    assert gliding(view, (0.5, 0.2, -0.1), 1.2, 3.0) == ((0.5, 0.2, -0.1), False)


def test_the_slip_that_its_fins_hold_is_less_for_a_hull_with_smaller_fins(tmp_path):
    most = []
    for seed in (2, 7):  # 3.2 % and 4.2 % of their profiles
        drawn = drawn_torpedo(seed)
        (tmp_path / "drawn.xml").write_text(drawn.text)
        changes = {"model": str(tmp_path / "drawn.xml"), "parameters": {}, "guidance.speed_m_s": drawn.speed_m_s}
        most.append(kept(Flight(LINE, {**ONE_TICK, **changes}).mission.controller).most_slip[0])
    assert most[0] < 0.1 < most[1]


def test_of_what_is_not_explained_only_water_is_taken_for_water(follower):
    """By its model: a slip's force and torque are water; a fin's are none, nor are both together."""
    keeping, hull = kept(follower), follower.loops.dynamics
    course = keeping.record(1.4)
    D = steady_wrench_slope(hull.record, np.array([1.2, 0, 0, 0, 0, 0.0]), np.zeros(6))
    water = D @ np.array([0.0, 0.1, -0.05, 0.0, 0.0, 0.0])
    water[[0, 3]] = 0.0
    fin = 3.0 * keeping.makes[:, 3] - 2.0 * keeping.makes[:, 2]
    np.testing.assert_allclose(drift_in(course, tuple(water), 1.0), [0.0, 0.1, -0.05], atol=1e-9)
    np.testing.assert_allclose(drift_in(course, tuple(fin), 1.0), 0.0, atol=1e-9)
    np.testing.assert_allclose(drift_in(course, tuple(water + fin), 0.5), [0.0, 0.2, -0.1], atol=1e-9)


@pytest.mark.parametrize("about", ["y", "z"])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_thrust_is_off_from_when_it_turns_away_until_it_has_stopped(follower, about, side):
    course, dt = kept(follower).record(1.4), 0.1
    most, lever = course["most_rate"][0], course["levers"][0]
    k = 0 if about == "y" else 1

    def after(rate, slip, wanted=0.0, ticks=1):
        flow, rates, asked = [1.2, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        flow[2 - k], rates[1 + k], asked[1 + k] = (1.0 if k == 0 else -1.0) * side * slip, side * rate, side * wanted
        told = tuple(flow), tuple(rates), tuple(asked), 1.0, 1.4, dt
        return [bool(turns_away(course, *told)) for _ in range(ticks)][-1]

    fast, steep = 1.2 * most[k], 1.2 * STALLED
    assert not after(0.8 * most[k], steep, ticks=40)  # no faster than it may be asked to
    assert not after(fast, 0.5 * (1.2 * STALLED - lever[k] * fast), ticks=40)  # its fins have not stalled
    assert not after(fast, steep, wanted=2.0 * fast, ticks=40)  # it is asked to
    assert not after(fast, steep, ticks=13)
    assert not after(0.8 * most[k], steep)  # it has stopped by itself in time
    assert not after(fast, steep, ticks=13)
    assert after(fast, steep, ticks=3)
    assert after(0.5 * most[k], 0.1)
    assert not after(0.39 * most[k], 0.1)
    assert after(fast, steep, ticks=16)
    assert not after(-0.5 * most[k], steep)  # it turns back


@pytest.mark.parametrize("stated", [None, 10.0, 4.0], ids=["default", "10 m", "4 m"])
@pytest.mark.parametrize("speed", [1.0, 1.5])
def test_it_may_be_farther_from_its_target_than_it_turns(stated, speed):
    """What is stated stays; a hull that its thrusters hold anywhere has 10 m."""
    limit = {} if stated is None else {"control.safe_mode.distance_limit_m": stated}
    steered = Flight(LINE, {**ONE_TICK, **limit, "guidance.speed_m_s": speed}).mission.controller
    turn = 2.0 * speed / kept(steered).most_rate[1]
    assert steered.safe_mode.limit == (max(10.0, 2.0 * turn) if stated is None else stated)
    held = Flight(SCENARIOS / "cube_helix.yaml", {**ONE_TICK, **limit}).mission.controller
    assert held.safe_mode.limit == (stated or 10.0)
