"""Thrusters lost, weak or stuck while the vehicle runs."""

import itertools

import numpy as np
import pytest
from support.allocation_reference import cells, in_allowed_set, least_cost, least_distance
from support.layouts import cube, jack

from cube_sim.allocation import Allocator, FaultTolerant, Health, Status, make_allocator
from cube_sim.allocation.methods import methods
from cube_sim.errors import AllocationError
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.matrix import lever_arm

LIMITS = np.array([-40.0, -3.2, 4.0, 50.0])
BUILT = cube(direction_noise=0.05, position_noise_m=0.01, seed=4)
WHOLE = Health.whole(8)


def tolerant(A=BUILT, limits=LIMITS, method="search+proxqp", **options):
    return FaultTolerant(A, limits, lambda A, limits, _: make_allocator(method, A, limits, options))


def lost(thrusters, count=8):
    return Health(np.where(np.isin(np.arange(count), thrusters), 0.0, 1.0), np.full(count, np.nan))


@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
@pytest.mark.parametrize("gone", [(0,), (2, 5), (1, 4, 6), (0, 1, 2, 3)])
def test_lost_thrusters_are_a_vehicle_without_their_columns(gone, allow_off):
    allocator = tolerant(allow_off=allow_off)
    allocator.set_health(lost(gone))
    left = np.delete(np.arange(8), gone)
    rest = np.tile(LIMITS, (len(left), 1))
    rng = np.random.default_rng(sum(gone))
    wrenches = [BUILT[:, left] @ rng.choice([*LIMITS, 20.0, -9.0], size=len(left)) for _ in range(6)]
    wrenches += [*rng.normal(size=(6, 6)) * [15, 15, 15, 3, 3, 3]]
    exact = 0
    for wrench in wrenches:
        answer = allocator.allocate(wrench)
        assert not answer.force[list(gone)].any()
        assert in_allowed_set(answer.force[left], rest, allow_off).all()
        np.testing.assert_allclose(answer.wrench, BUILT @ answer.force, atol=1e-9)
        reference = least_cost(BUILT[:, left], rest, allow_off, wrench, tolerance=1e-6)
        assert (answer.status == Status.EXACT) == (reference is not None)
        exact += reference is not None
        if reference is not None:
            assert answer.cost == pytest.approx(reference[0], rel=1e-5)
    assert exact >= 6


def test_unattainable_after_losses_is_the_closest_of_the_smaller_vehicle():
    left, weights = [0, 1, 3, 4, 7], np.array([1.0, 1, 1, 30, 30, 30])
    allocator = tolerant(allow_off=False, wrench_weights=weights)
    allocator.set_health(lost((2, 5, 6)))
    for wrench in np.random.default_rng(1).normal(size=(6, 6)) * [30, 30, 30, 6, 6, 6]:
        answer = allocator.allocate(wrench)
        assert answer.status == Status.CLOSEST
        distance = np.linalg.norm(weights * answer.wrench_error)
        reference = least_distance(BUILT[:, left], np.tile(LIMITS, (5, 1)), False, wrench, weights)
        assert distance == pytest.approx(reference, rel=1e-7, abs=1e-6)


@pytest.mark.parametrize("force", [12.0, -7.0, 1.5, 0.0])
def test_a_stuck_thruster_is_a_demand_less_its_wrench(force):
    allocator = tolerant()
    allocator.set_health(WHOLE.with_thruster(3, stuck=force))
    rest = np.delete(BUILT, 3, axis=1)
    for wrench in np.random.default_rng(2).normal(size=(8, 6)) * [15, 15, 15, 3, 3, 3]:
        answer = allocator.allocate(wrench)
        assert answer.force[3] == force
        assert answer.subset[3] == np.sign(force)
        np.testing.assert_allclose(answer.wrench + answer.wrench_error, wrench, atol=1e-9)
        np.testing.assert_allclose(answer.wrench, BUILT @ answer.force, atol=1e-9)
        reference = least_cost(rest, np.tile(LIMITS, (7, 1)), True, wrench - force * BUILT[:, 3])
        assert (answer.status == Status.EXACT) == (reference is not None)
        if reference is not None:
            assert answer.cost == pytest.approx(reference[0], rel=1e-7)


