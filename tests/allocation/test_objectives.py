"""Objectives beyond energy, limits on change, power, batches, and the report's enumeration in parallel."""

import numpy as np
import pytest
from support.allocation_reference import cells, in_allowed_set, least_cost
from support.layouts import cube, jack

from cube_sim.allocation import Allocator, Status
from cube_sim.allocation.exact.packing import pack, unpack, unpack_closest_wrench_data
from cube_sim.allocation.exact.solve import answer_size, solve_each
from cube_sim.allocation.exact.step import no_previous_answer
from cube_sim.errors import AllocationError

LIMITS = np.array([-40.0, -3.2, 4.0, 50.0])
REACTIVITY = np.array([-32.0, 44.0])
BUILT = cube(direction_noise=0.05, position_noise_m=0.01, seed=4)


@pytest.mark.flight
@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
def test_the_reports_reactivity_is_the_better_of_all_forward_and_all_backward(allow_off):
    points = [-30.0, 32.0]
    allocator = Allocator(BUILT, LIMITS, allow_off=allow_off, objective="reactivity", reactivity=points)
    winners = set()
    for wrench in np.random.default_rng(1).normal(size=(25, 6)) * [15, 15, 15, 4, 4, 4]:
        answer = allocator.allocate(wrench)
        costs = [
            least_cost(BUILT, allocator.limits, allow_off, wrench, target=np.full(8, point))[0] for point in points
        ]
        assert answer.cost == pytest.approx(min(costs), rel=1e-7)
        winners.add(int(np.argmin(costs)))
    assert winners == {0, 1}


@pytest.mark.flight
@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
def test_reactivity_by_side_is_the_best_of_every_subset_with_its_own_target(allow_off):
    A = jack()
    allocator = Allocator(A, LIMITS, allow_off=allow_off, objective="reactivity_by_side", reactivity=REACTIVITY)
    by_side = {-1: REACTIVITY[0], 0: 0.0, 1: REACTIVITY[1]}
    for wrench in np.random.default_rng(2).normal(size=(8, 3)) * [20, 5, 4]:
        answer = allocator.allocate(wrench)
        best = np.inf
        for low, high in cells(allocator.limits, allow_off):
            target = np.array([by_side[int(np.sign(a + b))] for a, b in zip(low, high, strict=True)])
            cell = np.column_stack([low, high, low, high])
            solved = least_cost(A, cell, False, wrench, target=target)
            best = min(best, np.inf if solved is None else solved[0])
        assert answer.status == (Status.EXACT if np.isfinite(best) else Status.CLOSEST)
        if np.isfinite(best):
            assert answer.cost == pytest.approx(best, rel=1e-7, abs=1e-6)


def test_reactivity_by_side_on_the_cube_agrees_with_proxqp():
    allocator = Allocator(BUILT, LIMITS, objective="reactivity_by_side", reactivity=REACTIVITY)
    for wrench in np.random.default_rng(3).normal(size=(20, 6)) * [15, 15, 15, 4, 4, 4]:
        assert allocator.allocate(wrench).status == Status.EXACT
    assert (allocator.effort.qps, allocator.effort.disagreements, allocator.effort.unproven) == (20, 0, 0)


@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
@pytest.mark.parametrize("objective", ["energy", "target", "reactivity"])
def test_lines_and_branch_and_bound_are_the_same_optimum(objective, allow_off):
    """Two exact searches that share nothing but the choice of a side."""
    rng = np.random.default_rng(5)
    extra = {"energy": {}, "target": {"target": rng.uniform(-20, 20, 8)}, "reactivity": {"reactivity": REACTIVITY}}
    for A in (cube(), BUILT, np.delete(BUILT, 3, axis=1), jack()):
        arguments = dict(extra[objective])
        if "target" in arguments:
            arguments["target"] = arguments["target"][: A.shape[1]]
        allocator = Allocator(A, LIMITS, allow_off=allow_off, objective=objective, weights=1.5, **arguments)
        assert allocator._problem.planar
        other = pack(
            allocator._problem._replace(planar=False), allocator._closest, no_previous_answer(A.shape[1], np.inf)
        )
        n, m = A.shape
        reach = 0.2 * np.abs(A) @ np.full(m, 50.0)
        wrenches = np.vstack([np.zeros(n), rng.normal(size=(300, n)) * reach, np.diag(reach), -0.1 * np.diag(reach)])
        fast = allocator.allocate_many(wrenches)
        answers = np.zeros((len(wrenches), answer_size(n, m)))
        solve_each(other, wrenches.ravel(), answers.ravel(), np.empty(len(wrenches) * m, np.int8))
        assert np.array_equal(fast.status, answers[:, -2])
        assert np.allclose(fast.cost, answers[:, -3], rtol=1e-7, atol=1e-6)


