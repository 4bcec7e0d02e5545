"""Steady turns: the wrench that keeps them, how tight they get, and the trim that goes on into them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.vehicles import cube, random_hull, random_rotation

from cube_sim import Vehicle, load_model
from cube_sim.actuation.attainable.attainable_set import attainable_set
from cube_sim.actuation.directions.subspaces import subspaces
from cube_sim.actuation.path_following.steady_turn import (
    TIGHTER,
    TIGHTEST_M,
    WIDEST_M,
    tightest_turn,
    turning_trim,
)
from cube_sim.actuation.path_following.trim import CourseAttitudes
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.allowed_forces import AllowedForces


def plane(most_aside_N, speed):
    """A point of 1 kg and 1 N s/m in the plane, with a thruster along each component; its attitudes and its set."""
    found = subspaces(np.eye(3), length_m=1.0)
    limits = np.array([[-1.0, 1.0], [-most_aside_N, most_aside_N], [-1.0, 1.0]])
    allowed = AllowedForces.from_limits(limits, 3, dead_zones=False)
    return CourseAttitudes.on(Dynamics.neutral(1.0), found, speed, 0.0), attainable_set(found, allowed)


def test_a_turn_is_kept_while_the_force_to_its_centre_is_there():
    speed, force = 0.3, 0.03
    found = turning_trim(*plane(force, speed))
    asked = speed**2 / force  # m U^2 / r = F
    assert found is not None
    assert asked <= found.radius_m < asked / TIGHTER
    assert found.heading_rad == 0.0  # at any other heading there is drag aside


def test_what_is_asked_for_is_all_that_is_looked_for():
    straight, attainable = plane(0.03, 0.3)
    found = turning_trim(straight, attainable, radius_m=7.0)
    assert found is not None
    assert found.radius_m == 7.0
    assert turning_trim(straight, None).radius_m == pytest.approx(TIGHTEST_M)


def test_there_may_be_a_straight_course_and_no_turn():
    found = turning_trim(*plane(0.5 * 0.3**2 / WIDEST_M, 0.3))
    assert found is not None
    assert np.isinf(found.radius_m)


def test_no_course_no_turn():
    straight, attainable = plane(1.0, 0.3)
    assert turning_trim(straight, replace(attainable, offsets=0.1 * attainable.offsets)) is None


def test_a_steady_turn_takes_what_the_equations_of_motion_say():
    """With [p; h] = M nu standing still in body axes, F = w x p and M = v x p + w x h, beside drag and hydrostatics."""
    rng = np.random.default_rng(5)
    hull, turning = random_hull(rng), 0.3
    found = subspaces(rng.normal(size=(6, 7)), length_m=0.5)
    attitudes = replace(CourseAttitudes.on(hull, found, 0.4, 0.2), turning_rad_s=turning)
    R = random_rotation(rng)
    v, w = R.T @ attitudes.velocity, R.T @ [0.0, 0.0, turning]
    nu = np.r_[v, w]
    p, h = np.split(hull.total_mass @ nu, 2)
    expected = np.r_[np.cross(w, p), np.cross(v, p) + np.cross(w, h)] + hull.damping(nu) - hull.hydrostatics @ R[2]
    np.testing.assert_allclose(attitudes.wrenches(R[None])[0], expected, rtol=1e-10)


def test_a_hull_with_all_it_needs_turns_as_tightly_as_is_looked_at():
    found = subspaces(cube().actuation_matrix)
    allowed = AllowedForces.from_limits(cube().thrusters.limits, 8, dead_zones=False)
    straight = CourseAttitudes.on(cube().dynamics, found, 0.3, 0.0)
    turning = turning_trim(straight, attainable_set(found, allowed))
    assert turning is not None
    assert turning.radius_m == TIGHTEST_M


def test_of_two_trims_one_goes_on_into_turns(tmp_path):
    """A thruster ahead, off the middle, and one aside: the trim with the stern ahead ends in a turn to port."""
    (tmp_path / "hull.xml").write_text(catalogue()["five_survey-T1"].make())
    hull = Vehicle.from_model(load_model(tmp_path / "hull.xml"))
    found = subspaces(hull.actuation_matrix[:, 1:], length_m=0.3)
    allowed = AllowedForces.from_limits(hull.thrusters.limits[1:], 4, dead_zones=False)
    straight, attainable = CourseAttitudes.on(hull.dynamics, found, 0.187, 0.0), attainable_set(found, allowed)
    best = turning_trim(straight, attainable)
    assert best is not None
    assert np.degrees(best.heading_rad) == pytest.approx(75.0, abs=2.0)
    assert best.radius_m == TIGHTEST_M
    back = np.radians(-138.5)
    R, in_trim = straight.trimmed(
        np.array([[[np.cos(back), -np.sin(back), 0.0], [np.sin(back), np.cos(back), 0.0], [0.0, 0.0, 1.0]]])
    )
    assert in_trim[0]
    assert tightest_turn(straight, attainable, R[0], TIGHTEST_M) > 2.0
