"""Paths against their own derivatives: the frame equations define a parallel-transport frame."""

import re
from math import pi

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from cube_sim.errors import PathError
from cube_sim.guidance import tabulation
from cube_sim.guidance.arc import arc_through, circle
from cube_sim.guidance.helix import Helix
from cube_sim.guidance.line import Line
from cube_sim.guidance.polyline import polyline
from cube_sim.guidance.sinusoid import sinusoid
from cube_sim.guidance.spline import spline
from cube_sim.guidance.tabulation import Piece, tabulate
from cube_sim.guidance.waypoints_csv import read_waypoints

CORNERS = [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [5.0, 5.0, -1.0], [0.0, 5.0, 3.0]]
POINTS = [[0.0, 0.0, 0.0], [3.0, 1.0, -1.0], [5.0, 4.0, -2.0], [2.0, 8.0, -4.0], [0.0, 9.0, -1.0]]
PATHS = {
    "line": Line([1.0, 2.0, 3.0], [4.0, -2.0, 3.5]),
    "vertical line": Line([0.0, 0.0, 0.0], [0.0, 0.0, -5.0]),
    "helix": Helix([1.0, -2.0, -8.0], 3.0, 3.0, 2.0, 0.4),
    "right-hand descent": Helix([0.0, 0.0, 0.0], 2.0, -5.0, 1.5, -1.0, clockwise=True),
    "flat helix": Helix([0.0, 0.0, 0.0], 4.0, 0.0, 1.0),
    "arc": arc_through([0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [3.0, 0.0, 1.0]),
    "circle": circle([1.0, 2.0, 3.0], 3.0),
    "tilted clockwise circle": circle([1.0, 2.0, 3.0], 3.0, [1.0, 0.3, 1.0], 0.7, clockwise=True),
    "polyline": polyline(CORNERS, 1.0),
    "closed polyline": polyline(CORNERS, 0.8, closed=True),
    "straight polyline": polyline([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 5.0]], 1.0),
    "spline": spline(POINTS),
    "closed spline": spline(POINTS, closed=True),
    "two-point spline": spline(POINTS[:2]),
    "sinusoid": sinusoid([0.0, 0.0, -3.0], 3.0, 12.0, 2.3, 0.5),
}
H = 1e-5


@pytest.fixture(params=PATHS.values(), ids=PATHS.keys())
def path(request):
    return request.param


def stations(path, n):
    """Arc lengths all along, over several laps of a closed path, none within H of a spline's or a corner's joint."""
    first, last = (-1.37 * path.length, 2.21 * path.length) if path.closed else (H, path.length - H)
    return np.linspace(first, last, n)


def derivative(path, s, of):
    return (np.asarray(of(path.at(s + H))) - np.asarray(of(path.at(s - H)))) / (2.0 * H)


def test_the_frame_is_right_handed_and_orthonormal(path):
    for s in stations(path, 23):
        R = path.at(s).rotation
        np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-14)
        assert np.linalg.det(R) == pytest.approx(1.0)


def test_the_position_advances_along_the_tangent_by_arc_length(path):
    for s in stations(path, 37):
        step = derivative(path, s, lambda point: point.position)
        np.testing.assert_allclose(step, path.at(s).rotation[:, 0], atol=1e-9)


def test_the_frame_obeys_bishops_equations(path):
    for s in stations(path, 37):
        T, N1, N2 = path.at(s).rotation.T
        k1, k2 = path.at(s).curvature
        dT, dN1, dN2 = derivative(path, s, lambda point: point.rotation).T
        np.testing.assert_allclose(dT, k1 * N1 + k2 * N2, atol=1e-9)
        np.testing.assert_allclose(dN1, -k1 * T, atol=1e-9)
        np.testing.assert_allclose(dN2, -k2 * T, atol=1e-9)


def test_the_curvature_rate_is_the_derivative_of_the_curvature(path):
    for s in stations(path, 37):
        rate = derivative(path, s, lambda point: point.curvature)
        np.testing.assert_allclose(path.at(s).curvature_rate, rate, atol=1e-8)


