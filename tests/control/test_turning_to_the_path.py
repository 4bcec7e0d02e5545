"""A hull steered from astern that starts far from its path's direction: it turns there and is not pushed off."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.flights import FORCES_ONLY
from support.places import SCENARIOS
from support.vehicles import random_rotation, vehicle

import cube_sim
from cube_sim.control.attitude_mode import Situation
from cube_sim.control.authority import CAPABILITY, Authority
from cube_sim.control.balanced_attitude import BalancedAttitude
from cube_sim.control.balancing import FARTHEST_RAD
from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.oscillation_centre import CENTRE, begin_centre, watch_centre
from cube_sim.control.yielding import WaterHold
from cube_sim.guidance.view_record import VIEW
from cube_sim.spatial import quaternion_from_rotation, rotation_from_quaternion
from cube_sim.tuples import turn_between
from cube_sim.wrench.health import Health

DT = 0.02
LINE = {"type": "line", "start_m": [0.0, 0.0, -10.0], "end_m": [100.0, 0.0, -10.0]}


@pytest.fixture
def rng():
    return np.random.default_rng(8)


@pytest.mark.flight
@pytest.mark.parametrize("off_deg", [100.0, -135.0, 178.0])
def test_from_abeam_and_from_astern_it_turns_nose_first(off_deg, tmp_path):
    settings = {
        "path": LINE,
        "initial": {"position_m": [0.0, 0.5, -10.0], "attitude_deg": [0.0, 0.0, off_deg]},
        "guidance.speed_m_s": 0.6,
        "duration_s": 90.0,
        "checks": FORCES_ONLY,
    }
    run = cube_sim.run(SCENARIOS / "torpedo_helix.yaml", settings, out=tmp_path / "run")
    late = run.signals["path_error.cross_track"]
    assert np.sqrt(np.mean(late[late[:, 0] >= 60.0, 1] ** 2)) < 0.02
    assert rotation_from_quaternion(run.signals["pose.quaternion"][-1, 1:])[0, 0] > 0.99


def balanced(R):
    """The law of a torpedo that should head along world x, and a tick's situation in which it is asked to go there."""
    torpedo = vehicle("torpedo")
    A, limits = torpedo.actuation_matrix, torpedo.thrusters.limits
    hold = WaterHold.of(torpedo.dynamics, 0.5)
    left = remaining_capability(A, limits, Health.whole(A.shape[1]), hold=hold)
    assert left.authority is Authority.LINE
    law = BalancedAttitude(left, torpedo.dynamics, R, 0.8, FixedAttitude(np.array([1.0, 0.0, 0.0, 0.0])))

    view: Any = None  # an attitude that is fixed does not look at it

    def heading_deg(hull):
        flow, none = np.array([0.5, 0.0, 0.0]), np.zeros(3)
        force = hull @ torpedo.dynamics.steady_wrenches((flow @ hull)[None], hull[2:])[0, :3]
        found = law.attitude(Situation(view, hull, force, none, none, left.effort, 1.0, flow), DT)
        return np.degrees(Rotation.from_matrix(rotation_from_quaternion(found.quaternion)).as_euler("ZYX")[0])

    return heading_deg


def at_heading(degrees):
    return Rotation.from_euler("z", degrees, degrees=True).as_matrix()


def test_the_search_begins_at_the_wish_while_the_hull_comes_nearer():
    heading_deg, hull = balanced(at_heading(100.0)), 100.0
    for _ in range(round(12.0 / DT)):
        hull -= 8.0 * DT  # slowly, as a long hull turns
        assert abs(heading_deg(at_heading(hull))) < 5.0
    assert hull < 5.0


def test_a_hull_that_comes_no_nearer_is_held_there_by_its_water():
    heading_deg = balanced(at_heading(100.0))
    found = [heading_deg(at_heading(100.0)) for _ in range(round(20.0 / DT))]
    assert abs(found[0]) < 1.0
    assert abs(found[-1] - 100.0) < np.degrees(FARTHEST_RAD)


def test_a_turn_between_attitudes_leads_from_one_to_the_other_the_short_way(rng):
    for _ in range(20):
        q, p = (random_rotation(rng) for _ in range(2))
        turn = np.array(turn_between(*(tuple(quaternion_from_rotation(R)) for R in (q, p))))
        np.testing.assert_allclose(q @ Rotation.from_rotvec(turn).as_matrix(), p, atol=1e-12)
        assert np.linalg.norm(turn) <= np.pi
        negative = tuple(-quaternion_from_rotation(p))
        np.testing.assert_allclose(turn_between(tuple(quaternion_from_rotation(q)), negative), turn, atol=1e-12)


def begun(left, wish, R):
    centre = np.zeros(1, CENTRE)
    begin_centre(left, centre, R, quaternion_from_rotation(R), quaternion_from_rotation(wish))
    return centre


@pytest.mark.parametrize("size", [1e-5, 0.3, 2.8])
def test_turning_from_the_wish_adds_up_to_how_the_centre_begins(size, rng):
    """Where nothing is forgotten; the path does not turn."""
    left, view = np.zeros(1, CAPABILITY), np.zeros(1, VIEW)
    left["dragged"], view["frame"] = rng.normal(size=(3, 3)), np.eye(3)
    wish, axis = random_rotation(rng), rng.normal(size=3)
    turn, steps = size * axis / np.linalg.norm(axis), 2000
    centre = np.zeros(1, CENTRE)
    for k in range(steps):
        R = wish @ Rotation.from_rotvec((k + 0.5) / steps * turn).as_matrix()
        watch_centre(left, centre, R, turn, view, 1.0 / steps, 1e12)
    found = begun(left, wish, wish @ Rotation.from_rotvec(turn).as_matrix())
    np.testing.assert_allclose(found["shift"], centre["shift"], atol=1e-5 * size)


def test_the_centre_begins_once(rng):
    left = np.zeros(1, CAPABILITY)
    left["dragged"] = rng.normal(size=(3, 3))
    wish, R = random_rotation(rng), random_rotation(rng)
    centre = begun(left, wish, R)
    before = centre.tobytes()
    begin_centre(left, centre, wish, quaternion_from_rotation(wish), quaternion_from_rotation(R))
    assert centre.tobytes() == before
