"""The parts the allocator is made of: the projection, the relaxation, and ProxQP on one subset."""

import numpy as np
import pytest
from support.layouts import cube

from cube_sim.allocation import Allocator
from cube_sim.allocation.exact.active_set import CUT, INFEASIBLE, OPTIMAL, project
from cube_sim.allocation.exact.relaxation import choose_side, relax, split
from cube_sim.allocation.exact.sides import SideCost, SideIntervals
from cube_sim.allocation.exact.solutions import force_solutions, wrench_metric
from cube_sim.allocation.subset_qp.problem import SubsetQP
from cube_sim.allocation.subset_qp.solver import SubsetSolver


def solve(rows, low, high, start, cutoff=np.inf, function=project):
    point, multiplier = np.empty(rows.shape[1]), np.empty(len(rows))
    return function(rows, low, high, start, cutoff, 1e-10, point, multiplier), point, multiplier


def random_strips(rng):
    m, k = int(rng.integers(1, 13)), int(rng.integers(1, 7))
    rows = rng.normal(size=(m, k))
    if rng.random() < 0.3:
        rows = rows[rng.integers(0, max(1, m // 2), size=m)] * rng.choice([1.0, -1.0], size=(m, 1))  # parallel strips
    inside = rng.normal(size=k)
    width = rng.choice([0.0, 0.1, 1.0], size=m)
    return rows, rows @ inside - width * rng.random(m), rows @ inside + width * rng.random(m), 5 * rng.normal(size=k)


def test_projection_satisfies_its_optimality_conditions():
    """Feasible, stationary, multipliers of the right sign and only on active ends: necessary and sufficient."""
    rng = np.random.default_rng(0)
    for _ in range(2000):
        rows, low, high, start = random_strips(rng)
        outcome, point, multiplier = solve(rows, low, high, start)
        value = rows @ point
        assert outcome == OPTIMAL
        assert np.all(value >= low - 1e-8)
        assert np.all(value <= high + 1e-8)
        assert np.allclose(point - start + rows.T @ multiplier, 0.0, atol=1e-7)
        assert np.all((multiplier >= -1e-9) | (value <= low + 1e-8))
        assert np.all((multiplier <= 1e-9) | (value >= high - 1e-8))


def test_projection_stops_only_beyond_the_cutoff():
    rng = np.random.default_rng(1)
    for _ in range(300):
        strips = random_strips(rng)
        _, point, _ = solve(*strips)
        distance = np.sum((point - strips[3]) ** 2)
        assert solve(*strips, cutoff=1.001 * distance + 1e-9)[0] == OPTIMAL
        if distance > 1e-6:
            assert solve(*strips, cutoff=0.999 * distance)[0] == CUT


def test_projection_knows_an_empty_set():
    rows = np.array([[1.0, 0.0], [1.0, 1e-3], [0.0, 1.0]])
    assert solve(rows, np.array([0.0, 2.0, -1.0]), np.array([1.0, 3.0, 1.0]), np.zeros(2))[0] == INFEASIBLE
    assert solve(np.zeros((1, 2)), np.array([1.0]), np.array([2.0]), np.zeros(2))[0] == INFEASIBLE
    no_freedom = np.empty((2, 0))
    assert solve(no_freedom, np.array([-1.0, -1.0]), np.ones(2), np.empty(0))[0] == OPTIMAL
    assert solve(no_freedom, np.array([0.5, -1.0]), np.ones(2), np.empty(0))[0] == INFEASIBLE


def test_compiled_projection_is_the_readable_one():
    rng = np.random.default_rng(2)
    for _ in range(50):
        strips = random_strips(rng)
        compiled, plain = solve(*strips), solve(*strips, function=project.py_func)
        assert compiled[0] == plain[0]
        assert np.allclose(compiled[1], plain[1], atol=1e-9)


def test_relaxation_never_exceeds_the_true_cost():
    """For every mask of open sides and every allowed force, also with a target and a price of its own per side."""
    rng = np.random.default_rng(3)
    m = 20
    low, high = np.empty((m, 3)), np.empty((m, 3))
    low[:, 0], high[:, 0] = -rng.uniform(5, 9, m), -rng.uniform(1, 5, m)
    low[:, 1], high[:, 1] = 0.0, 0.0
    low[:, 2], high[:, 2] = rng.uniform(1, 5, m), rng.uniform(5, 9, m)
    target, penalty, weight = rng.normal(size=(m, 3)) * 6, rng.random((m, 3)) * 9, rng.uniform(0.1, 3, m)
    relaxed = np.empty((m, 8, 4))
    relax(low, high, target, penalty, weight, relaxed)
    for i in range(m):
        for mask in range(1, 8):
            bottom, top, t, c = relaxed[i, mask]
            gaps = []
            for s in range(3):
                if mask >> s & 1:
                    f = np.linspace(low[i, s], high[i, s], 21)
                    true = weight[i] * (f - target[i, s]) ** 2 + penalty[i, s]
                    gaps.append(np.min(true - weight[i] * (f - t) ** 2 - c))
                    assert bottom <= f[0]
                    assert top >= f[-1]
            assert min(gaps) == pytest.approx(0.0, abs=1e-9)  # below, and touching


def open_sides(low, high):
    """Sides of one thruster, none empty; nothing here looks at their relaxation."""
    return SideIntervals(low, high, np.array([7]), np.empty((1, 8, 4)))


def test_splitting_loses_no_side_and_always_shrinks():
    low, high = np.array([[-9.0, 0.0, 2.0]]), np.array([[-2.0, 0.0, 9.0]])
    for mask in range(1, 8):
        for f in (-9.0, -2.0, -1.5, -0.5, 0.0, 0.5, 1.5, 2.0, 9.0):
            first, second = split(f, 0, mask, open_sides(low, high))
            assert first | second == mask
            assert first & second == 0
            assert first != 0
            nearest = min(max(low[0, s] - f, f - high[0, s], 0.0) for s in range(3) if mask >> s & 1)
            assert any(max(low[0, s] - f, f - high[0, s], 0.0) == nearest for s in range(3) if first >> s & 1)


def test_touching_sides_choose_off_then_the_sign():
    low, high = np.array([[-9.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 9.0]])
    intervals, side_cost = open_sides(low, high), SideCost(np.ones(1), np.zeros((1, 3)), np.zeros((1, 3)))
    assert choose_side(0.0, 0, 7, intervals, side_cost, 0.0) == (1, 0.0)
    assert choose_side(3.0, 0, 7, intervals, side_cost, 0.0) == (2, 9.0)
    assert choose_side(-3.0, 0, 7, intervals, side_cost, 0.0) == (0, 9.0)
    assert choose_side(3.0, 0, 3, intervals, side_cost, 0.0)[0] == -1


def test_solutions_make_the_wrench_with_orthonormal_freedom():
    A, weights = cube(direction_noise=0.05, seed=2), np.linspace(0.5, 2.0, 8)
    solutions = force_solutions(A, weights, 0.35)
    assert solutions.rank == 6
    assert np.allclose(A @ solutions.particular, np.eye(6))
    assert np.allclose(A @ solutions.null_space, 0.0)
    assert np.allclose(solutions.null_space.T @ (weights[:, None] * solutions.null_space), np.eye(2))
    assert np.allclose(solutions.null_space.T @ (weights[:, None] * solutions.particular), 0.0)
    assert np.allclose(solutions.outside_range, 0.0)


def test_distance_coordinates_measure_the_weighted_wrench():
    rng = np.random.default_rng(4)
    A, weights = rng.normal(size=(6, 2)) @ rng.normal(size=(2, 5)), rng.uniform(0.5, 30, 6)
    metric = wrench_metric(A, weights)
    f = rng.normal(size=5)
    assert metric.G.shape == (2, 5)
    assert np.allclose(metric.basis @ metric.G @ f, weights * (A @ f))
    assert np.allclose(metric.G_pinv @ metric.G @ f + metric.null_space @ metric.null_space.T @ f, f)


def test_proxqp_from_afar_and_from_the_answer_agree():
    A = cube()
    solutions = force_solutions(A, np.ones(8), 0.35)
    origin = solutions.particular @ [10.0, -5, 8, 1, 0.5, -1]
    side = Allocator(A, [-40, -4, 4, 50], allow_off=False).allocate([10.0, -5, 8, 1, 0.5, -1]).subset
    low, high = np.where(side > 0, 4.0, -40.0), np.where(side > 0, 50.0, -4.0)
    problem = SubsetQP(np.ones(8), np.zeros(8), solutions.equations, solutions.equations @ origin, low, high)
    solver = SubsetSolver(np.ones(8), solutions.equations)
    cold = solver.solve(problem)
    z, mu = np.empty(2), np.empty(8)
    assert project(solutions.null_space, low - origin, high - origin, np.zeros(2), np.inf, 1e-9, z, mu) == OPTIMAL
    force = origin + solutions.null_space @ z
    warm = solver.solve(problem, (force, -solutions.equations @ (force + mu), mu))
    assert cold.trusted
    assert warm.trusted
    assert np.allclose(cold.force, warm.force, atol=1e-6)
    assert warm.iterations <= cold.iterations


def test_proxqp_does_not_believe_an_infeasible_subset_and_stops():
    solutions = force_solutions(cube(), np.ones(8), 0.35)
    problem = SubsetQP(
        np.ones(8),
        np.zeros(8),
        solutions.equations,
        solutions.equations @ np.full(8, 30.0),
        np.full(8, -40.0),
        np.full(8, -4.0),
    )
    solution = SubsetSolver(np.ones(8), solutions.equations).solve(problem)
    assert not solution.trusted
    assert solution.iterations <= 200 * 50
    assert np.all((solution.force >= problem.low) & (solution.force <= problem.high))
