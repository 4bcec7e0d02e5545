"""Nonsense, extremes and degenerate vehicles: never a NaN, never a force outside its set, never without end."""

import numpy as np
import pytest
from support.allocation_reference import in_allowed_set

from cube_sim.allocation import Allocator, Status, make_allocator
from cube_sim.allocation.methods import is_exact, methods
from cube_sim.errors import AllocationError

ANY_WRENCH = [0.0, -0.0, 1e-308, 1e-9, 1.0, -37.0, 1e4, 1e18, 1e155, -1e308, np.inf, -np.inf, np.nan]


def any_vehicle(rng):
    """A and limits: any number of thrusters, rank and scale, zero and repeated columns, limits that touch or vanish."""
    n, m = int(rng.choice([3, 6])), int(rng.integers(1, 13))
    rank = int(rng.integers(1, min(n, m) + 1))
    A = rng.normal(size=(n, rank)) @ rng.normal(size=(rank, m)) * 10.0 ** rng.integers(-3, 3)
    if rng.random() < 0.3:
        A[:, rng.integers(m)] = 0.0
    if rng.random() < 0.3:
        A[:, rng.integers(m)] = rng.choice([1.0, -1.0]) * A[:, rng.integers(m)]
    if not A.any():
        A[0, 0] = 1.0
    limits = np.sort(rng.uniform(0, 50, size=(m, 2)), axis=1)
    other = -np.sort(-np.sort(rng.uniform(-50, 0, size=(m, 2)), axis=1), axis=1)[:, ::-1]
    table = np.column_stack([other, limits])
    for i in range(m):
        kind = rng.integers(7)
        if kind == 0:
            table[i, 1:3] = 0.0
        elif kind == 1:
            table[i, 0] = table[i, 1]
        elif kind == 2:
            table[i, :2] = 0.0
        elif kind == 3:
            table[i] = 0.0
        elif kind == 4:
            table[i] = [-1e-9, -1e-10, 1e-10, 1e-9]
    return A, table


@pytest.mark.parametrize("seed", range(60))
def test_every_answer_is_allowed_finite_and_bounded(seed):
    rng = np.random.default_rng(seed)
    A, limits = any_vehicle(rng)
    n, m = A.shape
    off = bool(rng.integers(2))
    objective = str(rng.choice(["energy", "target", "reactivity", "reactivity_by_side"]))
    options = {"allow_off": off, "objective": objective, "weights": 10.0 ** rng.uniform(-2, 2, m)}
    options["reversal_penalty"] = float(rng.choice([0.0, 100.0]))
    options["switching_penalty"] = float(rng.choice([0.0, 30.0]))
    options["change_limit"] = None if rng.random() < 0.7 else float(rng.uniform(0.1, 20))
    options["unattainable"] = "scaled" if seed % 3 == 0 else "closest"
    if objective == "target":
        options["target"] = rng.normal(size=m) * 30
    elif objective != "energy":
        options["reactivity"] = [-20.0, 30.0]
    thrusters_are_few = m <= 8 or objective != "reactivity_by_side"
    allocator = Allocator(A, limits, method="search+proxqp" if thrusters_are_few else "search", **options)
    for _ in range(12):
        wrench = rng.normal(size=n) * 10.0 ** rng.integers(-6, 4)
        if rng.random() < 0.4:
            wrench[rng.integers(n)] = rng.choice(ANY_WRENCH)
        before = allocator.effort.nodes
        answer = allocator.allocate(wrench)
        assert in_allowed_set(answer.force, limits, off).all()
        assert np.isfinite(answer.force).all()
        assert np.isfinite(answer.wrench_error).all()
        assert np.isfinite([answer.residual, answer.cost]).all()
        gave_up = (Status.UNPROVEN, Status.UNPROVEN_CLOSEST)
        assert answer.status in (Status.EXACT, Status.CLOSEST, Status.SCALED, Status.INVALID_WRENCH, *gave_up)
        assert (answer.status == Status.INVALID_WRENCH) == (not np.isfinite(wrench).all())
        assert np.allclose(answer.wrench, A @ answer.force)
        if answer.status in (Status.EXACT, Status.UNPROVEN):
            assert answer.residual <= 1e-5 * (1.0 + np.abs(A).max())
        sides = np.sign(answer.force)
        assert np.all((sides == answer.subset) | (answer.force == 0.0) | (limits[:, 1] == 0.0) | (limits[:, 2] == 0.0))
        assert allocator.effort.nodes - before < 2 * 10**6


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("method", [m for m in methods() if not is_exact(m)])
def test_simple_methods_too(method, seed):
    rng = np.random.default_rng(1000 + seed)
    A, limits = any_vehicle(rng)
    off = bool(rng.integers(2))
    allocator = make_allocator(method, A, limits, {"allow_off": off})
    for _ in range(10):
        wrench = rng.normal(size=len(A)) * 10.0 ** rng.integers(-6, 4)
        if rng.random() < 0.4:
            wrench[rng.integers(len(A))] = rng.choice(ANY_WRENCH)
        answer = allocator.allocate(wrench)
        assert np.isfinite(answer.force).all()
        assert np.isfinite(answer.wrench_error).all()
        assert np.isfinite([answer.residual, answer.cost]).all()
        if answer.status == Status.FORBIDDEN_FORCE:
            assert not in_allowed_set(answer.force, limits, off).all()
        else:
            assert in_allowed_set(answer.force, limits, True, 1e-4).all()


@pytest.mark.parametrize("seed", range(40))
def test_broken_tables_are_refused(seed):
    rng = np.random.default_rng(2000 + seed)
    A, limits = any_vehicle(rng)
    thruster = int(rng.integers(len(limits)))
    broken = [limits.copy() for _ in range(4)]
    broken[0][thruster] = [-1.0, -2.0, 3.0, 4.0]
    broken[1][thruster] = [-4.0, -2.0, 3.0, 2.0]
    broken[2][thruster] = [-4.0, 1.0, 1.5, 2.0]
    broken[3][thruster, rng.integers(4)] = rng.choice([np.nan, np.inf])
    for table in broken:
        with pytest.raises(AllocationError, match=f"thruster {thruster + 1}: limits"):
            Allocator(A, table)
    A[rng.integers(len(A)), thruster] = rng.choice([np.nan, -np.inf])
    with pytest.raises(AllocationError, match=r"(nan|-inf) in row \d, column"):
        Allocator(A, limits)
