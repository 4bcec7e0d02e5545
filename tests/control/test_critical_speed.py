"""Speeds at which margins end: from the model, said in the analysis and in the run."""

from __future__ import annotations

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.command_line import call
from support.flights import FORCES_ONLY
from support.places import MODELS, SCENARIOS
from support.vehicles import vehicle

import cube_sim
from cube_sim.commands.analysis_report import report_on, to_dict
from cube_sim.control.critical_speed import (
    LEAST_HELD,
    MOST_DELAYED,
    critical_speed,
    held_share,
    own_growth,
    too_fast,
)
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.loop_times import USUAL_PERIOD_S, mean_delay
from cube_sim.control.yielding import WaterHold
from cube_sim.guidance.polyline import polyline
from cube_sim.mission.ability import courses_of, fastest_through_water
from cube_sim.scenario.schema import Scenario
from cube_sim.spatial import rotation_about
from cube_sim.wrench.health import Health

DELAY_S = 0.05
EVERY_AXIS = tuple(range(6))


def left_of(hull, speed_m_s=0.3):
    whole = Health.whole(len(hull.thrusters.names))
    hold = WaterHold.of(hull.dynamics, speed_m_s)
    return remaining_capability(hull.actuation_matrix, hull.thrusters.limits, whole, hold=hold)


def test_it_is_where_the_munk_moment_has_taken_its_share_of_the_righting_moment():
    """BlueROV2 with six thrusters: r - (M_33 - M_11) U^2 about y, its heave drag and levers being small."""
    hull = vehicle("bluerov2_vectored")
    left, body = left_of(hull), hull.dynamics
    M, r = body.total_mass, body.righting_moment[2]
    found = critical_speed(left, body, DELAY_S)
    assert found.speed_m_s == pytest.approx(np.sqrt((1.0 - LEAST_HELD) * r / (M[2, 2] - M[0, 0])), rel=0.02)
    assert held_share(left, body, found.speed_m_s) == pytest.approx(LEAST_HELD, abs=1e-4)
    assert "45 % of what rights it about an axis that no thruster holds" in found.reason


@pytest.mark.parametrize("speed", [0.1, 0.4, 0.9])
def test_what_the_water_holds_is_the_slope_of_the_torque_of_a_tilted_hull(speed):
    """By finite differences of the steady wrench, without the levers of the thrusters."""
    hull = vehicle("bluerov2_vectored")
    body, step, torques = hull.dynamics, 1e-5, []
    for v in (speed, 0.0):
        turned = [rotation_about(np.eye(3)[1], angle) for angle in (step, -step)]
        wrenches = body.steady_wrenches(
            np.array([R.T @ [v, 0.0, 0.0] for R in turned]), np.array([R[2] for R in turned])
        )
        torques.append((wrenches[0] - wrenches[1])[4])
    assert held_share(left_of(hull), body, speed) == pytest.approx(torques[0] / torques[1], abs=0.1)


def test_a_hull_with_as_much_added_mass_on_all_sides_has_none():
    hull = vehicle("cube")
    assert np.isinf(critical_speed(left_of(hull), hull.dynamics, DELAY_S).speed_m_s)
    assert too_fast(left_of(hull), hull.dynamics, DELAY_S, 4.0) is None


@pytest.mark.parametrize("delay", [0.05, 0.1, 0.2])
def test_thrusters_that_lag_longer_hold_a_hull_that_leaves_its_course_more_slowly(delay):
    hull = vehicle("bluerov2_heavy")
    found = critical_speed(left_of(hull), hull.dynamics, delay)
    assert own_growth(hull.dynamics, found.speed_m_s, EVERY_AXIS) * delay == pytest.approx(MOST_DELAYED, rel=1e-3)