def test_a_weak_thruster_has_narrower_limits():
    efficiency = np.array([1, 0.5, 1, 1, 0.25, 1, 1, 1])
    weak = tolerant()
    weak.set_health(Health(efficiency, np.full(8, np.nan)))
    narrow = Allocator(BUILT, LIMITS * efficiency[:, None])
    for wrench in np.random.default_rng(3).normal(size=(20, 6)) * [40, 40, 40, 9, 9, 9]:
        force = weak.allocate(wrench).force
        assert np.allclose(force, narrow.allocate(wrench).force, atol=1e-6)
        np.testing.assert_allclose(weak.force_if_whole(force) * efficiency, force, rtol=1e-15)


@pytest.mark.parametrize("method", [name for name in methods() if name != "enumerate_parallel"])
def test_every_method_takes_dead_weak_and_stuck_thrusters_for_what_they_are(method):
    allocator = tolerant(method=method)
    allocator.set_health(WHOLE.with_thruster(0, 0.0).with_thruster(1, 0.5).with_thruster(2, 0.0, 6.0))
    wrench = BUILT @ [0.0, 6.0, 6.0, -8.0, 9.0, 4.0, -5.0, 7.0]
    answer = allocator.allocate(wrench)
    limits = np.tile(LIMITS, (6, 1))
    limits[0] *= 0.5
    alone = make_allocator(method, BUILT[:, [1, 3, 4, 5, 6, 7]], limits).allocate(wrench - 6.0 * BUILT[:, 2])
    np.testing.assert_allclose(answer.force, [0.0, alone.force[0], 6.0, *alone.force[1:]], atol=1e-6)
    np.testing.assert_allclose(answer.wrench, BUILT @ answer.force, atol=1e-9)
    assert answer.status == alone.status
    asked = allocator.force_if_whole(answer.force)
    assert (asked[0], asked[1], asked[2]) == (0.0, 2.0 * answer.force[1], 0.0)


def test_the_secondary_part_gives_way_beside_a_stuck_thruster():
    """Shares of the secondary part are counted on what the others have to make."""
    allocator = tolerant()
    allocator.set_health(WHOLE.with_thruster(3, stuck=12.0))
    primary, secondary = np.array([2.0, 1, 0, 0.5, 0, 0.3]), np.array([300.0, 40, -60, 0, 0, 0])
    answer = allocator.allocate(primary + secondary, secondary)
    share = (answer.wrench - primary) @ secondary / (secondary @ secondary)
    assert answer.status == Status.YIELDED
    assert 0.05 < share < 0.95
    np.testing.assert_allclose(answer.wrench, primary + share * secondary, atol=1e-6)
    more = allocator.allocate(primary + 1.01 * share * secondary)
    assert more.status == Status.CLOSEST


def test_all_thrusters_lost_is_answered():
    allocator = tolerant(allow_off=False)
    allocator.set_health(lost(range(8)))
    answer = allocator.allocate(np.array([1.0, 2, 3, 0, 0, 0.6]))
    assert answer.status == Status.CLOSEST
    assert not answer.force.any()
    assert answer.residual == pytest.approx(np.sqrt(14.0 + (0.6 / lever_arm(BUILT, SPATIAL)) ** 2))
    allocator.set_health(WHOLE.with_thruster(0, stuck=9.0)._replace(efficiency=np.zeros(8)))
    answer = allocator.allocate(10.0 * BUILT[:, 0])
    np.testing.assert_allclose(answer.wrench_error, BUILT[:, 0])
    allocator.reset()
    assert answer.force.tolist() == [9.0, 0, 0, 0, 0, 0, 0, 0]


def test_every_pair_can_be_lost_and_always_gives_an_allowed_answer():
    allocator = tolerant(cube(), allow_off=False, method="search")
    for pair in itertools.combinations(range(8), 2):
        allocator.set_health(lost(pair))
        for wrench in np.vstack([np.zeros(6), 20 * np.eye(6), -5 * np.eye(6)]):
            answer = allocator.allocate(wrench)
            assert in_allowed_set(np.delete(answer.force, pair), np.tile(LIMITS, (6, 1)), False).all()
            assert not answer.force[list(pair)].any()
            assert answer.status in (Status.EXACT, Status.CLOSEST)


