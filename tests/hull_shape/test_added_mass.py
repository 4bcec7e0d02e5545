"""Added mass from a mesh: closed forms, published figures, and what holds for any hull."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from support.hull_shapes import cylinder, ellipsoid, ellipsoid_added_mass, quartered

from cube_sim.errors import ShapeError
from cube_sim.hull_shape.added_mass import about, added_mass, linear_added_mass
from cube_sim.hull_shape.division import divided
from cube_sim.hull_shape.mesh import ClosedMesh, box_mesh, closed_mesh
from cube_sim.hull_shape.simplification import simplified
from cube_sim.hull_shape.slivers import thinness, without_slivers
from cube_sim.hull_shape.solid import solid_of


def mesh_of(triangles):
    return closed_mesh(Path("hull.stl"), triangles)


def crooked():
    """A hull without symmetry: a bent, tapered box."""
    box = divided(box_mesh((1.2, 0.5, 0.4)), 120)
    x, y, z = box.vertices.T
    return type(box)(np.stack([x, y * (1 + 0.4 * x) + 0.2 * x**2, z * (1 - 0.3 * x) + 0.1 * y], axis=1), box.faces)


@pytest.mark.flight
@pytest.mark.parametrize("axes", [(1, 1, 1), (2, 1, 0.5), (5, 1, 1)])
def test_of_ellipsoids(axes):
    """Within 2 % of the ellipsoid, and within 1 % once the volume that flat triangles cut off is counted."""
    mesh = mesh_of(ellipsoid(axes, 3))
    of, exact = added_mass(mesh, 1000.0), 1000.0 * ellipsoid_added_mass(axes)
    share = solid_of(mesh).volume / (4 / 3 * np.pi * np.prod(axes))
    expected = exact * np.repeat([share, share ** (5 / 3)], 3)
    scale = np.where(exact > 0, exact, exact.max())
    assert np.abs((of.matrix.diagonal() - exact) / scale).max() < 0.02
    assert np.abs((of.matrix.diagonal() - expected) / scale).max() < 0.01
    assert np.abs(of.matrix - np.diag(of.matrix.diagonal())).max() < 1e-4 * exact.max()
    assert of.error < 0.01


@pytest.mark.flight
def test_of_a_spheroid_as_long_as_a_torpedo():
    """Lamb's printed coefficients (1932, art. 115): a/b 6.01, ahead 0.045, across 0.918, about the middle 0.764."""
    a, mesh = 6.01, mesh_of(ellipsoid((6.01, 1.0, 1.0), 4))
    mass = solid_of(mesh).volume
    ahead, across, _, _, turning, _ = added_mass(mesh, 1.0).matrix.diagonal()
    np.testing.assert_allclose([ahead / mass, across / mass], [0.045, 0.918], rtol=0.02)
    np.testing.assert_allclose(turning / (mass * (a**2 + 1.0) / 5.0), 0.764, rtol=0.02)


@pytest.mark.flight
def test_of_a_cube_by_its_twelve_triangles():
    """0.6384 rho L^3 and 0.03926 rho L^5: graded square panels carried on to infinitely many, another method."""
    of = added_mass(box_mesh((0.5, 0.5, 0.5)), 1000.0)
    translation, rotation = of.matrix.diagonal()[:3], of.matrix.diagonal()[3:]
    np.testing.assert_allclose(translation, 0.6384 * 1000.0 * 0.5**3, rtol=0.005)
    np.testing.assert_allclose(rotation, 0.03926 * 1000.0 * 0.5**5, rtol=0.01)
    assert of.error < 0.06


@pytest.mark.flight
@pytest.mark.parametrize(("length", "published"), [(1.2, 0.62), (2.5, 0.78)])
def test_of_a_cylinder_across_its_axis(length, published):
    """Flat ends, lengths in diameters: coefficients of DNV-RP-C205, table D-2, by the displaced mass."""
    mesh = mesh_of(cylinder(length, 24))
    across = added_mass(mesh, 1.0).matrix.diagonal()[1:3] / (np.pi / 4 * length)
    np.testing.assert_allclose(across, published, rtol=0.02)


@pytest.mark.flight
def test_of_a_thin_plate():
    """Across a square plate without thickness 0.579 rho pi/4 L^3 (DNV-RP-C205, appendix D); a thin one has more."""
    of = [added_mass(box_mesh((1.0, 1.0, thickness)), 1.0).matrix[2, 2] for thickness in (0.02, 0.01)]
    assert of[0] > of[1] > 0.579 * np.pi / 4
    assert of[1] < 1.06 * 0.579 * np.pi / 4


@pytest.mark.flight
@pytest.mark.parametrize("size", [(1, 1, 1), (1, 1, 0.05)])
def test_of_a_fine_mesh_is_that_of_a_coarse_one(size):
    """A box of 12 triangles, and of 12,288."""
    fine = box_mesh(size).triangles
    for _ in range(5):
        fine = quartered(fine)
    of_fine, of_coarse = added_mass(mesh_of(fine), 1.0).matrix, added_mass(box_mesh(size), 1.0).matrix
    np.testing.assert_allclose(of_fine.diagonal(), of_coarse.diagonal(), rtol=0.02)


@pytest.mark.flight
def test_of_a_fine_mesh_of_an_ellipsoid():
    exact = ellipsoid_added_mass((2, 1, 0.5))
    of = added_mass(mesh_of(ellipsoid((2, 1, 0.5), 5)), 1.0).matrix
    np.testing.assert_allclose(of.diagonal(), exact, rtol=0.02)