def test_the_growth_of_a_hull_alone_is_that_of_its_own_equations_of_motion():
    """A small sway left to itself at 1 m/s, its forces held: the last e-fold of a small disturbance takes 1 / p."""
    body, speed = vehicle("bluerov2_heavy").dynamics, 1.0
    p = own_growth(body, speed, EVERY_AXIS)
    held = body.steady_wrenches(np.array([[speed, 0.0, 0.0]]), np.eye(3)[2:])[0]
    R, nu, dt, sizes = np.eye(3), np.array([speed, 1e-10, 1e-10, 0.0, 0.0, 0.0]), 1e-3, []
    for _ in range(5000):
        nu = nu + dt * np.linalg.solve(body.total_mass, held - body.wrench(R, nu, np.zeros(6), np.zeros(3)))
        angle = float(np.linalg.norm(nu[3:]))
        R = R @ rotation_about(nu[3:] / max(angle, 1e-30), dt * angle)
        sizes.append(float(np.abs(nu[1:]).max()))
    assert np.log(sizes[-1] / sizes[-1001]) == pytest.approx(p, rel=0.02)


def test_the_analysis_says_it(tmp_path, monkeypatch, capsys):
    _, said, _ = call(monkeypatch, capsys, "analyze", str(MODELS / "bluerov2_vectored.xml"))
    assert "margins: up to 0.37 m/s through the water, level and nose ahead; there the flow leaves 45 %" in said
    _, said, _ = call(monkeypatch, capsys, "analyze", str(MODELS / "cube.xml"))
    assert "margins: at every speed through the water up to 5 m/s" in said
    (tmp_path / "hull.xml").write_text(catalogue()["five_survey-T1"].make())
    said = to_dict(report_on(tmp_path / "hull.xml", lost="T1"))["critical_speed"]
    assert said["speed_m_s"] == pytest.approx(0.19, abs=0.02)
    assert to_dict(report_on(MODELS / "cube.xml"))["critical_speed"] == {"speed_m_s": None, "reason": ""}
    assert to_dict(report_on(MODELS / "infante.xml", planar=True))["critical_speed"] is None


@pytest.mark.flight
def test_the_run_warns_of_a_path_that_is_faster():
    edits = {"duration_s": 0.2, "checks": FORCES_ONLY, "current_m_s": [0.0, 0.0, 0.0]}
    line = SCENARIOS / "bluerov2_vectored_line.yaml"
    for speed, current, warns in ((0.3, 0.0, False), (0.3, -0.1, True), (0.5, 0.2, False)):
        edits |= {"guidance.speed_m_s": speed, "current_m_s": [current, 0.0, 0.0]}
        run = cube_sim.run(line, edits)
        said = [entry.text for entry in run.log if "critical speed" in entry.text]
        assert bool(said) == warns, (speed, current)


def test_the_period_taken_is_the_one_of_scenarios():
    assert Scenario.model_fields["control_period_s"].default == USUAL_PERIOD_S
    assert mean_delay(np.array([0.1, 0.2]), USUAL_PERIOD_S) == pytest.approx(0.23)


def test_the_speed_through_the_water_is_the_largest_along_the_path():
    bend = polyline([[0.0, 0.0, -5.0], [4.0, 0.0, -5.0], [4.0, 4.0, -5.0]], 0.5)
    assert fastest_through_water(courses_of(bend), 0.4, np.array([0.0, -0.3, 0.0])) == pytest.approx(0.7)


@pytest.mark.parametrize("speed", [0.05, 0.3, 1.0, 2.0, 4.9])
def test_a_speed_is_judged_without_looking_at_faster_ones(speed):
    """What is beyond the critical speed is what is beyond it when all speeds are looked at."""
    beyond = 0
    for name in ("bluerov2_heavy", "cube", "bluerov2_vectored"):
        hull = vehicle(name)
        left = left_of(hull)
        limit = critical_speed(left, hull.dynamics, DELAY_S)
        assert (too_fast(left, hull.dynamics, DELAY_S, speed) is not None) == (speed > limit.speed_m_s)
        beyond += speed > limit.speed_m_s
    assert beyond > 0 or speed < 4.0
