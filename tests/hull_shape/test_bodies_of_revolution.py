"""Added mass of torpedo hulls from a mesh: DARPA SUBOFF's bare hull by its published offsets, and a Rankine ovoid."""

from pathlib import Path

import numpy as np
import pytest
from support.bodies_of_revolution import (
    FOOT_M,
    SUBOFF_CAP_FT,
    SUBOFF_LENGTH_M,
    RankineOvoid,
    revolved,
    ring_added_mass,
    stations,
    suboff_radius,
)
from support.hull_shapes import ellipsoid_added_mass

from cube_sim.hull_shape.added_mass import added_mass
from cube_sim.hull_shape.mesh import closed_mesh

KNUCKLES_M = (10.645833 * FOOT_M, SUBOFF_CAP_FT * FOOT_M)
"""Where SUBOFF's afterbody begins, and its cap."""
OVOID = RankineOvoid(1.0, 0.02)


def by_rings(coarse, fine, radius, middle):
    """Carried on to infinitely many of them: their error halves with their size."""
    first, second = (np.array(ring_added_mass(x, radius(x), middle)) for x in (coarse, fine))
    return 2.0 * second - first


def by_panels(x, radius, middle, around):
    """The same four numbers: ahead, across, coupling, turning."""
    triangles = revolved(x - middle, lambda at: radius(at + middle), around)
    A = added_mass(closed_mesh(Path("hull.stl"), triangles), 1.0).matrix
    return np.array([A[0, 0], A[1, 1], A[1, 5], A[5, 5]])


def ovoid_volume():
    x = np.linspace(-OVOID.half_length, OVOID.half_length, 4001)
    return float(np.trapezoid(np.pi * OVOID.radius(x) ** 2, x))


def ovoid_stations(count):
    return stations(-OVOID.half_length, OVOID.half_length, count)


def test_rings_give_what_closed_forms_do():
    """A spheroid of 6 to 1 by Lamb's integrals, the ovoid ahead by Taylor's theorem."""

    def radius(x):
        return np.sqrt(np.maximum(1.0 - x * x / 36.0, 0.0))

    ahead, across, _, _, _, turning = ellipsoid_added_mass((6, 1, 1))
    found = by_rings(stations(-6, 6, 100), stations(-6, 6, 200), radius, 0.0)
    np.testing.assert_allclose(found[[0, 1, 3]], [ahead, across, turning], rtol=1e-3)
    assert abs(found[2]) < 1e-5
    found = by_rings(ovoid_stations(100), ovoid_stations(200), OVOID.radius, 0.0)
    assert found[0] == pytest.approx(OVOID.mass_ahead(ovoid_volume()), rel=5e-4)


def test_the_offsets_are_those_of_the_published_hull():
    """4.356 m long, 0.508 m across, 0.699 m^3, its parts joined without a step."""
    x = np.linspace(0.0, SUBOFF_LENGTH_M, 20001)
    r = suboff_radius(x)
    assert x[-1] == pytest.approx(4.356, abs=1e-3)
    assert 2.0 * r.max() == pytest.approx(0.508, abs=1e-9)
    assert np.trapezoid(np.pi * r * r, x) == pytest.approx(0.699, abs=1e-3)
    assert np.abs(np.diff(r[100:-100])).max() < 5e-4
    assert r[0] == 0.0
    assert r[-1] < 1e-3


@pytest.mark.flight
def test_of_the_bare_hull_of_suboff():
    """Within 2 % of rings: ahead, across, their coupling by turning, and turning about half its length."""
    middle = 0.5 * SUBOFF_LENGTH_M
    expected = by_rings(*(stations(0, SUBOFF_LENGTH_M, n, KNUCKLES_M) for n in (100, 200)), suboff_radius, middle)
    found = by_panels(stations(0, SUBOFF_LENGTH_M, 32, KNUCKLES_M), suboff_radius, middle, 24)
    np.testing.assert_allclose(found, expected, rtol=0.02)


@pytest.mark.flight
def test_of_a_rankine_ovoid():
    """Four times as long as wide; ahead by its closed form, 9 % of its displacement, across and turning by rings."""
    expected = by_rings(ovoid_stations(100), ovoid_stations(200), OVOID.radius, 0.0)
    expected[0] = OVOID.mass_ahead(ovoid_volume())
    found = by_panels(ovoid_stations(32), OVOID.radius, 0.0, 24)
    np.testing.assert_allclose(found[[0, 1, 3]], expected[[0, 1, 3]], rtol=0.02)