def test_slivers_give_their_corners_to_their_neighbours():
    """A box one edge of which has corners on it that its neighbour knows nothing of, but for faces without area."""
    corners = box_mesh((1, 1, 1)).triangles
    a, b = np.array([-0.5, -0.5, -0.5]), np.array([-0.5, -0.5, 0.5])
    points = [a + (b - a) * share for share in (0.0, 0.3, 0.7, 1.0)]
    cut, kept = [], []
    for triangle in corners:
        ends = [i for i in range(3) if np.allclose(triangle[i], a) or np.allclose(triangle[i], b)]
        (cut if len(ends) == 2 else kept).append(triangle)
    one = cut[0]
    on = [np.allclose(corner, a) or np.allclose(corner, b) for corner in one]
    start = next(i for i in range(3) if on[i] and on[(i + 1) % 3])
    along = points if np.allclose(one[start], a) else points[::-1]
    fan = [(p, q, one[(start + 2) % 3]) for p, q in pairwise(along)]
    slivers = [(along[0], along[3], along[2]), (along[0], along[2], along[1])]
    mesh = mesh_of(np.array([*kept, cut[1], *fan, *slivers]))
    mended = without_slivers(mesh)
    assert (thinness(mesh.triangles) < 1e-6).sum() == 2
    assert thinness(mended.triangles).min() > 1e-3
    assert closed_mesh(Path("again"), mended.triangles).remarks == ()
    assert solid_of(mended).volume == pytest.approx(1.0, rel=1e-12)


def test_a_hull_of_too_many_bodies_is_refused():
    screw = box_mesh((0.1, 0.1, 0.1)).triangles
    many = np.concatenate([screw + np.array([i, j, 0.0]) for i in range(21) for j in range(21)])
    mesh = ClosedMesh(many.reshape(-1, 3), np.arange(3 * len(many)).reshape(-1, 3))  # apart from each other by far
    with pytest.raises(ShapeError, match="leave out screws"):
        added_mass(mesh_of(mesh.triangles), 1.0)


def test_simplifying_keeps_shape_volume_and_edges():
    box = mesh_of(quartered(quartered(quartered(box_mesh((1, 2, 3)).triangles))))
    few = simplified(box, 60)
    assert len(box.faces) == 768
    assert len(few.faces) <= 60
    assert closed_mesh(Path("again"), few.triangles).remarks == ()
    assert solid_of(few).volume == pytest.approx(6.0, rel=1e-9)
    np.testing.assert_allclose(solid_of(few).size, [1, 2, 3], rtol=1e-6)
    ball = mesh_of(ellipsoid((1, 1, 1), 4))
    fewer = simplified(ball, 800)
    assert 700 < len(fewer.faces) <= 800
    assert solid_of(fewer).volume == pytest.approx(solid_of(ball).volume, rel=1e-9)
    assert np.linalg.norm(fewer.vertices, axis=1) == pytest.approx(1.0, abs=0.01)


def test_it_is_symmetric_and_positive_definite_however_coarse():
    for mesh in (box_mesh((1.0, 0.4, 0.1)), crooked()):
        matrix = linear_added_mass(mesh)
        assert np.array_equal(matrix, matrix.T)
        assert np.linalg.eigvalsh(matrix)[0] > 0.0


def test_it_does_not_depend_on_the_frame():
    mesh, point = crooked(), np.array([0.3, -0.7, 0.2])
    angle = 0.8
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    turn = turn @ np.array([[1, 0, 0], [0, 0.6, -0.8], [0, 0.8, 0.6]])
    here, there = linear_added_mass(mesh), linear_added_mass(mesh.moved(turn, point))
    both = np.kron(np.eye(2), turn)
    np.testing.assert_allclose(there, both @ about(here, point) @ both.T, atol=2e-4 * np.abs(there).max())


def test_it_grows_with_the_cube_and_the_fifth_power_of_the_size():
    mesh = crooked()
    large = type(mesh)(3.0 * mesh.vertices, mesh.faces)
    units = np.outer(np.repeat([1.0, 3.0], 3), np.repeat([1.0, 3.0], 3))
    np.testing.assert_allclose(linear_added_mass(large), 27.0 * units * linear_added_mass(mesh), rtol=1e-9)


def test_bodies_far_apart_add_up_and_close_ones_do_not():
    """Two spheres moving across the line between them, each a dipole to the other: 1 + 3/16 (a/s)^3.

    s is half their distance (Lamb, art. 138, to the third order).
    """
    one = ellipsoid((1, 1, 1), 2)
    alone = linear_added_mass(mesh_of(one))[0, 0]

    def pair(distance):
        aside = np.array([0.0, distance / 2, 0.0])
        both = mesh_of(np.concatenate([one + aside, one - aside]))
        return linear_added_mass(both)[0, 0] / (2 * alone)

    assert pair(30.0) == pytest.approx(1.0, abs=1e-3)
    assert pair(4.0) == pytest.approx(1 + 3 / 16 * (2 / 4) ** 3, abs=0.003)


def test_dividing_leaves_the_surface_as_it_is_and_closed():
    mesh = crooked()
    finer = divided(mesh, 600)
    assert 300 < len(finer.faces) <= 600
    before, after = solid_of(mesh), solid_of(finer)
    assert after.volume == pytest.approx(before.volume, rel=1e-12)
    assert closed_mesh(Path("again"), finer.triangles).remarks == ()
    sides = np.sort(np.stack([finer.faces, finer.faces[:, [1, 2, 0]]], axis=2).reshape(-1, 2), axis=1)
    assert (np.unique(sides, axis=0, return_counts=True)[1] == 2).all()  # no corner in the middle of a side
