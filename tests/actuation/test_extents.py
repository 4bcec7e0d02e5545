"""Attainable forces and torques: closed forms, linear and mixed-integer programs, a brute-force search."""

import itertools
from itertools import combinations, product

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, linprog, milp
from scipy.spatial import ConvexHull
from support.layouts import jack
from support.vehicles import vehicle

from cube_sim.actuation.attainable.extents import extent, extents, force_corners, torque_corners
from cube_sim.errors import ActuationError
from cube_sim.wrench import attained_intervals, wrench_set
from cube_sim.wrench.zonotope import inscribed_radius, support, volume

JACK = jack()
T200 = [-39.91, -0.356, 0.400, 51.44]


@pytest.fixture(scope="module")
def cube():
    return vehicle("cube").actuation_matrix


def lp_extent(A, low, high, d, sign):
    """Largest t of sign * t d = A F over the box, by HiGHS; nan when infeasible."""
    m = A.shape[1]
    result = linprog(
        np.r_[np.zeros(m), -sign],
        A_eq=np.c_[A, -d],
        b_eq=np.zeros(len(A)),
        bounds=[*zip(low, high, strict=True), (None, None)],
    )
    return result.x[-1] if result.status == 0 else np.nan


@pytest.mark.parametrize("n", [3, 6])
def test_isolated_and_unconstrained_agree_with_linear_programs(n):
    rng = np.random.default_rng(n)
    for _ in range(6):
        m = int(rng.integers(n - 1, 9))
        A = rng.normal(size=(n, m))
        limits = np.sort(np.c_[-rng.uniform(1, 40, m), rng.uniform(1, 50, m)], axis=1)
        d = rng.normal(size=n)
        e = extent(A, limits, d)
        for end, sign in ((0, -1), (1, 1)):
            assert e.isolated[end] == pytest.approx(lp_extent(A, *limits.T, d, sign), abs=1e-6)
            free = linprog(-sign * (d @ A) / (d @ d), bounds=limits)
            assert e.unconstrained[end] == pytest.approx(-sign * free.fun)


def test_random_feasible_forces_never_leave_the_extents(cube):
    rng = np.random.default_rng(5)
    F = rng.uniform(T200[0], T200[3], size=(2000, 8))
    for j, e in enumerate(extents(cube, T200)):
        values = F @ cube[j]
        assert e.unconstrained[0] <= values.min()
        assert values.max() <= e.unconstrained[1]
        assert e.unconstrained[0] - 1e-9 <= e.isolated[0] < 0 < e.isolated[1] <= e.unconstrained[1] + 1e-9


def test_cube_surge_alone_is_what_its_symmetry_gives():
    # One newton each of the four x-driving pairs: A A' = 8/3 I, least-norm forces of Fx are 3/8 of the row.
    cube = vehicle("cube").actuation_matrix
    row = cube[0]
    symmetric = extents(cube, [-40.0, 40.0])[0]
    assert symmetric.isolated[1] >= 40 / np.max(np.abs(row)) / (3 / 8) - 1e-9
    assert symmetric.isolated[0] == pytest.approx(-symmetric.isolated[1])
    assert symmetric.unconstrained[1] == pytest.approx(40 * np.sum(np.abs(row)))


def cells(limits, rest):
    return product(*[[(a, b), (0.0, 0.0), (c, d)] if rest else [(a, b), (c, d)] for a, b, c, d in limits])


def brute_intervals(A, limits, d, rest):
    found = []
    for cell in cells(limits, rest):
        low, high = np.array(cell).T
        ends = [lp_extent(A, low, high, d, sign) for sign in (-1, 1)]
        if not np.isnan(ends).any():
            found.append(ends)
    joined = []
    for low, high in sorted(found):
        if joined and low <= joined[-1][1] + 1e-7:
            joined[-1][1] = max(joined[-1][1], high)
        else:
            joined.append([low, high])
    return np.array(joined).reshape(-1, 2)


@pytest.mark.flight
@pytest.mark.parametrize("rest", [True, False])
@pytest.mark.parametrize("component", [0, 1, 2])
def test_dead_zone_intervals_agree_with_one_linear_program_per_cell(rest, component):
    limits = np.array([[-30, -3, 4, 40], [-35, -2, 3, 45], [-30, -4, 2, 40], [-32, -3, 3, 38]], dtype=float)
    rng = np.random.default_rng(component)
    for A in (JACK, JACK + 0.05 * rng.normal(size=JACK.shape)):
        d = np.eye(3)[component]
        ours = extent(A, limits, d, rest=rest).isolated_with_dead_zones
        assert ours is not None
        assert np.allclose(ours, brute_intervals(A, limits, d, rest), atol=1e-6)


