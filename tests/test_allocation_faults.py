"""Motors lost, weak or stuck while the vehicle runs."""

import itertools

import numpy as np
import pytest
from allocation_reference import cube, in_allowed_set, least_cost, least_distance

from cube_sim.allocation import Allocator, Status
from cube_sim.errors import AllocationError

LIMITS = np.array([-40.0, -3.2, 4.0, 50.0])
BUILT = cube(direction_noise=0.05, position_noise_m=0.01, seed=4)


@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
@pytest.mark.parametrize("lost", [(0,), (2, 5), (1, 4, 6), (0, 1, 2, 3)])
def test_lost_motors_are_a_vehicle_without_their_columns(lost, allow_off):
    efficiency = np.ones(8)
    efficiency[list(lost)] = 0.0
    allocator = Allocator(BUILT, LIMITS, allow_off=allow_off).with_faults(efficiency)
    left = np.delete(np.arange(8), lost)
    rest = np.tile(LIMITS, (len(left), 1))
    rng = np.random.default_rng(sum(lost))
    wrenches = [BUILT[:, left] @ rng.choice([*LIMITS, 20.0, -9.0], size=len(left)) for _ in range(6)]
    wrenches += [*rng.normal(size=(6, 6)) * [15, 15, 15, 3, 3, 3]]
    exact = 0
    for wrench in wrenches:
        answer = allocator.allocate(wrench)
        assert not answer.force[list(lost)].any()
        assert in_allowed_set(answer.force[left], rest, allow_off).all()
        reference = least_cost(BUILT[:, left], rest, allow_off, wrench, tolerance=1e-6)
        assert (answer.status == Status.EXACT) == (reference is not None)
        exact += reference is not None
        if reference is not None:
            assert answer.cost == pytest.approx(reference[0], rel=1e-5)
    assert exact >= 6
    assert (allocator.effort.disagreements, allocator.effort.unproven) == (0, 0)


def test_unattainable_after_losses_is_the_closest_of_the_smaller_vehicle():
    left = [0, 1, 3, 4, 7]
    efficiency = np.isin(np.arange(8), left).astype(float)
    allocator = Allocator(BUILT, LIMITS, allow_off=False).with_faults(efficiency)
    for wrench in np.random.default_rng(1).normal(size=(6, 6)) * [30, 30, 30, 6, 6, 6]:
        answer = allocator.allocate(wrench)
        assert answer.status == Status.CLOSEST
        distance = np.linalg.norm(allocator.wrench_weights * answer.wrench_error)
        reference = least_distance(BUILT[:, left], np.tile(LIMITS, (5, 1)), False, wrench, allocator.wrench_weights)
        assert distance == pytest.approx(reference, rel=1e-7, abs=1e-6)


def test_a_stuck_motor_is_a_demand_less_its_wrench():
    for force in (12.0, -7.0, 1.5, 0.0):
        stuck = Allocator(BUILT, LIMITS).with_faults(stuck={3: force})
        rest = np.delete(BUILT, 3, axis=1)
        for wrench in np.random.default_rng(2).normal(size=(8, 6)) * [15, 15, 15, 3, 3, 3]:
            answer = stuck.allocate(wrench)
            assert answer.force[3] == force
            assert answer.subset[3] == np.sign(force)
            reference = least_cost(rest, np.tile(LIMITS, (7, 1)), True, wrench - force * BUILT[:, 3])
            assert (answer.status == Status.EXACT) == (reference is not None)
            if reference is not None:
                assert answer.cost == pytest.approx(reference[0] + force**2, rel=1e-7)


def test_a_weak_motor_has_narrower_limits():
    efficiency = np.array([1, 0.5, 1, 1, 0.25, 1, 1, 1])
    weak = Allocator(BUILT, LIMITS).with_faults(efficiency)
    narrow = Allocator(BUILT, LIMITS * efficiency[:, None])
    for wrench in np.random.default_rng(3).normal(size=(20, 6)) * [40, 40, 40, 9, 9, 9]:
        assert np.allclose(weak.allocate(wrench).force, narrow.allocate(wrench).force, atol=1e-6)


def test_memory_goes_on_and_faults_do_not_add_up():
    whole = Allocator(BUILT, LIMITS, reversal_penalty=30.0, change_limit=5.0)
    wrench = np.array([20.0, 5, 0, 1, 0, 0])
    for _ in range(10):
        whole.allocate(wrench)
    faulty = whole.with_faults(stuck={0: 9.0})
    mended = faulty.with_faults()
    assert np.array_equal(mended.allocate(wrench).force, whole.allocate(wrench).force)
    assert faulty.allocate(wrench).force[0] == 9.0


def test_all_motors_lost_is_answered():
    answer = Allocator(BUILT, LIMITS, allow_off=False).with_faults(0.0).allocate([1, 2, 3, 0, 0, 0])
    assert answer.status == Status.CLOSEST
    assert not answer.force.any()
    assert answer.residual == pytest.approx(np.sqrt(14.0))


def test_every_pair_can_be_lost_and_always_gives_an_allowed_answer():
    whole = Allocator(cube(), LIMITS, allow_off=False, method="search")
    for pair in itertools.combinations(range(8), 2):
        faulty = whole.with_faults(np.where(np.isin(np.arange(8), pair), 0.0, 1.0))
        answers = faulty.allocate_many(np.vstack([np.zeros(6), 20 * np.eye(6), -5 * np.eye(6)]))
        left = np.delete(answers.force, pair, axis=1)
        assert in_allowed_set(left, np.tile(LIMITS, (6, 1)), False).all()
        assert not answers.force[:, pair].any()
    assert whole.effort.unproven == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"efficiency": 1.5}, "must lie in 0 to 1"),
        ({"efficiency": [1, 1]}, r"needs \(8,\)"),
        ({"stuck": {8: 1.0}}, "no motor 8 to be stuck; there are 0 to 7"),
        ({"stuck": {0: np.nan}}, "finite"),
    ],
)
def test_a_mistake_is_named(arguments, message):
    with pytest.raises(AllocationError, match=message):
        Allocator(BUILT, LIMITS).with_faults(**arguments)
