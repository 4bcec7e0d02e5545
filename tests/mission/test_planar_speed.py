"""How fast a planar hull is sent round a curve."""

from __future__ import annotations

import numpy as np
import pytest
from support.places import SCENARIOS
from support.planar_flight import HULL, INFANTE

import cube_sim
from cube_sim.control.planar.attainable_set import PlanarAttainableSet
from cube_sim.control.planar.follower import PlanarFollower
from cube_sim.control.planar.model import sway_acceleration
from cube_sim.control.planar.turning import (
    KEPT_FOR_STEERING,
    steady_turn,
    tightest_turn,
    turning_length,
    turning_speed,
)
from cube_sim.guidance.arc import circle
from cube_sim.guidance.line import Line
from cube_sim.guidance.polyline import polyline
from cube_sim.guidance.speed import ConstantSpeed
from cube_sim.mission import prepare
from cube_sim.mission.planar_speed import flyable_speed
from cube_sim.scenario import load
from cube_sim.scenario.schema import GuidanceBlock

CIRCLE = SCENARIOS / "infante_circle.yaml"
COLUMNS = np.array([[1.0, 1.0], [0, 0], [0, 0], [0, 0], [0, 0], [-0.6, 0.6]])
TWO_ASTERN = PlanarAttainableSet.of(COLUMNS, np.array([[-800.0, 800.0]] * 2))


@pytest.mark.parametrize("curvature", [1 / 30.0, -1 / 12.0, 1 / 5.0])
def test_a_steady_turn_keeps_to_its_circle_without_a_force_from_the_side(curvature):
    turn = steady_turn(INFANTE, 1.2, curvature)
    assert turn is not None
    assert turn.r == pytest.approx(curvature * turn.speed)
    assert sway_acceleration(HULL, turn) == pytest.approx(0.0, abs=1e-9)
    assert turn.v * curvature < 0.0  # it slips outwards


def test_there_is_no_steady_turn_tighter_than_the_one_with_45_degrees_of_side_slip():
    tightest = tightest_turn(INFANTE, 1.5)
    turn = steady_turn(INFANTE, 1.5, 0.999999 * tightest)
    assert turn is not None
    assert turn.side_slip == pytest.approx(-np.pi / 4, abs=1e-4)
    assert steady_turn(INFANTE, 1.5, 1.001 * tightest) is None


def test_at_the_turning_speed_the_thrusters_have_just_what_is_kept_for_steering_left():
    for radius in (6.0, 12.0, 40.0, 1e6):
        speed = turning_speed(INFANTE, TWO_ASTERN, 1 / radius, 10.0)
        turn = steady_turn(INFANTE, speed, 1 / radius)
        assert turn is not None
        use = TWO_ASTERN.normals @ (INFANTE.d_u(turn), INFANTE.d_r(turn)) / TWO_ASTERN.sizes
        assert use.max() == pytest.approx(1.0 - KEPT_FOR_STEERING, rel=1e-6)
    assert turning_speed(INFANTE, TWO_ASTERN, 1 / 12.0, 1.5) == 1.5


def test_a_turn_that_tightens_is_flown_as_fast_as_the_torque_to_tighten_it_allows():
    speed = turning_speed(INFANTE, TWO_ASTERN, 0.05, 10.0, 0.06)
    turn = steady_turn(INFANTE, speed, 0.05)
    assert turn is not None
    # course rate c v_t, of which a yaw acceleration gives all but the side-slip
    torque = abs(INFANTE.d_r(turn)) + INFANTE.m_r * 0.06 * turn.speed**2 / INFANTE.loop_gain(turn)
    use = TWO_ASTERN.normals @ (INFANTE.d_u(turn), torque) / TWO_ASTERN.sizes
    assert use.max() == pytest.approx(1.0 - KEPT_FOR_STEERING, rel=1e-6)
    assert speed == turning_speed(INFANTE, TWO_ASTERN, 0.05, 10.0, -0.06)
    assert speed < turning_speed(INFANTE, TWO_ASTERN, 0.05, 10.0)


def test_the_turning_length_compares_a_change_of_curvature_with_curvature():
    length, u = turning_length(INFANTE, 1.5), 1.5
    c = 0.5 * tightest_turn(INFANTE, u)
    turn = steady_turn(INFANTE, u, c)
    assert turn is not None
    tightening = INFANTE.m_r * (c / length) * turn.speed**2 / INFANTE.loop_gain(turn)
    assert tightening == pytest.approx(abs(INFANTE.d_r(turn)))
    assert 10.0 < length < 50.0  # the flow past this hull turns it nearly by itself in a steady turn
    assert turning_length(INFANTE._replace(K_rr=0.0, K_vv=0.0, K_uv=0.0, K_ur=0.0), 1.5) == np.inf


