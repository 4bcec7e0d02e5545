"""Rank, range, kernel and words of actuation matrices: the report's section 4.1 and the CUBE's exact geometry."""

from collections import Counter
from itertools import combinations

import numpy as np
import pytest
from support.vehicles import vehicle

from cube_sim.actuation.directions.subspaces import subspaces
from cube_sim.errors import ActuationError

REPORT_411 = [[1, 1, 1, 1], [0, 0, 0, 0], [-1, 1, -1, 1]]


def random_matrix(rng, n, m, rank):
    return rng.normal(size=(n, rank)) @ rng.normal(size=(rank, m))


@pytest.fixture(scope="module")
def cube():
    return vehicle("cube").actuation_matrix


def test_example_411_loses_sway_and_says_so():
    s = subspaces(REPORT_411)
    assert np.allclose(np.eye(3) - s.projector, np.diag([0, 1, 0]), atol=1e-15)
    assert s.rank == 2
    assert s.redundancy == 2
    assert s.redundant
    assert [str(c) for c in s.unreachable] == ["cannot push sideways: Fy = 0 always"]
    assert np.allclose(np.abs(s.unreachable[0].coefficients), [0, 1, 0])
    assert s.isolated == (True, False, True)
    assert s.pure_forces.shape == (2, 1)
    assert s.pure_torques.shape == (1, 1)


@pytest.mark.parametrize("n", [3, 6])
@pytest.mark.parametrize("m", [1, 2, 4, 8, 12])
def test_subspaces_are_what_they_are_called(n, m):
    rng = np.random.default_rng((n, m))
    for rank in range(1, min(n, m) + 1):
        A = random_matrix(rng, n, m, rank)
        s = subspaces(A, rank_tolerance=1e-9)
        assert s.rank == rank
        assert np.allclose(A @ s.kernel_basis, 0, atol=1e-12 * np.linalg.norm(A))
        assert np.allclose(s.kernel_basis.T @ s.kernel_basis, np.eye(m - rank))
        assert np.allclose(s.projector @ A, A)
        assert np.allclose(s.projector @ s.projector, s.projector)
        assert np.allclose(A @ s.pseudo_inverse, s.projector)
        assert np.linalg.matrix_rank(np.hstack([s.range_basis, A])) == rank
        conditions = np.array([c.coefficients for c in s.unreachable]).reshape(-1, n)
        assert np.allclose(conditions @ A, 0, atol=1e-9 * np.linalg.norm(A))
        assert np.linalg.matrix_rank(conditions) == n - rank if rank < n else len(conditions) == 0


def test_all_solutions_solve_and_the_particular_one_is_the_shortest():
    rng = np.random.default_rng(7)
    A = random_matrix(rng, 6, 8, 5)
    s = subspaces(A, rank_tolerance=1e-9)
    F_B = A @ rng.normal(size=8)
    solutions = s.solutions(F_B)
    assert s.reachable(F_B)
    assert np.allclose(solutions.unreachable, 0, atol=1e-12)
    for parameters in rng.normal(size=(20, 3)):
        F_m = solutions.force(parameters)
        assert np.allclose(A @ F_m, F_B)
        assert F_m @ F_m == pytest.approx(solutions.particular @ solutions.particular + parameters @ parameters)


def test_out_of_reach_wrench_leaves_its_unreachable_part():
    s = subspaces(REPORT_411)
    assert not s.reachable([1, 2, 3])
    solutions = s.solutions([1, 2, 3])
    assert np.allclose(solutions.unreachable, [0, 2, 0])
    assert np.allclose(np.array(REPORT_411) @ solutions.particular, [1, 0, 3])


