"""A hull whose Munk moment outgrows its righting one: level is a poor trim, and it flies nose up or nose down."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue

import cube_sim
from cube_sim.actuation.directions.subspaces import subspaces
from cube_sim.actuation.path_following.requirements import PathRequirements
from cube_sim.actuation.path_following.verdict import Outcome, judge
from cube_sim.control import judged_capability
from cube_sim.control.authority import Authority
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.yielding import WaterHold
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.health import Health


@pytest.fixture(scope="module")
def hull(tmp_path_factory):
    model = tmp_path_factory.mktemp("hull") / "model.xml"
    model.write_text(catalogue()["three_astern_up"].make())
    return cube_sim.Vehicle.from_model(cube_sim.load_model(str(model)))


def judged(hull, speed):
    A, limits = hull.actuation_matrix, hull.thrusters.limits
    allowed = AllowedForces.from_limits(limits, len(limits), dead_zones=False)
    required = replace(PathRequirements(speed_m_s=speed), inclinations_rad=(0.0,))
    return judge(subspaces(A), hull.dynamics, allowed, required)


def unstable_m_s(hull):
    """Where level becomes unstable: at a small pitch p, (m_w - m_u) u^2 p turns the hull over and r p back."""
    M = hull.dynamics.total_mass
    return float(np.sqrt(hull.dynamics.righting_moment[2] / (M[2, 2] - M[0, 0])))


@pytest.mark.parametrize(("share", "tilted"), [(0.8, False), (1.03, True)])
def test_where_level_is_steered_poorly_it_is_tilted_and_steered_well(hull, share, tilted):
    verdict = judged(hull, share * unstable_m_s(hull))
    assert verdict.outcome is Outcome.STEERED
    (trim,) = verdict.trims
    assert trim.side_step_m >= PathRequirements().side_step_m
    assert (np.degrees(trim.condition.tilt_rad) > 10.0) == tilted


def test_a_path_is_not_given_up_for_being_poorly_steered_at_a_lower_speed(hull, monkeypatch):
    A, limits, whole = hull.actuation_matrix, hull.thrusters.limits, Health.whole(hull.actuation_matrix.shape[1])
    slow = 0.97 * unstable_m_s(hull)
    assert judged(hull, slow).outcome is Outcome.WEAK
    monkeypatch.setattr(judged_capability, "FASTEST_JUDGED_M_S", slow)
    for speed, expected in ((slow, Authority.SAFE), (0.5, Authority.PLANE)):
        left = remaining_capability(A, limits, whole, hold=WaterHold.of(hull.dynamics, speed))
        assert left.authority is expected