def test_nothing_jumps_along_the_way(path):
    """Frame and curvature are continuous, over joints and over the seam of a closed path too."""
    first, last = (-0.5 * path.length, 1.5 * path.length) if path.closed else (0.0, path.length)
    s = np.linspace(first, last, 3001)
    points = [path.at(at) for at in s]
    step, largest = s[1] - s[0], max(np.hypot(*point.curvature) for point in points)
    rates = max(np.hypot(*point.curvature_rate) for point in points)
    rotations = np.array([point.rotation for point in points])
    curvatures = np.array([point.curvature for point in points])
    assert np.abs(np.diff(rotations, axis=0)).max() <= 1.01 * largest * step + 1e-12
    assert np.abs(np.diff(curvatures, axis=0)).max() <= 1.05 * rates * step + 1e-9


def test_beyond_its_ends_an_open_path_stays_at_its_ends():
    for path in (path for path in PATHS.values() if not path.closed):
        np.testing.assert_array_equal(path.at(-1.0).position, path.at(0.0).position)
        np.testing.assert_array_equal(path.at(path.length + 1.0).position, path.at(path.length).position)


def test_a_closed_path_comes_back_lap_after_lap():
    for path in (path for path in PATHS.values() if path.closed):
        for s in np.linspace(0.0, path.length, 7):
            for lap in (-2, 1, 5):
                here, there = path.at(s), path.at(s + lap * path.length)
                np.testing.assert_allclose(there.position, here.position, atol=1e-12)
                np.testing.assert_allclose(there.rotation[:, 0], here.rotation[:, 0], atol=1e-12)
                assert np.hypot(*there.curvature) == pytest.approx(np.hypot(*here.curvature), abs=1e-9)


def test_the_holonomy_of_a_closed_path_is_the_area_its_tangent_encloses_on_the_sphere():
    """Gauss and Bonnet: transport round a lap turns the normals by the solid angle of the tangent's curve."""
    for name in ("closed spline", "closed polyline", "circle", "tilted clockwise circle"):
        path = PATHS[name]
        T = np.array([path.at(s).rotation[:, 0] for s in np.linspace(0.0, path.length, 20001)[:-1]])
        pole = T.mean(axis=0) + np.array([0.1, 0.2, 1.0])
        pole /= np.linalg.norm(pole)
        a, b = T, np.roll(T, -1, axis=0)
        # signed area of the spherical triangles (pole, a, b), van Oosterom and Strackee 1983
        triple = np.einsum("ij,ij->i", np.broadcast_to(pole, a.shape), np.cross(a, b))
        area = 2.0 * np.arctan2(triple, 1.0 + a @ pole + b @ pole + np.einsum("ij,ij->i", a, b)).sum()
        before, after = path.at(0.0).rotation, path.at(path.length).rotation
        turned = np.arctan2(after[:, 1] @ before[:, 2], after[:, 1] @ before[:, 1])
        assert np.exp(1j * turned) == pytest.approx(np.exp(1j * area), abs=1e-5)


def test_in_a_level_plane_the_first_curvature_is_positive_to_the_left():
    left, right = circle([0.0, 0.0, 0.0], 2.0), circle([0.0, 0.0, 0.0], 2.0, clockwise=True)
    np.testing.assert_allclose(left.at(1.0).curvature, (0.5, 0.0), atol=1e-15)
    np.testing.assert_allclose(right.at(1.0).curvature, (-0.5, 0.0), atol=1e-15)
    np.testing.assert_allclose(sinusoid([0.0, 0.0, 0.0], 1.0, 8.0, 2.0).at(11.0).rotation[:, 2], [0.0, 0.0, 1.0])


def test_a_helix_has_the_radius_rise_and_sense_it_was_given():
    helix = Helix([1.0, 1.0, -8.0], 3.0, 2.5, 2.0, pi / 2.0, clockwise=True)
    np.testing.assert_allclose(helix.at(0.0).position, [1.0, 4.0, -8.0], atol=1e-12)
    np.testing.assert_allclose(helix.at(helix.length).position, [1.0, 4.0, -3.0], atol=1e-12)
    np.testing.assert_allclose(helix.at(helix.length / 8.0).position, [4.0, 1.0, -8.0 + 5.0 / 8.0], atol=1e-12)
    assert helix.length == pytest.approx(2.0 * np.hypot(2.0 * pi * 3.0, 2.5))