HISTORY = {"reversal_penalty": 30.0, "switching_penalty": 20.0, "change_limit": 5.0}


@pytest.mark.parametrize(("limits", "allow_off"), [(LIMITS, True), (LIMITS, False), ([-40.0, 50.0], False)])
def test_an_event_that_changes_nothing_leaves_no_trace(limits, allow_off):
    """A rebuild in every call against an allocator that is never rebuilt, to the last bit."""
    rebuilt = tolerant(limits=limits, allow_off=allow_off, method="search", **HISTORY)
    steady = Allocator(BUILT, limits, allow_off=allow_off, method="search", **HISTORY)
    wrench = np.zeros(6)
    for step in np.random.default_rng(5).normal(size=(60, 6)) * [9, 9, 9, 2, 2, 2]:
        wrench = 0.9 * wrench + step
        rebuilt.set_health(WHOLE)
        answer, expected = rebuilt.allocate(wrench), steady.allocate(wrench)
        assert answer.force.tobytes() == expected.force.tobytes()
        assert (answer.cost, answer.status) == (expected.cost, expected.status)
        answer.force[:] = np.nan  # whose array it is now


def test_faults_do_not_add_up():
    allocator, wrench = tolerant(), np.array([20.0, 5, 0, 1, 0, 0])
    before = allocator.allocate(wrench).force
    for health in (WHOLE.with_thruster(0, stuck=9.0), WHOLE.with_thruster(1, 0.5), lost((2, 3)), WHOLE):
        allocator.set_health(health)
        after = allocator.allocate(wrench).force
    np.testing.assert_allclose(after, before, atol=1e-9)


ONE_AXIS = np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0]])


@pytest.mark.parametrize("rest_before", [False, True])
@pytest.mark.parametrize(("other", "cost"), [(0.0, 105.0), (0.5, 60.0)])
def test_a_reversal_is_counted_from_before_the_fault(other, cost, rest_before):
    """Two thrusters on one axis: 10 N forward, the second fails, 10 N back. 5 N^2 for each thruster that reverses.

    Alone the first pays 10^2 + 5. Beside one of half the force both push 5 N and pay 2 (5^2 + 5).
    """
    allocator = tolerant(ONE_AXIS, [-30.0, -3.0, 3.0, 30.0], reversal_penalty=5.0)
    allocator.allocate(np.array([10.0, 0, 0]))
    if rest_before:
        allocator.allocate(np.zeros(3))
    allocator.set_health(Health.whole(2).with_thruster(1, other))
    assert allocator.allocate(np.array([-10.0, 0, 0])).cost == pytest.approx(cost)


def test_penalties_after_a_loss_are_those_of_every_subset():
    """Least energy of each of the 16 subsets plus a price per reversed thruster, counted from before the loss."""
    price, limits = 300.0, np.tile([-30.0, -3.0, 4.0, 30.0], (5, 1))
    A = np.column_stack([jack(), [0.2, 0.9, 0.3]])
    rng, told_apart = np.random.default_rng(9), 0
    for _ in range(12):
        allocator = tolerant(A, limits, allow_off=False, reversal_penalty=price)
        last = allocator.allocate(rng.normal(size=3) * [10, 3, 3]).subset[:4]
        allocator.set_health(lost([4], 5))
        wrench = jack() @ rng.uniform(-12.0, 12.0, 4)
        answer = allocator.allocate(wrench)
        best, forgetful = np.inf, np.inf
        for (low, high), signs in zip(cells(limits[:4], False), itertools.product((-1, 1), repeat=4), strict=True):
            solved = least_cost(jack(), np.column_stack([low, high, low, high]), False, wrench)
            if solved is not None:
                reversals = np.sum(np.array(signs) * last < 0)
                best, forgetful = min(best, solved[0] + price * reversals), min(forgetful, solved[0])
        if answer.status == Status.EXACT:
            assert answer.cost == pytest.approx(best, rel=1e-7, abs=1e-6)
            told_apart += best > forgetful + 1.0
    assert told_apart >= 4


def walked(force, limits):
    """(m,) forces counted with the dead zone cut out."""
    return np.where(force > 0.0, force - limits[:, 2], np.where(force < 0.0, force - limits[:, 1], 0.0))


