"""What an allocator does with history, nonsense and mistakes."""

import copy
import inspect
import itertools
import pickle

import numpy as np
import pytest
from support.allocation_reference import cells, in_allowed_set, least_cost
from support.layouts import cube, jack

from cube_sim.allocation import Allocator, FaultTolerant, Status, make_allocator
from cube_sim.allocation.exact.solve import solve_each
from cube_sim.allocation.subset_qp.confirmer import subset_problem
from cube_sim.errors import AllocationError

LIMITS = np.array([-40.0, -3.2, 4.0, 50.0])


@pytest.mark.parametrize("method", ["search+proxqp", "search"])
def test_an_answer_depends_on_its_own_demand_to_the_last_bit(method):
    """Unique optima come out the same whatever was asked before: nothing is warm-started from history."""
    A = cube(direction_noise=0.05, position_noise_m=0.01, seed=4)
    wrenches = np.random.default_rng(6).normal(size=(60, 6)) * [30, 30, 30, 8, 8, 8]
    allocator = Allocator(A, LIMITS, method=method)
    forward = [allocator.allocate(w).force.tobytes() for w in wrenches]
    backward = [allocator.allocate(w).force.tobytes() for w in wrenches[::-1]][::-1]
    fresh = [Allocator(A, LIMITS, method=method).allocate(w).force.tobytes() for w in wrenches[:10]]
    assert forward == backward
    assert forward[:10] == fresh


def test_ties_keep_the_previous_subset():
    """At zero demand the strict planar vehicle may run all forward or all backward at the same cost: it stays."""
    allocator = Allocator(jack(), [-30, -4, 4, 30], allow_off=False)
    assert np.allclose(allocator.allocate(np.zeros(3)).force, 4.0)
    backward = np.array([-6.0, -4.0, -4.0, -4.0])  # its forward twin costs more: 4, 6, 6, 6
    assert np.allclose(allocator.allocate(jack() @ backward).force, backward)
    assert np.allclose(allocator.allocate(np.zeros(3)).force, -4.0)
    allocator.reset()
    assert np.allclose(allocator.allocate(np.zeros(3)).force, 4.0)


def test_reversal_penalty_is_part_of_the_optimum():
    """Cost with penalties against every subset: least energy of the subset plus a price per reversed thruster."""
    A, price = jack(), 300.0
    limits = np.tile([-30.0, -3.0, 4.0, 30.0], (4, 1))
    allocator = Allocator(A, limits, allow_off=False, reversal_penalty=price)
    last = np.zeros(4)
    kept = 0
    for wrench in np.random.default_rng(9).normal(size=(60, 3)) * [10, 3, 3]:
        answer = allocator.allocate(wrench)
        if answer.status != Status.EXACT:
            last = np.where(answer.subset != 0, answer.subset, last)
            continue
        best, plain = np.inf, np.inf
        for (low, high), signs in zip(cells(limits, False), itertools.product((-1, 1), repeat=4), strict=True):
            cell = np.column_stack([low, low, low, high])  # one interval: both its sides are the cell itself
            cell[:, 1], cell[:, 2] = high, low
            solved = least_cost(A, cell, False, wrench)
            if solved is not None:
                plain = min(plain, solved[0])
                best = min(best, solved[0] + price * np.sum(np.array(signs) * last < 0))
        assert answer.cost == pytest.approx(best, rel=1e-7, abs=1e-6)
        kept += answer.force @ answer.force > plain * (1 + 1e-6)
        last = np.where(answer.subset != 0, answer.subset, last)
    assert kept > 5  # the penalty did change decisions


def test_the_penalty_remembers_through_rest():
    allocator = Allocator([[1.0], [0.0], [0.0]], [-30, -3, 3, 30], reversal_penalty=5.0)
    assert allocator.allocate([10, 0, 0]).cost == pytest.approx(100.0)
    assert allocator.allocate([0, 0, 0]).cost == 0.0
    assert allocator.allocate([-10, 0, 0]).cost == pytest.approx(105.0)
    assert allocator.allocate([-10, 0, 0]).cost == pytest.approx(100.0)


