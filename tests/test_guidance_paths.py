"""Paths against their own derivatives: the frame equations define a parallel-transport frame."""

from math import pi

import numpy as np
import pytest

from cube_sim.guidance.helix import Helix
from cube_sim.guidance.line import Line

PATHS = {
    "line": Line([1.0, 2.0, 3.0], [4.0, -2.0, 3.5]),
    "vertical line": Line([0.0, 0.0, 0.0], [0.0, 0.0, -5.0]),
    "helix": Helix([1.0, -2.0, -8.0], 3.0, 3.0, 2.0, 0.4),
    "right-hand descent": Helix([0.0, 0.0, 0.0], 2.0, -5.0, 1.5, -1.0, clockwise=True),
    "circle": Helix([0.0, 0.0, 0.0], 4.0, 0.0, 1.0),
}


@pytest.fixture(params=PATHS.values(), ids=PATHS.keys())
def path(request):
    return request.param


def test_the_frame_is_right_handed_and_orthonormal(path):
    for s in np.linspace(0.0, path.length, 23):
        R = path.at(s).rotation
        np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-14)
        assert np.linalg.det(R) == pytest.approx(1.0)


def test_the_position_advances_along_the_tangent_by_arc_length(path):
    h = 1e-5
    for s in np.linspace(h, path.length - h, 17):
        step = (path.at(s + h).position - path.at(s - h).position) / (2.0 * h)
        np.testing.assert_allclose(step, path.at(s).rotation[:, 0], atol=1e-9)


def test_the_frame_obeys_bishops_equations(path):
    h = 1e-5
    for s in np.linspace(h, path.length - h, 17):
        T, N1, N2 = path.at(s).rotation.T
        k1, k2 = path.at(s).curvature
        dT, dN1, dN2 = (path.at(s + h).rotation - path.at(s - h).rotation).T / (2.0 * h)
        np.testing.assert_allclose(dT, k1 * N1 + k2 * N2, atol=1e-9)
        np.testing.assert_allclose(dN1, -k1 * T, atol=1e-9)
        np.testing.assert_allclose(dN2, -k2 * T, atol=1e-9)


def test_beyond_its_ends_a_path_stays_at_its_ends(path):
    np.testing.assert_array_equal(path.at(-1.0).position, path.at(0.0).position)
    np.testing.assert_array_equal(path.at(path.length + 1.0).position, path.at(path.length).position)


def test_a_helix_has_the_radius_rise_and_sense_it_was_given():
    helix = Helix([1.0, 1.0, -8.0], 3.0, 2.5, 2.0, pi / 2.0, clockwise=True)
    np.testing.assert_allclose(helix.at(0.0).position, [1.0, 4.0, -8.0], atol=1e-12)
    np.testing.assert_allclose(helix.at(helix.length).position, [1.0, 4.0, -3.0], atol=1e-12)
    np.testing.assert_allclose(helix.at(helix.length / 8.0).position, [4.0, 1.0, -8.0 + 5.0 / 8.0], atol=1e-12)
    assert helix.length == pytest.approx(2.0 * np.hypot(2.0 * pi * 3.0, 2.5))


def test_a_line_without_length_is_refused():
    with pytest.raises(ValueError, match="two different points"):
        Line([1.0, 1.0, 1.0], [1.0, 1.0, 1.0])