@pytest.mark.parametrize("health", [lost((2,)), lost((2, 5)), WHOLE.with_thruster(4, 0.6).with_thruster(0, stuck=3.0)])
def test_a_change_limit_holds_across_a_fault(health):
    """Counted from what each thruster makes of the last command: all of it, or a weak one its share."""
    limits = np.tile(LIMITS, (8, 1)) * np.where(health.responsive, health.efficiency, 1.0)[:, None]
    wrench, working = np.array([45.0, 20, -30, 1, 1, 0.5]), health.responsive
    for forget in (False, True):
        allocator = tolerant(change_limit=2.0)
        for _ in range(30):
            before = allocator.allocate(wrench).force
        allocator.set_health(health)
        if forget:
            allocator.reset()
        steps, before = [], before * health.efficiency
        for _ in range(30):
            start, before = walked(before, limits), allocator.allocate(wrench).force
            steps.append(np.abs(walked(before, limits) - start)[working].max())
        assert (max(steps) <= 2.0 + 1e-9) != forget
        assert min(steps) < 1e-6  # it settles


@pytest.mark.flight
@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
@pytest.mark.parametrize(
    "A", [jack(), [[1, 0.5, -0.8, 0.3], [0, 0, 0, 0], [-0.2, 0.3, 0.1, -0.4]]], ids=["jack", "flat"]
)
def test_within_a_change_limit_the_cheapest_of_all_subsets_is_found_at_every_price(A, allow_off):
    """What is in reach of the last answer on each side, its own preferred force there, weights, reversals, starts and
    stops: least cost of every subset, before and after a thruster has grown weak."""
    A, rng, signs = np.array(A), np.random.default_rng(11), (-1, 0, 1) if allow_off else (-1, 1)
    limits, most, reversal, switching = np.tile(LIMITS, (4, 1)), 9.0, 80.0, 30.0
    weights, points = rng.uniform(0.5, 2.0, 4), rng.uniform(5.0, 30.0, (4, 2)) * [-1.0, 1.0]
    targets = np.column_stack([points[:, 0], np.zeros(4), points[:, 1]])
    options = {"objective": "reactivity_by_side", "reactivity": points, "weights": weights, "change_limit": most}
    options |= {"allow_off": allow_off, "reversal_penalty": reversal, "switching_penalty": switching}
    allocator, exact = tolerant(A, limits, **options), 0
    force, side, push = np.zeros(4), np.zeros(4), np.zeros(4)
    for tick in range(30):
        if tick == 15:
            allocator.set_health(Health.whole(4).with_thruster(0, 0.6))
            limits, force = limits * np.array([[0.6], [1], [1], [1]]), force * [0.6, 1, 1, 1]
        walk, best = walked(force, limits), np.inf
        wrench = A @ np.clip(force + rng.uniform(-9.0, 9.0, 4), limits[:, 0], limits[:, 3])
        answer = allocator.allocate(wrench)
        for choice in itertools.product(signs, repeat=4):
            sides = np.array(choice)
            edge = np.select([sides < 0, sides > 0], [limits[:, 1], limits[:, 2]], 0.0)
            end = np.select([sides < 0, sides > 0], [limits[:, 0], limits[:, 3]], 0.0)
            low = np.maximum(np.minimum(edge, end), edge + walk - most)
            high = np.minimum(np.maximum(edge, end), edge + walk + most)
            if np.any(low > high):
                continue
            target = targets[np.arange(4), sides + 1]
            cell = np.column_stack([low, high, low, high])
            solved = least_cost(A, cell, False, wrench, target=target, weights=weights)
            if solved is not None:
                price = reversal * np.sum(sides * push < 0) + switching * np.sum((sides == 0) != (side == 0))
                best = min(best, solved[0] + price)
        assert answer.status == (Status.EXACT if best < np.inf else Status.CLOSEST)
        if answer.status == Status.EXACT:
            assert answer.cost == pytest.approx(best, rel=1e-6, abs=1e-5)
            exact += 1
        force, side, push = answer.force, answer.subset, np.where(answer.subset != 0, answer.subset, push)
    assert exact >= 10


