"""The optimum against two independent solvers: a seeded part always, the whole with ``pytest -m campaign``."""

import numpy as np
import pytest
from allocation_proof import BUILT, campaign
from allocation_reference import cube, jack

from cube_sim.allocation import Allocator, Status
from cube_sim.allocation.attainable import attainable_map, half_spaces
from cube_sim.errors import AllocationError

LIMITS = np.array([-40.0, -6.0, 7.0, 50.0])


def test_a_part_of_the_proof():
    tallies = dict(campaign(20, solver_share=0.15, method="search+proxqp"))
    assert sum(tally.wrenches for tally in tallies.values()) > 1900
    assert sum(tally.solved for tally in tallies.values()) > 200
    assert [line for tally in tallies.values() for line in tally.disagreements] == []
    assert sum(tally.unconfirmed for tally in tallies.values()) == 0
    assert 0.3 < sum(t.exact for t in tallies.values()) / sum(t.wrenches for t in tallies.values()) < 0.9


@pytest.mark.campaign
def test_the_whole_proof(capsys):
    """More than 100,000 wrenches; prints a line for each combination."""
    total = exact = solved = pinned = distances = borderline = unconfirmed = 0
    disagreements, largest_gap_N = [], 0.0
    for label, tally in campaign(1100, solver_share=0.5):
        with capsys.disabled():
            print(f"{label:<62} {tally.wrenches:>6} wrenches, {tally.exact:>5} exact, {len(tally.disagreements)} wrong")
            for line in tally.disagreements[:5]:
                print("   ", line)
        total, exact, solved = total + tally.wrenches, exact + tally.exact, solved + tally.solved
        pinned, distances = pinned + tally.pinned, distances + tally.distances
        borderline, unconfirmed = borderline + tally.borderline, unconfirmed + tally.unconfirmed
        largest_gap_N = max(largest_gap_N, tally.largest_gap_N)
        disagreements += tally.disagreements
    with capsys.disabled():
        print(
            f"{total} wrenches, {exact} exact; {pinned} against pinning, {solved} against NNLS, {distances} distances"
        )
        print(f"{borderline} comparisons settled by the border rule")
        print(f"{unconfirmed} not confirmed by ProxQP, which differs by {largest_gap_N:.1e} N at most")
    assert total >= 100_000
    assert unconfirmed <= 1e-3 * total  # cells thinner than ProxQP's accuracy
    assert disagreements == []


@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
@pytest.mark.parametrize("A", [jack(), cube(), BUILT[:, :5], np.diag([1.0, 1, 1, 1, 1, 0])[:, :5]], ids="abcd")
def test_half_spaces_say_attainable_exactly_when_the_search_does(A, allow_off):
    n, m = A.shape
    allocator = Allocator(A, LIMITS, allow_off=allow_off, method="search")
    rng = np.random.default_rng(1)
    forces = rng.uniform(-45, 55, size=(400, m))
    wrenches = np.vstack([forces @ A.T, rng.normal(size=(50, n)) * 20])
    spaces = half_spaces(A, LIMITS, allow_off=allow_off)
    values = wrenches @ spaces.normals.T
    inside = [np.any(np.all((v >= spaces.low - 1e-7) & (v <= spaces.high + 1e-7), axis=1)) for v in values]
    found = allocator.allocate_many(wrenches).status == Status.EXACT
    assert np.array_equal(found, inside)
    assert found.any()
    assert not found.all()


def test_map_of_attainable_wrenches_is_the_search_pixel_by_pixel():
    centre, across, down = np.zeros(6), np.array([150.0, 0, 0, 0, 0, 2]), np.array([0, 0, 3.0, 0, 25, 0])
    for allow_off in (True, False):
        found = attainable_map(BUILT, LIMITS, centre, across, down, (31, 41), allow_off=allow_off)
        u, v = np.meshgrid(np.linspace(-1, 1, 41), np.linspace(-1, 1, 31))
        wrenches = u.ravel()[:, None] * across + v.ravel()[:, None] * down
        status = Allocator(BUILT, LIMITS, allow_off=allow_off).allocate_many(wrenches).status
        assert np.array_equal(found.ravel(), status == Status.EXACT)
        assert 0.02 < found.mean() < 0.98


def test_map_refuses_nonsense():
    with pytest.raises(AllocationError, match="across must be 6 finite numbers"):
        attainable_map(BUILT, LIMITS, np.zeros(6), np.zeros(3), np.zeros(6))
    with pytest.raises(AllocationError, match="needs a row"):
        attainable_map(BUILT, LIMITS, np.zeros(6), np.ones(6), np.ones(6), (0, 4))