def test_common_regime_makes_the_smallest_force_zero_and_its_loss_brings_the_dead_zone_back():
    # Jack's kernel (1,1,1,1) lifts all four thrusters out of their dead zones at zero wrench ...
    intact = extent(JACK, [-40, -2, 2, 40], [1, 0, 0])
    assert intact.smallest_nonzero == (0.0, 0.0)
    # ... with three thrusters F_m follows from F_B, and the weakest thruster's dead zone bounds the force.
    A = JACK[:, :3]
    share = np.linalg.solve(A, [1, 0, 0])
    moved = np.abs(share) > 1e-12
    least = 2 / np.min(np.abs(share[moved]))
    assert extent(A, [-40, -2, 2, 40], [1, 0, 0]).smallest_nonzero == pytest.approx((least, least))


def test_lost_component_is_attainable_at_zero_only():
    e = extent([[1, 1, 1, 1], [0, 0, 0, 0], [-1, 1, -1, 1]], T200, [0, 1, 0])
    assert e.isolated == (0.0, 0.0)
    assert e.unconstrained == (0.0, 0.0)
    assert np.array_equal(e.isolated_with_dead_zones, [[0, 0]])
    assert e.smallest_nonzero == (np.inf, np.inf)


def test_without_rest_a_wrench_set_can_be_empty():
    # One thruster alone on its row of wrench space cannot produce zero when it may not stand still.
    e = extent(np.eye(3), [-10, -1, 1, 10], [1, 0, 0], rest=False)
    assert e.isolated == (-10, 10)
    assert e.isolated_with_dead_zones is not None
    assert e.isolated_with_dead_zones.shape == (0, 2)


def test_thrusters_at_round_angles_keep_the_intervals_that_rounding_makes_thin():
    # T2 = T4 = F, the others at rest, makes Mz = 0.3 F: to rounding, for the cosines of the angles are.
    angles, levers = np.radians([225.0, 180.0, 195.0, 0.0]), np.array([-0.2, 0.1, 0.2, 0.2])
    A = np.array([np.cos(angles), np.sin(angles), levers])
    yaw = extents(A, [0, 0, 3, 40])[2]
    assert yaw.isolated_with_dead_zones == pytest.approx(np.array([[0, 0], [0.9, 12]]), abs=1e-9)
    assert yaw.smallest_nonzero[1] == pytest.approx(0.9)


def milp_end(A, limits, d, sign, least=-np.inf):
    """Largest sign * t, t >= least, with t d = A F and F on allowed sides or at rest, by HiGHS; nan when infeasible."""
    n, m = A.shape
    F, sides, t = slice(0, m), slice(m, 3 * m), 3 * m  # F, then one switch per thruster and side, then t
    wrench, low, high = np.zeros((n, 3 * m + 1)), np.zeros((m, 3 * m + 1)), np.zeros((m, 3 * m + 1))
    wrench[:, F], wrench[:, t] = A, -d
    low[:, F] = high[:, F] = np.eye(m)
    low[:, sides] = -np.hstack([np.diag(limits[:, 0]), np.diag(limits[:, 2])])
    high[:, sides] = -np.hstack([np.diag(limits[:, 1]), np.diag(limits[:, 3])])
    one_side = np.zeros((m, 3 * m + 1))
    one_side[:, sides] = np.hstack([np.eye(m), np.eye(m)])
    cost = np.zeros(3 * m + 1)
    cost[t] = -sign
    free = np.full(3 * m + 1, np.inf)
    bottom = -free
    bottom[sides], free[sides], bottom[t] = 0, 1, least
    result = milp(
        cost,
        constraints=[
            LinearConstraint(wrench, 0, 0),
            LinearConstraint(low, 0, np.inf),
            LinearConstraint(high, -np.inf, 0),
            LinearConstraint(one_side, 0, 1),
        ],
        integrality=np.r_[np.zeros(m), np.ones(2 * m), 0],
        bounds=Bounds(bottom, free),
    )
    return result.x[t] if result.status == 0 else np.nan


@pytest.mark.flight
@pytest.mark.parametrize(("n", "m", "dead"), [(3, 12, 15.0), (6, 8, 20.0), (6, 8, 30.0), (6, 12, 20.0)])
def test_dead_zone_intervals_agree_with_a_mixed_integer_program(n, m, dead):
    rng = np.random.default_rng((n, m))
    A, limits = rng.normal(size=(n, m)), np.tile([-40.0, -dead, dead, 50.0], (m, 1))
    for d in np.eye(n)[:3]:
        intervals = extent(A, limits, d).isolated_with_dead_zones
        assert intervals is not None
        assert intervals[0, 0] == pytest.approx(milp_end(A, limits, d, -1), abs=1e-4)
        assert intervals[-1, 1] == pytest.approx(milp_end(A, limits, d, 1), abs=1e-4)
        for (_, gap), (end, _) in itertools.pairwise(intervals[:4]):
            if end - gap > 0.01:
                assert end == pytest.approx(milp_end(A, limits, d, -1, least=gap + 0.005), abs=1e-4)