def test_a_mended_thruster_starts_from_where_it_was_held():
    """A change limit of 2 N on one axis: from rest once dead, from the force it held once stuck, saturated at most."""
    demand = np.array([100.0, 0, 0])
    for fault, first in (((0.0, np.nan), 5.0), ((0.0, 12.0), 14.0), ((0.0, -12.0), -10.0), ((0.0, 45.0), 30.0)):
        allocator = tolerant(ONE_AXIS, [-30.0, -3.0, 3.0, 30.0], change_limit=2.0)
        allocator.set_health(Health.whole(2).with_thruster(1, *fault))
        allocator.allocate(demand)
        allocator.set_health(Health.whole(2))
        assert allocator.allocate(demand).force[1] == pytest.approx(first)


def test_the_common_regime_keeps_its_way_round():
    """Compensation that runs all thrusters in reverse goes on so; forgetful, it would turn them all."""
    allocator = tolerant(jack(), [-60.0, -4.0, 4.0, 30.0], method="compensation")
    assert np.all(allocator.allocate(jack() @ [-45.0, -5, -45, -5]).force < 0.0)
    allocator.set_health(Health.whole(4).with_thruster(1, 0.9))
    assert np.all(allocator.allocate(np.zeros(3)).force < 0.0)
    allocator.reset()
    assert np.all(allocator.allocate(np.zeros(3)).force > 0.0)


@pytest.mark.parametrize(
    ("health", "message"),
    [
        (WHOLE.with_thruster(0, 1.5), "must lie in 0 to 1"),
        (WHOLE.with_thruster(0, np.nan), "must lie in 0 to 1"),
        (Health.whole(7), r"efficiency has shape \(7,\); the vehicle has 8 thrusters"),
        (Health(np.ones(8), np.zeros(9)), r"stuck has shape \(9,\)"),
        (WHOLE.with_thruster(0, stuck=np.inf), "finite"),
    ],
)
def test_a_mistake_is_named_and_changes_nothing(health, message):
    allocator, wrench = tolerant(), np.array([20.0, 5, 0, 1, 0, 0])
    before = allocator.allocate(wrench).force
    with pytest.raises(AllocationError, match=message):
        allocator.set_health(health)
    assert np.array_equal(allocator.allocate(wrench).force, before)