@pytest.mark.flight
@pytest.mark.parametrize("dwell_calls", [None, 2])
@pytest.mark.parametrize("objective", ["energy", "reactivity_by_side"])
def test_switching_penalty_is_part_of_the_optimum(objective, dwell_calls):
    """Cost with prices of starts, stops and reversals against all 3^4 subsets, and decisions it did change."""
    A, start_stop, reversal = jack(), 40.0, 150.0
    limits = np.tile([-30.0, -3.0, 4.0, 30.0], (4, 1))
    extra = {} if objective == "energy" else {"reactivity": [-8.0, 9.0]}
    allocator = Allocator(
        A, limits, objective=objective, switching_penalty=start_stop, reversal_penalty=reversal,
        dwell_calls=dwell_calls, **extra,
    )  # fmt: skip
    last, push, held, longest = np.zeros(4), np.zeros(4), np.zeros(4), 0
    changed = exact = 0
    for wrench in np.random.default_rng(9).normal(size=(30, 3)) * [10, 3, 3]:
        answer = allocator.allocate(wrench)
        best, plain = np.inf, np.inf
        for (low, high), signs in zip(cells(limits, True), itertools.product((-1, 1, 0), repeat=4), strict=True):
            side = np.array(signs)
            target = np.zeros(4) if objective == "energy" else np.choose(side + 1, [-8.0, 0.0, 9.0])
            solved = least_cost(A, np.column_stack([low, high, low, high]), False, wrench, target=target)
            if solved is not None:
                share = np.ones(4) if dwell_calls is None else np.minimum(1.0, dwell_calls / np.maximum(held, 1))
                price = start_stop * share @ ((side == 0) != (last == 0)) + reversal * share @ (side * push < 0)
                plain, best = min(plain, solved[0]), min(best, solved[0] + price)
        assert (answer.status == Status.EXACT) == (best < np.inf)
        if answer.status == Status.EXACT:
            assert answer.cost == pytest.approx(best, rel=1e-7, abs=1e-6)
            target = 0.0 if objective == "energy" else np.choose(answer.subset + 1, [-8.0, 0.0, 9.0])
            changed += np.sum((answer.force - target) ** 2) > plain * (1 + 1e-6) + 1e-6
            exact += 1
        kept = answer.subset == last
        held, longest = np.where(kept, held + 1, 1), max(longest, held.max())
        last, push = answer.subset, np.where(answer.subset != 0, answer.subset, push)
    assert changed > 3
    assert longest > 4
    assert exact > 15


def test_a_second_thruster_does_not_come_and_go_at_the_edge_of_its_dead_zone():
    """8.3 N is cheaper made by two thrusters, 7.7 N is made by one only: a price of starting leaves it to one."""

    def switches(penalty):
        allocator = Allocator([[1.0, 1.0], [0, 0], [0, 0]], [-30, -4, 4, 30], switching_penalty=penalty)
        running = np.array([allocator.allocate([demand, 0, 0]).subset != 0 for demand in (8.3, 7.7) * 20])
        return int(np.sum(running[1:] != running[:-1]))

    assert switches(0.0) == 39
    assert switches(50.0) == 0  # more than the 8.3^2 - 2 * 4.15^2 = 34 N^2 that a second thruster saves


@pytest.mark.parametrize("method", ["search", "enumerate"])
@pytest.mark.parametrize("penalty", [50.0, 64.0, 340.0])
def test_a_thruster_starts_when_staying_at_rest_has_cost_as_much(penalty, method):
    """A second thruster saves 8.3^2 - 2 * 4.15^2 = 34 N^2 a call: without `dwell_calls` it never starts."""
    rows, limits, saved = [[1.0, 1.0], [0, 0], [0, 0]], [-30, -4, 4, 30], 8.3**2 - 2 * 4.15**2
    for dwell_calls, calls in ((None, np.inf), (5.0, 5.0 * penalty / saved)):
        allocator = Allocator(rows, limits, switching_penalty=penalty, dwell_calls=dwell_calls, method=method)
        for _ in range(3):
            allocator.allocate([7.7, 0, 0])  # which one of them makes
        rests = [int(np.sum(allocator.allocate([8.3, 0, 0]).subset == 0)) for _ in range(60)]
        alone = 3 + np.sum(rests)
        assert alone == (63 if calls == np.inf else np.floor(calls) + 1)
        assert rests == sorted(rests, reverse=True)


