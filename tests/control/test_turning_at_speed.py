"""Hulls that lack a torque keep their path at speed, too: a slender one that is pointed, and one that is tilted."""

from __future__ import annotations

import numpy as np
import pytest
from support.catalogue.known import AHEAD, UP, pair
from support.catalogue.mjcf import Hull, Layout, Thruster, mjcf
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY

import cube_sim

SLENDER = Hull(
    mass=52.0,
    inertia=(0.34, 11.1, 11.1),
    box=(1.6, 0.23, 0.23),
    centre_of_buoyancy=(0.0, 0.0, 0.02),
    added_mass=(2.6, 49.4, 49.4, 0.06, 9.3, 9.3),
    linear_damping=(0.8, 16.6, 16.6, 0.24, 6.4, 6.4),
    quadratic_damping=(5.2, 166.0, 166.0, 0.14, 21.2, 21.2),
)
"""1.6 m long: a cylinder's drag across it, and nearly as much added mass there as it displaces."""
SURVEY = Layout(SLENDER, [*pair(-0.6, 0.17, 0.0, AHEAD), Thruster((-0.05, 0.0, 0.0), UP)], thrust=50.0, lag_s=0.08)
RADIUS_M, SPEED_M_S = 6.4, 1.0


def late_error(tmp_path, text, duration_s, initial, path, speed_m_s):
    """RMS of the cross-track error over the last 15 s of a flight [m]."""
    model = tmp_path / "vehicle.xml"
    model.write_text(text)
    scenario = {
        "schema_version": 1,
        "name": "at_speed",
        "model": str(model),
        "duration_s": duration_s,
        "initial": initial,
        "path": path,
        "guidance": {"speed_m_s": speed_m_s},
        "checks": FORCES_ONLY,
    }
    run = cube_sim.fly(scenario, out=tmp_path / "run", record="none")
    t, error = run.signals["path_error.cross_track"].T
    assert t[-1] > duration_s - 0.1
    return float(np.sqrt(np.mean(error[t >= duration_s - 15.0] ** 2)))


@pytest.mark.flight
def test_the_circle_is_kept_where_the_slip_asks_for_torque(tmp_path):
    """Seen from behind the turn it slips by 20 degrees, and the torque against that is more than there is."""
    start = {"position_m": [RADIUS_M - 0.4, -0.5, -10.3], "attitude_deg": [0, 0, 90]}
    circle = {"type": "helix", "centre_m": [0, 0, -10], "radius_m": RADIUS_M, "pitch_m": 0.0, "turns": 2.5}
    assert late_error(tmp_path, mjcf("survey", SURVEY), 55, start, circle, SPEED_M_S) < 0.025


@pytest.mark.flight
@pytest.mark.parametrize("speed_m_s", [0.7, 1.0])
def test_a_hull_that_its_own_thrust_tilts_far_keeps_its_line(speed_m_s, tmp_path):
    """Its thrusters sit 8.5 cm below its centre of mass, ten times as far as it rights itself against its drag."""
    start = {"position_m": [0, 0.5, -10.3]}
    line = {"type": "line", "start_m": [0, 0, -10], "end_m": [100, 0, -10]}
    assert late_error(tmp_path, catalogue()["bluerov2_standard"].make(), 40, start, line, speed_m_s) < 0.01