def test_a_circle_starts_turns_and_leans_as_it_was_told():
    ring = circle([1.0, 2.0, 3.0], 2.0, start_angle=pi / 2.0, clockwise=True)
    np.testing.assert_allclose(ring.at(0.0).position, [1.0, 4.0, 3.0], atol=1e-12)
    np.testing.assert_allclose(ring.at(ring.length / 4.0).position, [3.0, 2.0, 3.0], atol=1e-12)
    upright = circle([0.0, 0.0, 0.0], 2.0, [5.0, 0.0, 0.0])
    np.testing.assert_allclose(upright.at(upright.length / 4.0).position, [0.0, 0.0, 2.0], atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_an_arc_runs_through_its_three_points_at_one_distance_from_its_centre(seed):
    a, b, c = np.random.default_rng(seed).normal(size=(3, 3))
    arc = arc_through(a, b, c)
    points = np.array([arc.at(s).position for s in np.linspace(0.0, arc.length, 4001)])
    np.testing.assert_allclose(points[0], a, atol=1e-12)
    np.testing.assert_allclose(points[-1], c, atol=1e-9)
    assert np.linalg.norm(points - b, axis=1).min() < arc.length / 4000.0
    k1, k2 = arc.at(0.0).curvature
    centre = a + arc.at(0.0).rotation @ np.array([0.0, k1, k2]) / (k1**2 + k2**2)
    np.testing.assert_allclose(np.linalg.norm(points - centre, axis=1), 1.0 / np.hypot(k1, k2), rtol=1e-9)


@pytest.mark.parametrize("closed", [False, True])
def test_a_spline_runs_through_its_points_in_order(closed):
    path = spline(POINTS, closed)
    s = np.linspace(0.0, path.length, 20001)
    track = np.array([path.at(at).position for at in s])
    nearest = [int(np.argmin(np.linalg.norm(track - point, axis=1))) for point in POINTS]
    assert nearest == sorted(nearest)
    for i, point in zip(nearest, POINTS, strict=True):
        assert np.linalg.norm(track[i] - point) < path.length / 20000.0
    if not closed:
        np.testing.assert_allclose(path.at(path.length).position, POINTS[-1], atol=1e-12)
        np.testing.assert_allclose(path.at(0.0).curvature, 0.0, atol=1e-9)


def test_a_spline_is_scipys():
    for closed in (False, True):
        knots = np.array(POINTS + POINTS[:1] if closed else POINTS)
        u = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(knots, axis=0), axis=1))])
        cubic = CubicSpline(u, knots, bc_type="periodic" if closed else "natural")
        fine = np.linspace(0.0, u[-1], 4001)
        track = cubic(fine)
        path = spline(POINTS, closed)
        for s in np.linspace(0.0, path.length, 12):
            here = path.at(s).position
            guess = fine[np.argmin(np.linalg.norm(track - here, axis=1))]
            for _ in range(5):  # Newton to the foot of the perpendicular
                guess -= (cubic(guess) - here) @ cubic(guess, 1) / (cubic(guess, 1) @ cubic(guess, 1))
            assert np.linalg.norm(cubic(guess) - here) < 1e-8


def test_arc_length_is_that_of_a_closed_form():
    """A parabola y = x^2 / 2 has length (a sqrt(1 + a^2) + asinh a) / 2; a sine's is read off quadrature."""
    parabola = tabulate([0.0, 0.0, 0.0], [Piece(lambda u: np.column_stack([np.ones_like(u), u, 0.0 * u]), 3.0)])
    assert parabola.length == pytest.approx((3.0 * np.sqrt(10.0) + np.arcsinh(3.0)) / 2.0, rel=1e-13)
    for x in np.linspace(0.0, 3.0, 50):
        s = (x * np.sqrt(1.0 + x**2) + np.arcsinh(x)) / 2.0
        np.testing.assert_allclose(parabola.at(s).position, [x, x**2 / 2.0, 0.0], atol=2e-12)
        assert parabola.at(s).curvature[0] == pytest.approx((1.0 + x**2) ** -1.5, abs=1e-10)
        rate = -3.0 * x * (1.0 + x**2) ** -3.0
        assert parabola.at(s).curvature_rate[0] == pytest.approx(rate, abs=1e-7)