def test_a_second_thruster_comes_and_goes_no_more_often_than_it_pays():
    allocator = Allocator([[1.0, 1.0], [0, 0], [0, 0]], [-30, -4, 4, 30], switching_penalty=170.0, dwell_calls=10)
    running = np.array([allocator.allocate([demand, 0, 0]).subset != 0 for demand in (8.3, 7.7) * 200])
    assert 8 < int(np.sum(running[1:] != running[:-1])) <= 2 * 400 / (10 * 170.0 / 34.4)


@pytest.mark.parametrize("nonsense", [np.nan, np.inf, -np.inf])
def test_a_wrench_that_is_no_number_is_answered_as_zero(nonsense):
    allocator = Allocator(cube(), LIMITS)
    answer = allocator.allocate([1, 2, nonsense, 0, 0, 0])
    assert answer.status == Status.INVALID_WRENCH
    assert np.array_equal(answer.force, np.zeros(8))
    assert answer.residual == 0.0
    assert allocator.allocate(np.eye(6)[0]).status == Status.EXACT


@pytest.mark.parametrize("size", [1e3, 1e9, 1e100, 1e300])
def test_a_huge_demand_saturates_in_its_direction(size):
    allocator = Allocator(cube(), LIMITS, wrench_weights=np.ones(6))
    direction = np.array([1.0, 0.2, -0.3, 0.1, 0, 0])
    with np.errstate(over="ignore"):
        answer = allocator.allocate(size * direction)
    assert answer.status == Status.CLOSEST
    assert in_allowed_set(answer.force, allocator.limits, True).all()
    assert direction @ answer.wrench == pytest.approx(
        np.maximum(direction @ allocator.A * -40, direction @ allocator.A * 50).sum(), rel=2e-2
    )


def test_one_sided_and_fixed_thrusters():
    limits = [[0, 0, 4, 50], [-40, -4, 0, 0], [0, 0, 0, 0], [7, 7, 7, 7]]
    with pytest.raises(AllocationError, match=r"thruster 4: limits \[7.0"):
        Allocator(jack(), limits)
    allocator = Allocator(jack(), [*limits[:3], [-7, -7, 7, 7]], allow_off=False)
    for wrench in np.random.default_rng(0).normal(size=(20, 3)) * 10:
        force = allocator.allocate(wrench).force
        assert in_allowed_set(force, allocator.limits, False).all()
        assert force[2] == 0.0
        assert abs(force[3]) == 7.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"limits": [-1, 2, 3]}, r"limits have shape \(3,\); 4 thrusters need \(4, 4\)"),
        ({"limits": [[-9, -1, 1, 9]] * 3}, r"limits have shape \(3, 4\)"),
        ({"limits": [-9, -1, 2, 1]}, "thruster 1: .* must be finite and ordered"),
        ({"limits": [-9, 1, 2, 9]}, "must be finite and ordered"),
        ({"limits": [-9, -1, 1, np.inf]}, "must be finite"),
        ({"limits": "strong"}, "limits is not a table of numbers"),
        ({"A": np.zeros((4, 4))}, r"the actuation matrix has shape \(4, 4\); it needs 6 rows"),
        ({"A": np.zeros((3, 4))}, "the actuation matrix is zero: no thruster makes"),
        ({"A": np.full((3, 4), np.nan)}, "nan in row 1, column 1"),
        ({"A": np.zeros((3, 0))}, "no thruster is left"),
        ({"method": "magic"}, r"no method 'magic'; there are search\+proxqp, search, enumerate"),
        ({"objective": "speed"}, "no objective 'speed'; there are energy, target, reactivity, reactivity_by_side"),
        ({"objective": "target"}, "go together"),
        ({"target": np.zeros(4)}, "go together"),
        ({"weights": [1, 1, 0, 1]}, "finite and > 0"),
        ({"weights": [1, 1]}, r"weights has shape \(2,\); it needs \(4,\)"),
        ({"wrench_weights": [1, 1, np.nan]}, "finite"),
        ({"reversal_penalty": -1.0}, "must be >= 0"),
        ({"switching_penalty": -1.0}, "switching_penalty is -1.0; it must be >= 0"),
        ({"dwell_calls": 0.0}, r"dwell_calls is \[0.0\]; every entry must be finite and > 0"),
        ({"tolerance_N": 0.0}, "> 0"),
        ({"tolerance_N": 1e-30}, "tolerance_N is 1e-30; forces of 50 N need 5e-09 at least"),
        ({"A": jack() * 1e160}, r"the actuation matrix holds 9.66e\+159; numbers beyond 1e\+30 leave double precision"),
        ({"A": jack() * 1e-160}, "the actuation matrix holds 9.66e-161 at most; below 1e-30"),
        ({"A": jack() + 1j}, "the actuation matrix is not a table of numbers: its entries must be real"),
        ({"A": [[10**400, 1, 1, 1]] * 3}, "the actuation matrix is not a table of numbers"),
        ({"limits": np.array(LIMITS) * 1e160}, r"limits holds 5e\+161; numbers beyond"),
        ({"limits": [-9, -1, 1, 10**400]}, "limits is not a table of numbers"),
        ({"reversal_penalty": 1e200}, "reversal_penalty holds 1e\\+200"),
        ({"weights": [1e-5, 1, 1, 1e5]}, "weights spans 1e-05 to 100000; .* in a ratio of 1e\\+06 at most"),
        ({"weights": 1e-22}, "weights spans 1e-22 to 1e-22; give weights within 1e-06 to 1e\\+06"),
        ({"objective": "target", "target": 1e9}, "forces of 1e\\+09 N are preferred; beyond 1e\\+06 times"),
        ({"wrench_weights": [1, 1, 1e8]}, "wrench_weights spans 1 to 1e\\+08; give weights within 1e-06 to 1e\\+06"),
        ({"allow_off": "no"}, "allow_off is 'no'; it must be True or False"),
        ({"method": ["search"]}, "no method"),
        ({"length_m": -1.0}, "> 0"),
    ],
)
def test_a_mistake_is_named(arguments, message):
    with pytest.raises(AllocationError, match=message):
        Allocator(**{"A": jack(), "limits": LIMITS} | arguments)


