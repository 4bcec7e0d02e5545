"""Damping that would feed energy in is refused, and none that would not: against a search over motions."""

from __future__ import annotations

import numpy as np
import pytest

from cube_sim.errors import ModelError
from cube_sim.vehicle.damping import require_dissipative, require_pairwise_dissipative

NAME = "hull:damping"
SPEEDS = np.concatenate([np.geomspace(1e-4, 1e4, 801), -np.geomspace(1e-4, 1e4, 801)])


def refuses(check, matrix: np.ndarray) -> bool:
    try:
        check(NAME, matrix)
    except ModelError as error:
        return error.element == NAME
    return False


def least_power_of_a_pair(matrix: np.ndarray) -> float:
    """Smallest nu'D_q(|nu| nu) over motions along axes 2 and 6, the second at speed 1, relative to its parts."""
    t = SPEEDS
    parts = np.array(
        [
            matrix[1, 1] * np.abs(t) ** 3,
            matrix[1, 5] * t,
            matrix[5, 1] * np.abs(t) * t,
            np.full_like(t, matrix[5, 5]),
        ]
    )
    return float((parts.sum(axis=0) / np.abs(parts).sum(axis=0)).min())


def test_pairs_against_a_search():
    rng = np.random.default_rng(0)
    outcomes = set()
    for _ in range(100):
        matrix = np.diag(rng.uniform(0.1, 10.0, 6) ** 2)
        size = np.sqrt(matrix[1, 1] * matrix[5, 5])
        matrix[1, 5], matrix[5, 1] = 2.0 * size * rng.normal(size=2) * rng.choice([1.0, 1.0, 0.0], 2)
        least = least_power_of_a_pair(matrix)
        if abs(least) > 1e-3:  # nearer to the border the grid of the search cannot tell
            assert refuses(require_pairwise_dissipative, matrix) == (least < 0.0)
            outcomes.add(least < 0.0)
    assert outcomes == {True, False}


def test_a_single_entry_has_its_bound_in_closed_form():
    """D_ii t^3 - |D_ij| t + D_jj >= 0 for all t > 0 exactly if 27 D_ii D_jj^2 >= 4 |D_ij|^3."""
    for units in (1e-6, 1.0, 1e6):
        matrix = np.diag([3.0, 5.0, 1.0, 1.0, 1.0, 1.0])
        border = (27.0 * matrix[0, 0] * matrix[1, 1] ** 2 / 4.0) ** (1.0 / 3.0)
        for sign in (1.0, -1.0):
            matrix[0, 1] = sign * border * (1.0 - 1e-6)
            assert not refuses(require_pairwise_dissipative, units * matrix)
            matrix[0, 1] = sign * border * (1.0 + 1e-6)
            assert refuses(require_pairwise_dissipative, units * matrix)


@pytest.mark.parametrize("seed", range(8))
def test_linear_against_its_quadratic_form(seed):
    """A matrix with a known worst direction, and any antisymmetric part on top."""
    rng = np.random.default_rng(seed)
    Q = np.linalg.qr(rng.normal(size=(6, 6)))[0]
    values = rng.uniform(0.0, 5.0, 6)
    values[0] = 0.0
    turning = rng.normal(size=(6, 6)) * 10.0
    matrix = Q @ np.diag(values) @ Q.T + turning - turning.T
    assert not refuses(require_dissipative, matrix)
    leaking = matrix - 1e-3 * np.outer(Q[:, 0], Q[:, 0])
    assert Q[:, 0] @ leaking @ Q[:, 0] < 0.0
    assert refuses(require_dissipative, leaking)


def test_without_damping_nothing_is_refused():
    for check in (require_dissipative, require_pairwise_dissipative):
        assert not refuses(check, np.zeros((6, 6)))
        assert refuses(check, np.diag([0.0, 0.0, 0.0, -1e-9, 0.0, 0.0]))