@pytest.mark.parametrize("closed", [False, True])
def test_a_polyline_keeps_to_its_legs_and_its_corners_are_as_tight_as_said(closed):
    radius = 0.8
    path = polyline(CORNERS, radius, closed)
    legs = list(zip(CORNERS, CORNERS[1:] + (CORNERS[:1] if closed else []), strict=False))
    tightest = 0.0
    for s in np.linspace(0.0, path.length, 5001):
        point = path.at(s)
        bending = np.hypot(*point.curvature)
        tightest = max(tightest, bending)
        if bending < 1e-9:
            assert min(from_segment(point.position, *leg) for leg in legs) < 1e-9
    assert tightest == pytest.approx(1.0 / radius, rel=1e-3)
    if not closed:
        np.testing.assert_allclose(path.at(0.0).position, CORNERS[0], atol=1e-12)
        np.testing.assert_allclose(path.at(path.length).position, CORNERS[-1], atol=1e-11)


def from_segment(point, a, b):
    a, b = np.array(a), np.array(b)
    share = np.clip((point - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    return np.linalg.norm(point - a - share * (b - a))


def test_the_radius_said_to_fit_fits_and_no_larger_one():
    with pytest.raises(PathError, match="from point 1 to point 2") as caught:
        polyline(CORNERS, 3.0)
    largest = float(str(caught.value).split("fits is ")[1].split(" m")[0])
    polyline(CORNERS, 0.99 * largest)
    with pytest.raises(PathError):
        polyline(CORNERS, 1.01 * largest)


REFUSED = {
    "line without length": (lambda: Line([1.0, 1.0, 1.0], [1.0, 1.0, 1.0]), "two different points", ()),
    "arc on a line": (lambda: arc_through([0, 0, 0], [1, 1, 1], [3, 3, 3]), "lie on a line", ("through_m",)),
    "arc of two points": (lambda: arc_through([0, 0, 0], [1, 1, 1], [0, 0, 0]), "three different", ("end_m",)),
    "circle without axis": (lambda: circle([0, 0, 0], 1.0, [0, 0, 0]), "needs a direction", ("axis",)),
    "one point": (lambda: spline([[0, 0, 0]]), "2 or more points, got 1", ()),
    "two points closed": (lambda: spline([[0, 0, 0], [1, 0, 0]], True), "3 or more points, got 2", ()),
    "points that coincide": (lambda: spline([[0, 0, 0], [1, 0, 0], [1, 0, 0]]), "point 2 coincides with point 1", (2,)),
    "first point repeated": (
        lambda: spline([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0]], True),
        "point 3 repeats point 0",
        (3,),
    ),
    "not a number": (lambda: spline([[0, 0, 0], [1, 0, np.nan]]), "point 1 is not finite", (1,)),
    "doubling back": (lambda: polyline([[0, 0, 0], [5, 0, 0], [1, 0, 0]], 0.1), "doubles back at point 1", (1,)),
    "spline doubling back": (lambda: spline([[0, 0, 0], [5, 0, 0], [0, 0, 0]]), "doubles back at point 1", (1,)),
    "closed spline doubling back": (
        lambda: spline([[0, 0, 0], [5, 0, 0], [9, 0, 0]], True),
        "doubles back at point 0",
        (0,),
    ),
    "too far away": (lambda: spline([[0, 0, 0], [1, 0, 0], [1e300, 1, 1]]), r"coordinate of 1e\+300 m", (2,)),
    "a speck": (lambda: spline([[0, 0, 0], [1e-5, 0, 0]]), "a path of 1e-05 m", ()),
    "corner too wide": (lambda: polyline(CORNERS, 3.0), "largest radius that fits", (2,)),
}


@pytest.mark.parametrize(("make", "says", "below"), REFUSED.values(), ids=REFUSED.keys())
def test_what_makes_no_path_is_refused_with_its_place(make, says, below):
    with pytest.raises(PathError, match=says) as caught:
        make()
    assert caught.value.below == below


def test_a_cusp_is_refused():
    with pytest.raises(PathError, match="kink or a cusp"):
        tabulate([0.0, 0.0, 0.0], [Piece(lambda u: np.column_stack([u - 0.3, (u - 0.3) ** 2, 0.0 * u]), 1.0)])


def test_a_curve_that_stops_between_two_pieces_and_turns_is_refused():
    ahead, back = (
        Piece(lambda u, way=way: np.outer(way * (1.0 - u), [1.0, 0.0, 0.0]), 1.0, (i,)) for i, way in ((0, 1), (1, -1))
    )
    with pytest.raises(PathError, match="kink or a cusp") as caught:
        tabulate([0.0, 0.0, 0.0], [ahead, back])
    assert caught.value.below == (1,)


def test_a_curve_that_bends_without_end_is_refused_and_not_tabulated(monkeypatch):
    monkeypatch.setattr(tabulation, "MOST_CELLS", 500)
    wild = [Piece(lambda u: np.column_stack([np.ones_like(u), 5.0 * np.sin(300.0 * u), 0.0 * u]), 1.0)] * 20
    with pytest.raises(PathError, match="more than 500 polynomials"):
        tabulate([0.0, 0.0, 0.0], wild)


@pytest.mark.flight
def test_no_accepted_path_through_points_has_a_frame_that_is_none():
    """Random walks, among them ones that run back the way they came, exactly or nearly."""
    rng = np.random.default_rng(11)
    refused = accepted = 0
    for n in range(160):
        points = np.cumsum(rng.normal(size=(rng.integers(3, 6), 3)), axis=0)
        if n % 2:  # back to the last point but one, beside it by nothing or by 1e-9 to 3 m
            beside = rng.normal(size=3) * (0.0 if n % 8 == 1 else 10.0 ** rng.uniform(-9.0, 0.5))
            points = np.vstack([points, points[-2] + beside])
        for make in (lambda closed, p=points: spline(p, closed), lambda closed, p=points: polyline(p, 0.01, closed)):
            for closed in (False, True):
                try:
                    path = make(closed)
                except PathError:
                    refused += 1
                    continue
                accepted += 1
                for s in np.linspace(0.0, path.length, 60):
                    point = path.at(s)
                    np.testing.assert_allclose(point.rotation.T @ point.rotation, np.eye(3), atol=1e-9)
                    assert np.isfinite([*point.position, *point.curvature, *point.curvature_rate]).all()
    assert refused > 100
    assert accepted > 100


def test_random_splines_keep_all_promises():
    rng = np.random.default_rng(7)
    for _ in range(10):
        path = spline(np.cumsum(rng.normal([1.5, 0.0, 0.0], 1.0, (12, 3)), axis=0))
        for s in rng.uniform(H, path.length - H, 20):
            point = path.at(s)
            step = derivative(path, s, lambda p: p.position)
            np.testing.assert_allclose(step, point.rotation[:, 0], atol=1e-8)
            np.testing.assert_allclose(point.rotation.T @ point.rotation, np.eye(3), atol=1e-14)


@pytest.mark.parametrize("column", ["t_s", "speed", "Speed [m/s]", "yaw_deg", "time", "v_m_s", "heading"])
def test_a_column_that_would_have_no_effect_is_refused(tmp_path, column):
    table = tmp_path / "points.csv"
    table.write_text(f"{column},x_m,y_m,z_m\n0,0,0,-5\n1,3,0,-5\n")
    with pytest.raises(PathError, match=rf"points.csv, row 1: column {re.escape(column)} would have no effect"):
        read_waypoints(table)


@pytest.mark.parametrize("column", ["remark", "depth_m", "index", "temperature_C", "vehicle"])
def test_other_columns_are_left_alone(tmp_path, column):
    table = tmp_path / "points.csv"
    table.write_text(f"{column},x_m,y_m,z_m\n0,0,0,-5\n1,3,0,-5\n")
    assert read_waypoints(table)[0].shape == (2, 3)