@pytest.mark.parametrize(
    "wrench", [["a", 0, 0], [1j, 0, 0], np.array([1j, 0, 0]), [[1, 2], [3]], [10**400, 0, 0], None]
)
@pytest.mark.parametrize("method", ["search", "contraction"])
def test_a_wrench_that_is_no_vector_of_numbers_is_named(method, wrench):
    allocator = make_allocator(method, jack(), LIMITS)
    with pytest.raises(AllocationError, match=r"the wrench (is not a vector of numbers|has shape)"):
        allocator.allocate(wrench)
    with pytest.raises(AllocationError, match=r"the wrench (is not a vector of numbers|has shape)"):
        FaultTolerant(jack(), LIMITS, lambda A, limits, _: Allocator(A, limits)).allocate(wrench)
    with pytest.raises(AllocationError, match="search knows no speed; it takes allow_off, objective, target"):
        make_allocator("search", jack(), LIMITS, {"speed": 3})


@pytest.mark.parametrize("least", [1e-6, 1e-3, 1.0])
def test_thruster_weights_as_different_as_is_allowed(least):
    rng = np.random.default_rng(3)
    for _ in range(12):
        weights = least * 1e6 ** rng.permutation([0.0, 1.0, *rng.uniform(size=2)])
        wrench = jack() @ rng.choice([-40.0, -3.2, 0.0, 4.0, 50.0, 20.0, -10.0], 4)
        answer = Allocator(jack(), LIMITS, weights=weights).allocate(wrench)
        assert answer.status == Status.EXACT
        assert answer.cost == pytest.approx(
            least_cost(jack(), np.tile(LIMITS, (4, 1)), True, wrench, weights=weights)[0], rel=1e-6
        )


def test_a_wrench_of_the_wrong_size_is_named():
    with pytest.raises(AllocationError, match=r"shape \(6,\); A has 3 rows"):
        Allocator(jack(), LIMITS).allocate(np.zeros(6))


