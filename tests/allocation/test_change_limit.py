"""Under a change limit: no limit locks thrusters together, and what is made without one is made soon."""

from __future__ import annotations

import numpy as np
import pytest
from support.layouts import bluerov2_heavy, cube, jack

from cube_sim.allocation import Allocator, Status
from cube_sim.allocation.previous import PreviousForces

LAYOUTS = {
    "bluerov2": (bluerov2_heavy(), np.array([-40.0, -7.4, 9.6, 51.0])),
    "cube": (cube(), np.array([-40.0, -7.4, 9.6, 51.0])),
    "as built": (cube(direction_noise=0.05, position_noise_m=0.01, seed=1), np.array([-40.0, -4.0, 4.0, 40.0])),
    "jack": (jack(), np.array([-40.0, -6.0, 6.0, 40.0])),
}
SIZES = {"within": 0.1, "beyond": 1.0}
"""Sizes of demands in those the thrusters make along one axis: mostly attainable, and mostly not."""


def distance(allocator, answer):
    """What the closest wrench is the closest in."""
    return float(np.linalg.norm(allocator.wrench_weights * answer.wrench_error))


def started(allocator, answer):
    """Make forces the previous ones."""
    allocator.reset()
    side = answer.subset.astype(float)
    allocator.resume(PreviousForces(answer.force.copy(), side, side))
    return allocator


def calls_between(limits, one, other, step):
    """How many calls the thruster farthest from its force takes, dead zone not counted."""
    edges = np.column_stack([limits[:, 1], np.zeros(len(limits)), limits[:, 2]])
    at = np.arange(len(limits))
    travel = [answer.force - edges[at, answer.subset.astype(int) + 1] for answer in (one, other)]
    return int(np.ceil(np.abs(travel[1] - travel[0]).max() / step - 1e-9))


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("allow_off", [False, True])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_no_change_limit_locks_the_thrusters(layout, allow_off, size):
    """From any forces to the wrench that is made without a limit, in the time that its own forces take at most."""
    A, row = LAYOUTS[layout]
    limits, rng = np.tile(row, (A.shape[1], 1)), np.random.default_rng(3)
    free = Allocator(A, limits, allow_off=allow_off, method="search")
    slow = Allocator(A, limits, allow_off=allow_off, method="search", change_limit=4.0)
    unit = np.abs(A) @ np.abs(limits).max(axis=1)
    for _ in range(12):
        free.reset()
        start = free.allocate(0.2 * unit * rng.normal(size=len(A)))
        demand = SIZES[size] * unit * rng.normal(size=len(A))
        wanted = free.allocate(demand)
        started(slow, start)
        answer = start
        for _ in range(calls_between(limits, start, wanted, 4.0)):
            before, answer = answer, slow.allocate(demand)
            assert calls_between(limits, before, answer, 4.0) <= 1
        assert distance(slow, answer) <= distance(free, wanted) + 1e-6


STRICT = {"allow_off": False, "method": "search"}


def test_the_way_out_of_a_corner_leads_away_first():
    """Two thrusters on one axis hold each other at 9 N. For -4 N one has to turn, and then both push the same way."""
    A, limits = np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0]]), np.array([[-30.0, -9.0, 9.0, 30.0], [-9, -1, 1, 9.0]])
    allocator, side = Allocator(A, limits, **STRICT, change_limit=3.0), np.array([1.0, -1.0])
    allocator.resume(PreviousForces(np.array([9.0, -9.0]), side, side))
    answers = [allocator.allocate([-4.0, 0.0, 0.0]) for _ in range(4)]
    # The second walks from -9 N over -1 N and 1 N to 5 N, 12 N in all; the first turns to -9 N on the way.
    assert [answer.wrench[0] for answer in answers] == pytest.approx([3.0, -12.0, -7.0, -4.0])
    assert [answer.status for answer in answers] == [Status.CLOSEST] * 3 + [Status.EXACT]


def test_shares_and_priorities_are_not_locked_either():
    A, row = LAYOUTS["bluerov2"]
    limits, rng = np.tile(row, (8, 1)), np.random.default_rng(5)
    unit = np.abs(A) @ np.abs(limits).max(axis=1)
    slow = Allocator(A, limits, **STRICT, change_limit=4.0, unattainable="scaled")
    free = Allocator(A, limits, **STRICT, unattainable="scaled")
    for size in (0.1, 0.5):
        for _ in range(6):
            free.reset()
            start = free.allocate(0.1 * unit * rng.normal(size=6))
            primary, secondary = size * unit * rng.normal(size=(2, 6))
            wanted = free.allocate(secondary), free.allocate_by_priority(primary, secondary)
            started(slow, start)
            answers = [slow.allocate(secondary) for _ in range(25)]
            np.testing.assert_allclose(answers[-1].wrench, wanted[0].wrench, atol=1e-5)
            started(slow, start)
            answers = [slow.allocate_by_priority(primary, secondary) for _ in range(25)]
            np.testing.assert_allclose(answers[-1].wrench, wanted[1].wrench, atol=1e-5)


def test_a_batch_and_every_subset_answer_as_one_call_after_the_other_does():
    A, row = LAYOUTS["jack"]
    rng = np.random.default_rng(9)
    unit = np.abs(A) @ np.full(4, 40.0)
    options = {"allow_off": False, "change_limit": 4.0}
    one = Allocator(A, row, method="search", **options)
    many = Allocator(A, row, method="search+proxqp", **options)
    each = Allocator(A, row, method="enumerate", **options)
    demands = np.repeat(0.15 * unit * rng.normal(size=(4, 3)), 6, axis=0)
    answers = [one.allocate(demand) for demand in demands]
    batch = many.allocate_many(demands)
    np.testing.assert_array_equal(batch.force, [answer.force for answer in answers])
    np.testing.assert_array_equal(batch.subset, [answer.subset for answer in answers])
    np.testing.assert_array_equal(batch.status, [answer.status for answer in answers])
    for demand, answer in zip(demands, answers, strict=True):
        np.testing.assert_allclose(each.allocate(demand).force, answer.force, atol=1e-4)
