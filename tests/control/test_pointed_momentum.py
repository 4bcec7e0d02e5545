"""The force that an attitude points corrects the momentum of a hull, which its own turning leaves alone."""

from __future__ import annotations

import numpy as np
import pytest
from closed_loop.condition import NOMINAL
from closed_loop.survey import THIRDS, surveyed
from support.catalogue.vehicles import catalogue
from support.vehicles import random_hull, random_rotation

from cube_sim.control.authority import Authority
from cube_sim.control.following import MOST_TURN_RAD, momentum_to_gain
from cube_sim.control.judged_capability import capability
from cube_sim.spatial import rotation_about


def gained(hull, R, axis, angle, flow):
    return np.array(momentum_to_gain(hull.record, R, tuple((angle * axis).tolist()), tuple(flow.tolist())))


def test_it_is_the_momentum_of_the_water_carried_along_in_the_attitude_wanted_less_that_now():
    """R M R' U with R turned, up to a turn of 0.3 rad about the same axis."""
    rng = np.random.default_rng(4)
    for _ in range(10):
        hull, R, flow, axis = random_hull(rng), random_rotation(rng), rng.normal(size=3), rng.normal(size=3)
        axis, M = axis / np.linalg.norm(axis), hull.total_mass[:3, :3]
        for angle in (1e-3, 0.2, 2.0):
            turned = R @ rotation_about(axis, min(angle, MOST_TURN_RAD))
            expected = turned @ M @ turned.T @ flow - R @ M @ R.T @ flow
            np.testing.assert_allclose(gained(hull, R, axis, angle, flow), expected, atol=1e-9)
        np.testing.assert_array_equal(gained(hull, R, axis, 0.0, flow), 0.0)


def test_only_a_vehicle_that_points_its_thrust_has_it():
    mass = np.diag([10.0, 20.0, 20.0, 1.0, 2.0, 2.0])
    ahead_and_torques = np.eye(6)[:, [0, 2, 3, 4, 5]]
    fins = ahead_and_torques.copy()
    fins[1, 4] = 1.0  # yaw comes with a side force
    for pointed in (ahead_and_torques, fins):
        left = capability(pointed)
        assert left.authority is Authority.PLANE
        assert left.record(mass)["by_momentum"][0]
    assert not capability(np.eye(6)).record(mass)["by_momentum"][0]


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "share"),
    [("six_two_astern_four_up", 1), ("five_survey-T5", 3), ("drawn3_3", 2), ("bluerov2_vectored-T1T2", 3)],
)
def test_a_hull_that_slips_as_it_turns_keeps_its_phase(name, share):
    """Two of them slowly; two are pushed by turning, too. With a force against the slip they have 39 to 45 degrees."""
    (row,) = surveyed(catalogue()[name], THIRDS[share], [NOMINAL])
    assert row.phase_deg > 46.0