def profile(path, speed, **guidance):
    block = GuidanceBlock(speed_m_s=speed, **guidance)
    wanted = ConstantSpeed(speed)
    return wanted, flyable_speed(wanted, block, path, INFANTE, TWO_ASTERN)


def test_a_speed_that_the_thrusters_keep_stays_as_it_is():
    wanted, flown = profile(circle([0.0, 0.0, 0.0], 12.0), 1.5)
    assert flown is wanted


def test_one_that_they_do_not_falls_to_what_the_curve_allows():
    _, flown = profile(circle([0.0, 0.0, 0.0], 12.0), 10.0)
    assert flown.at(3.0).value == pytest.approx(turning_speed(INFANTE, TWO_ASTERN, 1 / 12.0, 10.0), rel=1e-6)
    _, straight = profile(Line([0.0, 0.0, 0.0], [100.0, 0.0, 0.0]), 10.0)
    assert straight.at(3.0).value == pytest.approx(turning_speed(INFANTE, TWO_ASTERN, 0.0, 10.0))


def test_between_curves_it_runs_faster_and_brakes_in_time():
    corner = polyline([[0, 0, 0], [200, 0, 0], [200, 200, 0]], 12.0)
    wanted, flown = profile(corner, 5.0)
    s = np.linspace(0.0, corner.length, 4001)
    speeds = np.array([flown.at(x).value for x in s])
    round_the_corner = np.flatnonzero([np.hypot(*corner.at(x).curvature) > 0.0 for x in s])[::4]
    points = [corner.at(x) for x in s[round_the_corner]]
    allowed = [
        turning_speed(INFANTE, TWO_ASTERN, np.hypot(*point.curvature), 5.0, np.hypot(*point.curvature_rate))
        for point in points
    ]
    shares = speeds[round_the_corner] / allowed
    assert 0.95 < shares.max() <= 1.01
    assert speeds.max() > 1.3 * min(allowed)
    assert np.abs(np.diff(speeds**2) / np.diff(s)).max() <= 2.0 * 0.05 * (1 + 1e-6)
    assert flown.least == pytest.approx(speeds.min())
    assert (speeds <= wanted.at(0.0).value).all()


@pytest.mark.flight
def test_told_more_than_it_can_keep_the_vehicle_holds_its_circle_at_what_it_can(tmp_path):
    changes = {"guidance.speed_m_s": 10.0, "duration_s": 70, "checks": [{"kind": "allowed_forces"}]}
    run = cube_sim.run(CIRCLE, changes, out=tmp_path / "out")
    track = run.signals["path_error.cross_track"]
    assert np.sqrt(np.mean(track[track[:, 0] >= 40.0, 1] ** 2)) < 0.02
    assert run.signals["velocity.linear"][-1, 1] > 2.0


@pytest.mark.flight
def test_a_fast_hull_short_of_torque_slows_down_and_settles(tmp_path):
    """At 1.98 m/s, with the torque cut off and nothing given up, it swings about this line by 5 m for ever."""
    changes = {
        "guidance.speed_m_s": 1.98,
        "current_m_s": [-0.06, -0.03, 0.0],
        "initial.position_m": [-5.1, 7.7, -5.0],
        "initial.attitude_deg": [0.0, 0.0, -129.0],
        "initial.velocity_m_s": [0.09, 0.0, 0.0],
        "knowledge": {"drag": 0.79, "thrust": 1.11},
        "duration_s": 60,
        "checks": [{"kind": "allowed_forces"}],
    }
    run = cube_sim.run(SCENARIOS / "infante_line_current.yaml", changes, out=tmp_path / "out")
    track = run.signals["path_error.cross_track"]
    assert track[track[:, 0] >= 45.0, 1].max() < 0.02
    assert run.signals["velocity.linear"][-1, 1] > 1.5


@pytest.mark.flight
@pytest.mark.parametrize(("waits", "wanted"), [(True, 0.75), (False, 1.5)])
def test_speed_is_given_up_for_want_of_torque_unless_told_not_to(waits, wanted, tmp_path):
    changes = {"guidance.wait_for_thrusters": waits, "duration_s": 4, "checks": [{"kind": "allowed_forces"}]}
    run = cube_sim.run(SCENARIOS / "infante_line.yaml", changes, out=tmp_path / "out")
    assert run.signals["reference.linear"][-1, 1] == pytest.approx(wanted, abs=0.01)


def test_the_scenarios_as_they_stand_keep_their_speeds():
    for name in ("infante_circle", "infante_line", "infante_sinusoid"):
        follower = prepare(load(SCENARIOS / f"{name}.yaml")).controller
        assert isinstance(follower, PlanarFollower)
        assert isinstance(follower.profile, ConstantSpeed)
