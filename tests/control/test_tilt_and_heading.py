"""The way to a wished attitude by a tilt and a turn: tilts go about the right axis wherever the nose points."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cube_sim.control.balancing import MOST_PULL_RAD, tilt_and_heading


def quaternion(rotation):
    x, y, z, w = rotation.as_quat()
    return (w, x, y, z) if w >= 0.0 else (-w, -x, -y, -z)


@pytest.mark.parametrize("heading", [-3.0, -1.0, 0.0, 0.2, 2.5])
def test_the_tilt_does_not_depend_on_the_heading(heading):
    tilt = np.array([0.2, -0.15, 0.0])
    found = tilt_and_heading(quaternion(Rotation.from_rotvec(tilt) * Rotation.from_rotvec([0.0, 0.0, heading])))
    size = np.linalg.norm(tilt)
    np.testing.assert_allclose(found[:2], 2.0 * np.sin(0.5 * size) / size * tilt[:2], atol=1e-12)
    assert found[2] == pytest.approx(np.clip(2.0 * np.sin(0.5 * heading), -MOST_PULL_RAD, MOST_PULL_RAD))


def test_small_angles_are_the_rotation_itself():
    small = np.array([1e-4, -2e-4, 3e-4])
    np.testing.assert_allclose(tilt_and_heading(quaternion(Rotation.from_rotvec(small))), small, atol=1e-7)


def test_upside_down_is_a_tilt_by_half_a_turn():
    found = np.array(tilt_and_heading(quaternion(Rotation.from_rotvec([np.pi, 0.0, 0.0]))))
    assert np.isfinite(found).all()
    assert np.linalg.norm(found) <= 2.0**0.5 * MOST_PULL_RAD


@pytest.mark.parametrize("angle", [0.5, 1.5, 3.0])
def test_a_large_tilt_pulls_its_own_way_no_more_than_the_most(angle):
    """Some of a pull gets past the damped first task: a strong one would swing the hull about its balance."""
    axis = np.array([0.6, -0.8, 0.0])
    found = tilt_and_heading(quaternion(Rotation.from_rotvec(angle * axis)))
    np.testing.assert_allclose(found, MOST_PULL_RAD * axis, atol=1e-12)