def test_thrusters_without_effect_change_nothing():
    idle = np.hstack([JACK, np.zeros((3, 8))])
    for d in np.eye(3):
        few, many = (extent(A, [-40, -2, 2, 40], d).isolated_with_dead_zones for A in (JACK[:, :3], idle[:, 1:]))
        whole = extent(JACK[:, 1:], [-40, -2, 2, 40], d).isolated_with_dead_zones
        assert few is not None
        assert many is not None
        assert whole is not None
        assert np.allclose(many, whole)
        assert len(few) == 3


def test_one_thruster_attains_what_its_characteristic_does():
    rng = np.random.default_rng(3)
    for n in (3, 6):
        column = rng.normal(size=(n, 1))
        e = extent(column, T200, 2.0 * column[:, 0])
        assert e.isolated == pytest.approx((T200[0] / 2, T200[3] / 2))
        assert e.isolated_with_dead_zones == pytest.approx(np.array([[-39.91, -0.356], [0, 0], [0.4, 51.44]]) / 2)
        assert extent(column, T200, np.eye(n)[0]).isolated == (0.0, 0.0)


def test_the_search_is_the_same_compiled_and_not_and_gives_up_when_it_takes_too_long(monkeypatch):
    rng = np.random.default_rng(6)
    A, limits, d = rng.normal(size=(6, 8)), [-40, -30, 30, 50], np.eye(6)[1]
    compiled = extent(A, limits, d).isolated_with_dead_zones
    monkeypatch.setattr(wrench_set, "attained", attained_intervals.attained.py_func)
    plain = extent(A, limits, d).isolated_with_dead_zones
    assert compiled is not None
    assert plain is not None
    assert np.allclose(compiled, plain, rtol=0, atol=1e-12)
    monkeypatch.setattr(attained_intervals, "MOST_WORK", 100)
    e = extent(A, limits, d)
    assert e.isolated_with_dead_zones is None
    assert e.smallest_nonzero is None


def test_corners_span_the_attainable_sets(cube):
    rng = np.random.default_rng(9)
    for A in (cube, np.delete(cube, [0, 1], axis=1)):
        forces, torques = A[:3], A[3:]
        for corners, wanted, zero in (
            (force_corners(A, T200), forces, torques),
            (torque_corners(A, T200), torques, forces),
        ):
            for direction in rng.normal(size=(8, 3)):
                lp = linprog(-direction @ wanted, A_eq=zero, b_eq=np.zeros(3), bounds=(T200[0], T200[3]))
                assert np.max(corners @ direction) == pytest.approx(-lp.fun, abs=1e-6)


def test_zonotope_closed_forms_agree_with_its_convex_hull():
    rng = np.random.default_rng(2)
    for r, m in ((2, 5), (3, 6), (4, 7)):
        G = rng.normal(size=(r, m))
        low, high = -rng.uniform(1, 2, m), rng.uniform(1, 3, m)
        hull = ConvexHull(np.array(list(product(*zip(low, high, strict=True)))) @ G.T)
        assert volume(G, low, high) == pytest.approx(hull.volume)
        assert inscribed_radius(G, low, high) == pytest.approx(np.min(-hull.equations[:, -1]))
        directions = rng.normal(size=(10, r))
        assert np.allclose(support(G, low, high, directions), np.max(hull.points[hull.vertices] @ directions.T, axis=0))


def test_inscribed_radius_vanishes_for_one_sided_thrusters():
    assert inscribed_radius(np.eye(2), np.zeros(2), np.ones(2)) == 0.0


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ([[1, 2, 3, 4]] * 4, "thruster 1"),
        ([-1, np.nan, 0, 1], "thruster 1"),
        (np.zeros((3, 4)), "shape"),
        ("strong", "not a table of numbers"),
    ],
)
def test_malformed_limits_are_refused(limits, message):
    with pytest.raises(ActuationError, match=message):
        extents(JACK, limits)


def test_every_cell_of_the_cube_after_two_losses_agrees_with_its_linear_program(cube):
    lost = next(pair for pair in combinations(range(8), 2) if np.linalg.matrix_rank(np.delete(cube, pair, 1)) == 6)
    A = np.delete(cube, lost, axis=1)
    e = extent(A, [-40, -4, 4, 50], [0, 0, 1, 0, 0, 0])
    share = np.linalg.solve(A, np.eye(6)[2])
    used = share[np.abs(share) > 1e-9]
    assert e.isolated[1] == pytest.approx(np.min(np.where(used > 0, 50, -40) / used))
    assert e.smallest_nonzero is not None
    assert e.smallest_nonzero[1] == pytest.approx(np.max(4 / np.abs(used)))
