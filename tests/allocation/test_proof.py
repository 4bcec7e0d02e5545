"""The optimum against independent solvers: a seeded part always, the whole with ``pytest -m campaign``."""

import numpy as np
import pytest
from support.allocation_proof import BUILT, Tally, campaign, compare_closest
from support.allocation_reference import least_cost, least_distance
from support.closest_reference import LESS, MORE, USUAL, ClosestOfEverySubset
from support.every_subset import EverySubset
from support.layouts import cube, jack

from cube_sim.allocation import Allocator, Status
from cube_sim.allocation.attainable_map import attainable_map, half_spaces
from cube_sim.errors import AllocationError

LIMITS = np.array([-40.0, -6.0, 7.0, 50.0])


@pytest.mark.flight
def test_a_part_of_the_proof():
    tallies = dict(campaign(20, solver_share=0.15, method="search+proxqp"))
    assert sum(tally.wrenches for tally in tallies.values()) > 1900
    assert sum(tally.solved for tally in tallies.values()) > 200
    assert sum(tally.closest for tally in tallies.values()) > 1000
    assert sum(tally.several for tally in tallies.values()) > 50
    assert sum(tally.as_close for tally in tallies.values()) > 5
    assert sum(tally.missed for tally in tallies.values()) == 0
    assert [line for tally in tallies.values() for line in tally.disagreements] == []
    assert sum(tally.unconfirmed for tally in tallies.values()) == 0
    assert 0.3 < sum(t.exact for t in tallies.values()) / sum(t.wrenches for t in tallies.values()) < 0.9


@pytest.mark.campaign
def test_the_whole_proof(capsys):
    """More than 100,000 wrenches; prints a line for each combination."""
    tallies = {}
    for label, tally in campaign(1100, solver_share=0.5):
        tallies[label] = tally
        with capsys.disabled():
            print(f"{label:<80} {tally.wrenches:>6} wrenches, {tally.exact:>5} exact, {len(tally.disagreements)} wrong")
            for line in tally.disagreements[:5]:
                print("   ", line)

    def total(name, part=""):
        return sum(getattr(tally, name) for label, tally in tallies.items() if part in label)

    with capsys.disabled():
        print(
            f"{total('wrenches')} wrenches, {total('exact')} exact; {total('pinned')} against pinning, "
            f"{total('solved')} against NNLS; {total('borderline')} comparisons settled by the border rule"
        )
        for part in ("strict", "off"):
            print(
                f"closest, {part}: {total('closest', part)} distances, wrenches and least costs against bounded least "
                f"squares on every subset; {total('several', part)} have several forces as close; "
                f"{total('borderline_closest', part)} costs settled by the border rule"
            )
        print(
            f"{total('as_close')} are farther by what the rounding of A hides, for a lower cost; "
            f"{total('missed')} could be and are not"
        )
        largest_gap_N = max(tally.largest_gap_N for tally in tallies.values())
        print(f"{total('unconfirmed')} not confirmed by ProxQP, which differs by {largest_gap_N:.1e} N at most")
    assert total("wrenches") >= 100_000
    assert total("closest") == total("wrenches") - total("exact")
    assert total("borderline") + total("borderline_closest") <= 1e-3 * total("wrenches")
    assert total("missed") <= 1e-4 * total("closest") < total("as_close")
    assert total("unconfirmed") <= 1e-3 * total("wrenches")  # cells thinner than ProxQP's accuracy
    assert [line for tally in tallies.values() for line in tally.disagreements] == []


@pytest.mark.flight
@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
@pytest.mark.parametrize("A", [jack(), BUILT[:, :5], cube()[:, [0, 2, 4, 5]], jack()[:, [0, 0, 1]]], ids="abcd")
def test_reference_for_the_closest_wrench_is_scipy_without_leaving_out_a_subset(A, allow_off):
    """And its least cost that of every way of pinning thrusters to interval ends."""
    rng = np.random.default_rng(2)
    m, W = A.shape[1], np.repeat([1.0, 30.0], [len(A) - len(A) // 2, len(A) // 2])
    limits, target, weights = np.tile(LIMITS, (m, 1)), rng.uniform(-30, 40, m), rng.uniform(0.3, 3.0, m)
    reference = ClosestOfEverySubset(EverySubset(A, limits, allow_off, weights), W)
    compared = ways = 0
    for wrench in [*rng.normal(size=(8, len(A))) * (300 / W), *4 * np.eye(len(A)), np.zeros(len(A))]:
        found = reference.find(wrench)
        outside = W * wrench - (reference.inside / W).T @ (reference.inside @ wrench)
        least = least_distance(A, limits, allow_off, wrench, W)
        assert np.hypot(found.distance.min(), np.linalg.norm(outside)) == pytest.approx(least, rel=1e-9, abs=1e-7)
        if found.distance.min() < 1e-6:
            continue
        equal = found.distance <= found.distance.min() + 1e-9
        made = found.force[equal] @ A.T
        pinned = min(least_cost(A, limits, allow_off, w, target=target, weights=weights)[0] for w in made)
        side_target = np.tile(target[:, None], 3)
        for rounding in (LESS, USUAL, MORE):
            cost, several = reference.cheapest(found, side_target, np.zeros((m, 3)), rounding)
            assert cost == pytest.approx(pinned, rel=1e-5)
        compared, ways = compared + 1, ways + several
    assert compared > 4
    assert ways > 0 or np.unique(A, axis=1).shape[1] == m


@pytest.mark.parametrize("fault", ["farther", "costlier"])
def test_the_proof_sees_a_closest_wrench_that_is_none_and_a_cost_that_is_not_the_least(fault):
    A, limits = np.delete(cube(), 4, axis=1), np.tile(LIMITS, (7, 1))
    allocator, tally = Allocator(A, limits, method="search"), Tally()
    reference = ClosestOfEverySubset(EverySubset(A, limits, True, np.ones(7)), allocator.wrench_weights)
    for seen, wrench in enumerate(np.random.default_rng(3).normal(size=(8, 6)) * [90, 90, 90, 20, 20, 20]):
        answer = allocator.allocate(wrench)
        arguments = reference, wrench, answer, np.zeros((1, 7, 3)), np.zeros((7, 3)), tally, "here"
        compare_closest(*arguments)
        assert len(tally.disagreements) == seen
        move = np.linalg.svd(reference.M)[2][0 if fault == "farther" else -1]
        force = answer.force + 3.0 * move * (1 if move @ answer.force > 0 else -1)
        worse = answer._replace(force=force, cost=float(force @ force))
        compare_closest(*arguments[:2], worse, *arguments[3:])
        tally.disagreements = tally.disagreements[: seen + 1]
        assert len(tally.disagreements) == seen + 1


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
