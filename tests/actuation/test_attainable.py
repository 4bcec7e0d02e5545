"""Attainable wrenches: the share of a wrench that can be held, against linear programmes over the thruster forces."""

import numpy as np
import pytest
from scipy.optimize import linprog

from cube_sim.actuation.attainable.attainable_set import attainable_set, holding_forces
from cube_sim.actuation.directions.subspaces import subspaces
from cube_sim.wrench.allowed_forces import AllowedForces


def share_by_programme(A, low, high, wrench):
    m = A.shape[1]
    rows = np.column_stack([A, -wrench])
    bounds = [*zip(low, high, strict=True), (0, 1e6)]
    return linprog(np.r_[np.zeros(m), -1.0], A_eq=rows, b_eq=np.zeros(len(A)), bounds=bounds).x[-1]


LIMITS = {
    "both ways": lambda m: np.column_stack([np.full(m, -40.0), np.full(m, 51.0)]),
    "forwards only": lambda m: np.column_stack([np.zeros(m), np.full(m, 51.0)]),
    "one blocked": lambda m: np.column_stack([np.r_[0.0, np.full(m - 1, -40.0)], np.r_[0.0, np.full(m - 1, 51.0)]]),
}


@pytest.mark.flight
@pytest.mark.parametrize("limits", LIMITS.values(), ids=LIMITS)
@pytest.mark.parametrize(("n", "m", "rank"), [(3, 4, 3), (3, 2, 2), (3, 5, 1), (6, 8, 6), (6, 8, 4), (6, 5, 5)])
def test_share_is_that_of_a_linear_programme(n, m, rank, limits):
    rng = np.random.default_rng((n, m, rank))
    A = rng.normal(size=(n, rank)) @ rng.normal(size=(rank, m))
    table = limits(m)
    allowed = AllowedForces.from_limits(table, m, dead_zones=False)
    wrenches = rng.normal(size=(20, m)) @ A.T * 30.0
    shares = attainable_set(subspaces(A), allowed).share(wrenches)
    wanted = [share_by_programme(A, *table.T, wrench) for wrench in wrenches]
    assert np.allclose(shares, wanted, rtol=1e-6, atol=1e-7)
    for wrench, share in zip(wrenches, shares, strict=True):
        if share >= 1.0:
            forces = holding_forces(A, allowed, wrench)
            assert np.allclose(A @ forces, wrench, atol=1e-6)
            assert np.all(forces >= allowed.minimum - 1e-9)
            assert np.all(forces <= allowed.maximum + 1e-9)


def test_no_wrench_is_held_by_anything():
    allowed = AllowedForces.from_limits([0, 0], 2, dead_zones=False)
    nothing = attainable_set(subspaces(np.zeros((3, 2))), allowed)
    assert nothing.share(np.zeros((1, 3))).tolist() == [np.inf]