def test_a_read_only_or_shifted_wrench_is_answered_without_compiling_anew():
    """Compiled code knows these as other types: each would stop the vehicle for half a minute, once."""
    allocator, wrench = Allocator(jack(), LIMITS), np.array([9.0, 1.0, 2.0])
    expected = allocator.allocate(wrench)
    known = [len(function.forms) for function in (solve_each, subset_problem)]
    shifted = np.frombuffer(bytearray(25), np.float64, offset=1)
    shifted[:] = wrench
    for same in (np.broadcast_to(wrench, (1, 3))[0], np.repeat(wrench, 2)[::2], shifted, np.ma.array(wrench)):
        assert allocator.allocate(same).force.tobytes() == expected.force.tobytes()
    assert [len(function.forms) for function in (solve_each, subset_problem)] == known


def test_status_says_where_the_search_gave_up_its_proof():
    """Twelve thrusters with a preferred force on each side: some wrenches take more nodes than a tick has time for."""
    rng = np.random.default_rng(0)
    A = rng.normal(size=(6, 12))
    allocator = Allocator(A, [-40, -6, 7, 50], objective="reactivity_by_side", reactivity=[-20, 30], method="search")
    seen = []
    for forces in rng.uniform(-40, 50, size=(25, 12)):
        before = allocator.effort.unproven
        answer = allocator.allocate(A @ forces)
        gave_up = allocator.effort.unproven > before
        assert answer.status == (Status.UNPROVEN if gave_up else Status.EXACT)
        assert np.allclose(A @ answer.force, A @ forces, atol=1e-6)
        seen.append(gave_up)
    assert any(seen)
    assert not all(seen)


@pytest.mark.parametrize("limit", [0.1, 0.3, 0.7, 1.1])
@pytest.mark.parametrize("steps", range(1, 12))
def test_what_lies_exactly_one_change_limit_away_is_within_reach(limit, steps):
    allocator = Allocator([[1.0], [0.0], [0.0]], [-40.0, -4.0, 4.0, 40.0], change_limit=limit, method="search")
    walk = [float(allocator.allocate([sign * 40.0, 0.0, 0.0]).force[0]) for sign in (-1, 1) for _ in range(steps)]
    # From rest to -4 N less (steps) limits; back at the dead zone's edge, +4 N, after as many.
    np.testing.assert_allclose(walk[steps - 1], -4.0 - steps * limit, rtol=1e-12)
    np.testing.assert_allclose(walk[-1], 4.0, rtol=1e-12)


COPIES = {"deepcopy": copy.deepcopy, "copy": copy.copy, "pickle": lambda it: pickle.loads(pickle.dumps(it))}


@pytest.mark.flight
@pytest.mark.parametrize("duplicate", COPIES.values(), ids=COPIES)
@pytest.mark.parametrize("method", ["search+proxqp", "search", "enumerate"])
def test_a_copy_goes_on_as_its_original_does(method, duplicate):
    """To the last bit, history included, and without either knowing of the other."""
    options = {"objective": "reactivity_by_side", "reactivity": [-20.0, 25.0], "weights": [1.0, 2.0, 3.0, 1.0]}
    options |= {"reversal_penalty": 300.0, "change_limit": 9.0, "unattainable": "scaled", "method": method}
    original = Allocator(jack(), LIMITS, **options)
    wrenches = np.random.default_rng(8).normal(size=(12, 3)) * [20, 9, 4]
    for wrench in wrenches[:4]:
        original.allocate(wrench)
    twin, disturbed = duplicate(original), duplicate(original)
    disturbed.allocate(-wrenches[0])
    assert twin.effort == original.effort
    for wrench in wrenches[4:]:
        answer, expected = twin.allocate(wrench), original.allocate(wrench)
        assert answer.force.tobytes() == expected.force.tobytes()
        assert (answer.cost, answer.status) == (expected.cost, expected.status)
    assert twin.effort == original.effort


def test_a_copy_is_given_every_option():
    rebuild, _, _ = Allocator(jack(), LIMITS).__reduce__()
    assert {"A", "limits", *rebuild.keywords} == set(inspect.signature(Allocator).parameters)


def test_a_copied_fault_tolerant_allocator_goes_on_too():
    original = FaultTolerant(jack(), LIMITS, lambda A, limits, _: Allocator(A, limits, reversal_penalty=300.0))
    original.allocate(np.array([-20.0, 0, 0]))
    original.set_health(original.health.with_thruster(1, 0.5))
    twin, wrench = copy.deepcopy(original), np.array([9.0, 1, 0])
    assert twin.allocate(wrench).force.tobytes() == original.allocate(wrench).force.tobytes()