SQUARE = np.array([[1.0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
NO_DEAD_ZONE = [-10.0, 10.0]


@pytest.mark.parametrize("method", ["search+proxqp", "contraction"])
@pytest.mark.parametrize("health", [Health.whole(4), Health.whole(4).with_thruster(0, stuck=5.0), lost(range(4), 4)])
@pytest.mark.parametrize("nonsense", [np.nan, -np.inf])
def test_a_demand_that_is_no_number_counts_as_zero_whatever_the_health(health, method, nonsense):
    """Beside a thruster stuck at 5 N its healthy twin holds against it."""
    answers = []
    for wrench in ([nonsense, 2, 3], np.zeros(3)):
        allocator = tolerant(SQUARE, NO_DEAD_ZONE, method=method)
        allocator.set_health(health)
        answers.append(allocator.allocate(wrench, np.zeros(3)))
    invalid, zero = answers
    assert (invalid.status, zero.status) == (Status.INVALID_WRENCH, Status.EXACT)
    np.testing.assert_allclose(invalid.force, zero.force, atol=1e-12)
    np.testing.assert_allclose(invalid.wrench_error, np.zeros(3), atol=1e-9)
    assert invalid.residual == pytest.approx(0.0, abs=1e-9)
    assert tolerant(SQUARE, NO_DEAD_ZONE).allocate(np.zeros(3), [nonsense, 0, 0]).status == Status.INVALID_WRENCH


def test_thrusters_that_together_make_no_wrench_rest():
    """The thrusters left have columns of zeros; what was believed before is believed no more."""
    A = np.array([[1.0, 0, 0], [0, 0, 0], [0, 0, 0]])
    allocator = tolerant(A, NO_DEAD_ZONE)
    assert allocator.allocate([4.0, 0, 0]).force.tolist() == [4.0, 0, 0]
    allocator.set_health(lost([0], 3))
    answer = allocator.allocate([4.0, 0, 0])
    assert (answer.force.tolist(), answer.status) == ([0.0, 0, 0], Status.CLOSEST)
    np.testing.assert_allclose(answer.wrench_error, [4.0, 0, 0])
    assert allocator.force_if_whole(answer.force).tolist() == [0.0, 0, 0]
    allocator.set_health(Health.whole(3))
    assert allocator.allocate([4.0, 0, 0]).force.tolist() == [4.0, 0, 0]


def test_thrusters_without_force_rest_when_the_others_are_lost():
    """No limit is left that a preferred force could be compared with."""
    limits = np.array([[-40.0, -4.0, 4.0, 40.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]])
    options = {"objective": "reactivity", "reactivity": [-20.0, 20.0]}
    allocator = tolerant(np.eye(3), limits, **options)
    allocator.set_health(lost([0], 3))
    answer = allocator.allocate([4.0, 0.0, 0.0])
    assert (answer.force.tolist(), answer.status) == ([0.0, 0.0, 0.0], Status.CLOSEST)


def test_what_is_asked_of_a_weak_thruster_lies_in_the_set_of_a_whole_one():
    """4,000 forces at the ends of weak thrusters' intervals, one rounding off when divided by the efficiency."""
    allocator, rng = tolerant(limits=LIMITS), np.random.default_rng(4)
    for _ in range(500):
        efficiency = rng.uniform(0.01, 1.0, 8)
        allocator.set_health(Health(efficiency, np.full(8, np.nan)))
        force = efficiency * rng.choice(LIMITS, 8)
        asked = allocator.force_if_whole(force)
        assert in_allowed_set(asked, np.tile(LIMITS, (8, 1)), True).all()
        np.testing.assert_allclose(asked * efficiency, force, rtol=1e-15)
    assert tolerant().force_if_whole(np.full(8, 1.5)).tolist() == [1.5] * 8  # of a method blind to the dead zone


def test_health_may_be_lists():
    allocator = tolerant(SQUARE, NO_DEAD_ZONE)
    allocator.set_health(Health([0.0, 1, 1, 1], [np.nan] * 4))
    assert allocator.allocate([4.0, 0, 0]).force.tolist() == [0.0, 4, 0, 0]
    with pytest.raises(AllocationError, match="efficiency is not a row of numbers"):
        allocator.set_health(Health(["weak"] * 4, [np.nan] * 4))


@pytest.mark.parametrize("health", [WHOLE, lost(range(8))])
def test_a_wrench_of_the_wrong_size_is_named(health):
    allocator = tolerant()
    allocator.set_health(health)
    with pytest.raises(AllocationError, match=r"the wrench has shape \(3,\); A has 6 rows"):
        allocator.allocate([1.0, 2, 3])
    with pytest.raises(AllocationError, match=r"the secondary part has shape \(2,\); A has 6 rows"):
        allocator.allocate(np.zeros(6), [1.0, 2])


def test_without_voltage_no_force_is_made_whatever_is_held():
    allocator = tolerant()
    allocator.set_health(WHOLE.with_thruster(3, stuck=12.0))
    for wrench, status in (([1.0, 0, 0, 0, 0, 0], Status.CLOSEST), (np.zeros(6), Status.EXACT)):
        answer = allocator.without_force(wrench)
        assert (answer.force.tolist(), answer.status) == ([0.0] * 8, status)
        np.testing.assert_array_equal(answer.wrench_error, wrench)
    assert allocator.without_force([np.nan] * 6).status == Status.INVALID_WRENCH


def test_a_thruster_with_next_to_no_force_counts_as_dead():
    """Its share of what it was told before would overflow, and with it where changes are counted from."""
    A = np.random.default_rng(0).normal(size=(6, 8))
    actuators = FaultTolerant(
        A, np.array([-40, -4, 4, 40.0]), lambda a, table, _: Allocator(a, table, change_limit=3.0)
    )
    for _ in range(5):
        actuators.allocate(A @ np.full(8, 10.0))
    actuators.set_health(Health.whole(8).with_thruster(0, efficiency=1e-310))
    assert actuators.allocate(A @ np.full(8, 10.0)).force[0] == 0.0
    actuators.set_health(Health.whole(8))
    assert np.all(np.abs(actuators.allocate(A @ np.full(8, 20.0)).force) <= 40.0)