def test_rank_and_projector_do_not_depend_on_the_unit_of_length(cube):
    for lost in ([], [0], [0, 3], [0, 1, 2]):
        A = np.delete(cube, lost, axis=1)
        in_millimetres = np.vstack([A[:3], 1000 * A[3:]])
        metres, millimetres = subspaces(A), subspaces(in_millimetres)
        assert metres.rank == millimetres.rank
        assert np.allclose(metres.singular_values, millimetres.singular_values)
        units = np.array([1, 1, 1, 1000, 1000, 1000])
        assert np.allclose(millimetres.projector, units[:, None] * metres.projector / units, atol=1e-9)


def test_cube_has_equal_authority_and_the_common_regime_in_its_kernel(cube):
    s = subspaces(cube)
    assert np.allclose(cube @ cube.T, np.diag([8 / 3] * 3 + [0.32] * 3))
    assert s.length_m == pytest.approx(0.2 * np.sqrt(3))
    regime = np.array([1, -1, 1, -1, -1, 1, -1, 1.0])
    assert np.allclose(s.kernel_basis @ (s.kernel_basis.T @ regime), regime)


@pytest.mark.parametrize(
    ("losses", "expected"),
    [
        (1, {(6, 3, 3): 8}),
        (2, {(6, 3, 3): 16, (5, 2, 2): 12}),
        (3, {(5, 2, 2): 48, (4, 1, 1): 8}),
    ],
)
def test_cube_losses_have_the_ranks_and_pure_directions_of_its_geometry(cube, losses, expected):
    length_m = subspaces(cube).length_m
    counted = Counter()
    for lost in combinations(range(8), losses):
        s = subspaces(np.delete(cube, lost, axis=1), length_m=length_m)
        counted[s.rank, s.pure_forces.shape[1], s.pure_torques.shape[1]] += 1
        for force in s.pure_forces.T:
            assert s.reachable([*force, 0, 0, 0], tolerance=1e-6)
        for torque in s.pure_torques.T:
            assert s.reachable([0, 0, 0, *torque], tolerance=1e-6)
    assert counted == expected


def test_nearly_lost_direction_counts_as_lost_at_the_default_tolerance_only():
    A = [[1, 1, 1, 1], [1e-3, 0, 0, 0], [-1, 1, -1, 1]]
    assert subspaces(A).rank == 2
    assert subspaces(A, rank_tolerance=0).rank == 3
    assert subspaces([[0, 0], [0, 0], [0, 0]]).rank == 0


def test_words_name_lost_components_first_and_tie_the_others_in_physical_units():
    # Two thrusters 0.5 m to the left, pushing forwards and up: My and Fy are lost; Mx, Mz follow Fz, Fx.
    columns = [[*direction, *np.cross([0, 0.5, 0], direction)] for direction in ([1, 0, 0], [0, 0, 1])]
    s = subspaces(np.array(columns).T)
    assert [str(c) for c in s.unreachable] == [
        "cannot push sideways: Fy = 0 always",
        "cannot pitch: My = 0 always",
        "Fx and Mz only together: Fx + 2 Mz/m = 0 always",
        "Fz and Mx only together: Fz - 2 Mx/m = 0 always",
    ]


@pytest.mark.parametrize(
    ("A", "message"),
    [
        (np.ones((4, 3)), "6 rows"),
        (np.ones(6), "6 rows"),
        (np.ones((6, 0)), "no thruster is left"),
        ([[1, 2], [np.nan, 0], [0, 0]], "row 2, column 1"),
        ("thrusters", "not a table of numbers"),
    ],
)
def test_malformed_matrix_is_one_clear_line(A, message):
    with pytest.raises(ActuationError, match=message) as raised:
        subspaces(A)
    assert "\n" not in str(raised.value)


def test_malformed_options_are_refused():
    with pytest.raises(ActuationError, match="length"):
        subspaces(REPORT_411, length_m=0)
    with pytest.raises(ActuationError, match="tolerance"):
        subspaces(REPORT_411, rank_tolerance=float("nan"))
    with pytest.raises(ActuationError, match="3 finite numbers"):
        subspaces(REPORT_411).solutions([1, 2, np.inf])
