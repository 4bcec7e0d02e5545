"""A matrix published to seven digits is answered as the one that was meant: what is as good goes to the cheaper."""

from __future__ import annotations

import numpy as np
import pytest

from cube_sim.allocation import Allocator, Status
from cube_sim.allocation.exact.stages import WORTHWHILE

LIMITS = np.array([-40.0, -4.0, 4.0, 40.0])
AS_GOOD = 1e-3
"""Weighted distance [N] that rounding A's entries to 1e-7 hides: 40 N of seven thrusters, 30 N for 1 N m."""


def work_rov() -> np.ndarray:
    """(6, 8) of a heavy ROV: four steep thrusters at the corners, leaning inwards, and four level at 45 degrees."""
    c, lean, side = np.sqrt(0.5), np.radians(74.53), np.radians(53.2)
    steep = [(np.array([0.89 * s, 0.334 * p, 0.529]), s, p) for s in (-1.0, 1.0) for p in (1.0, -1.0)]
    level = [(np.array([0.412 * s, 0.505 * p, -0.129]), s, p) for s in (-1.0, 1.0) for p in (1.0, -1.0)]
    columns = []
    for r, s, p in steep:
        u = np.array([-s * np.cos(lean) * np.cos(side), -p * np.cos(lean) * np.sin(side), np.sin(lean)])
        columns.append(np.concatenate([u, np.cross(r, u)]))
    for r, s, p in level:
        u = np.array([c * -s, c * p, 0.0])
        columns.append(np.concatenate([u, np.cross(r, u)]))
    return np.array(columns).T


def meant_and_published(rng) -> tuple[np.ndarray, np.ndarray]:
    """(6, 7) of the vehicle that lost a thruster, and what angles of six digits make of it: mirrored thrusters differ
    in the seventh.
    """
    meant = np.delete(work_rov(), 0, axis=1)
    return meant, np.round(meant + rng.uniform(-1e-7, 1e-7, meant.shape), 7)


def beyond_reach(A, rng):
    demand = np.abs(A) @ np.full(A.shape[1], 40.0) * rng.normal(size=6) * rng.choice([0.3, 1.0])
    if rng.random() < 0.3:
        demand[rng.permutation(6)[:3]] = 0.0
    return demand


def distance(allocator, answer) -> float:
    return float(np.linalg.norm(allocator.wrench_weights * answer.wrench_error))


@pytest.mark.parametrize("unattainable", ["closest", "scaled"])
@pytest.mark.parametrize("allow_off", [False, True])
def test_what_is_as_close_but_for_rounding_goes_to_the_cheaper(allow_off, unattainable):
    rng, seen = np.random.default_rng(4), 0
    meant, published = meant_and_published(rng)
    options = {"allow_off": allow_off, "unattainable": unattainable, "method": "search"}
    exact, rounded = Allocator(meant, LIMITS, **options), Allocator(published, LIMITS, **options)
    for _ in range(200):
        demand = beyond_reach(meant, rng)
        exact.reset()
        rounded.reset()
        wanted, answer = exact.allocate(demand), rounded.allocate(demand)
        if Status.EXACT in (wanted.status, answer.status):
            continue
        as_good = abs(distance(exact, answer) - distance(exact, wanted)) <= AS_GOOD
        # With dead zones a rounding decides whether a share is attainable at all.
        assert as_good or unattainable == "scaled"
        seen += as_good
        assert answer.cost <= wanted.cost / (1.0 - 2.0 * WORTHWHILE) or not as_good
        assert np.all(np.abs(published @ answer.force - answer.wrench) < 1e-9)
    assert seen > 60


@pytest.mark.flight
def test_enumeration_answers_a_rounded_matrix_as_the_search_does():
    rng, unattainable = np.random.default_rng(4), 0
    _, published = meant_and_published(rng)
    search = Allocator(published, LIMITS, allow_off=False, method="search")
    report = Allocator(published, LIMITS, allow_off=False, method="enumerate")
    for _ in range(16):
        demand = beyond_reach(published, rng)
        fast, slow = search.allocate(demand), report.allocate(demand)
        assert fast.status == slow.status
        assert fast.cost == pytest.approx(slow.cost, rel=1.1 * WORTHWHILE)
        assert distance(search, fast) == pytest.approx(distance(search, slow), abs=AS_GOOD)
        unattainable += fast.status == Status.CLOSEST
    assert unattainable > 8


@pytest.mark.parametrize("method", ["search", "enumerate"])
@pytest.mark.parametrize(("off_the_middle", "made"), [(0.0, -2.0), (1e-7, -2.0), (3e-6, -2.0), (1e-4, 2.0)])
def test_of_wrenches_on_both_sides_the_cheaper_is_made_unless_the_other_is_closer(off_the_middle, made, method):
    """A thruster that may not rest and pushed backward last, asked for nearly nothing: forward costs a reversal."""
    allocator = Allocator(np.eye(3), [-10, -2, 2, 10], allow_off=False, reversal_penalty=100.0, method=method)
    allocator.allocate([-5.0, 4.0, 3.0])
    answer = allocator.allocate([off_the_middle, 4.0, 3.0])
    assert answer.status == Status.CLOSEST
    np.testing.assert_allclose(answer.force, [made, 4.0, 3.0], atol=1e-6)
    assert answer.cost == pytest.approx(29.0 + 100.0 * (made > 0.0))