def test_packed_tables_come_back_whole():
    for A in (BUILT, jack(), np.eye(6)[:, :3]):
        allocator = Allocator(A, LIMITS, objective="reactivity", reactivity=REACTIVITY, reversal_penalty=3.0)
        for tables, packed in (
            (allocator._problem, unpack(allocator._packed)),
            (allocator._closest, unpack_closest_wrench_data(allocator._packed)),
        ):
            for kept, field in zip(packed, tables, strict=True):
                if isinstance(field, tuple):
                    assert all(map(np.array_equal, kept, field))
                else:
                    assert np.array_equal(kept, field)


def test_a_batch_is_the_calls_one_by_one_to_the_last_bit():
    wrenches = np.random.default_rng(6).normal(size=(50, 6)) * [12, 12, 12, 3, 3, 3]
    wrenches[7, 2], wrenches[9] = np.nan, 1e4
    options = {"reversal_penalty": 50.0, "change_limit": 20.0}
    single, batch = Allocator(BUILT, LIMITS, **options), Allocator(BUILT, LIMITS, **options)
    one_by_one = [single.allocate(wrench) for wrench in wrenches]
    together = batch.allocate_many(wrenches)
    for field in ("force", "wrench", "wrench_error", "residual", "cost", "subset", "status"):
        assert np.array_equal(np.array([getattr(a, field) for a in one_by_one]), getattr(together, field)), field
    assert set(together.status.tolist()) == {0, 1, 2}
    with pytest.raises(AllocationError, match=r"give \(N, 6\)"):
        batch.allocate_many(np.zeros(6))


def travel(force, limits):
    """Force with the dead zone cut out: the coordinate changes are limited in."""
    return np.where(force > 0, force - limits[:, 2], np.where(force < 0, force - limits[:, 1], 0.0))


@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
def test_change_limit_bounds_every_step_and_never_locks_a_thruster(allow_off):
    """With a limit far below the dead zone a reversal is still made, in the time the way takes."""
    limits = np.tile([-40.0, -10.0, 10.0, 40.0], (4, 1))
    A, step = jack(), 0.5
    allocator = Allocator(A, limits, allow_off=allow_off, change_limit=step)
    at = np.zeros(4)
    answer = None
    for tick in range(200):
        answer = allocator.allocate(np.array([60.0, 0, 0]) * (1 if tick < 100 else -1))
        assert in_allowed_set(answer.force, limits, allow_off, 1e-9).all()
        now = travel(answer.force, limits)
        assert np.all(np.abs(now - at) <= step + 1e-9)
        at = now
        if tick == 99:
            assert answer.status == Status.EXACT
            assert answer.wrench[0] == pytest.approx(60.0)
    assert answer.status == Status.EXACT
    assert answer.wrench[0] == pytest.approx(-60.0)


def test_change_limit_gives_the_closest_wrench_in_reach():
    """One thruster: from rest it reaches the edge plus one step, whatever more is asked."""
    allocator = Allocator([[1.0], [0.0], [0.0]], [-30, -3, 4, 30], change_limit=2.0)
    assert [allocator.allocate([20, 0, 0]).force[0] for _ in range(3)] == pytest.approx([6.0, 8.0, 10.0])
    assert [allocator.allocate([-5, 0, 0]).force[0] for _ in range(5)] == pytest.approx([8, 6, -3, -5, -5], abs=1e-6)


def test_the_enumeration_in_parallel_is_the_serial_one():
    serial = Allocator(jack(), LIMITS, method="enumerate", reversal_penalty=40.0)
    parallel = Allocator(jack(), LIMITS, method="enumerate_parallel", reversal_penalty=40.0)
    search = Allocator(jack(), LIMITS, method="search", reversal_penalty=40.0)
    for wrench in np.random.default_rng(7).normal(size=(6, 3)) * [20, 5, 5]:
        one, other, fast = serial.allocate(wrench), parallel.allocate(wrench), search.allocate(wrench)
        assert one.status == other.status == fast.status
        assert np.allclose(one.force, other.force, atol=1e-5)
        assert one.cost == pytest.approx(fast.cost, rel=1e-6)
    assert parallel.effort.qps == serial.effort.qps >= 6 * 81


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"objective": "reactivity"}, "go together"),
        ({"reactivity": [-1, 1]}, "go together"),
        ({"objective": "reactivity", "reactivity": [1, -1]}, "F_react- <= 0"),
        ({"objective": "reactivity", "reactivity": [1, 2, 3]}, r"reactivity has shape \(3,\)"),
        ({"objective": "reactivity", "reactivity": [np.nan, 1]}, "finite"),
        ({"change_limit": 0.0}, "> 0"),
        ({"objective": "reactivity", "reactivity": "a lot"}, "not a table of numbers"),
    ],
)
def test_a_mistake_is_named(arguments, message):
    with pytest.raises(AllocationError, match=message):
        Allocator(jack(), LIMITS, **arguments)
