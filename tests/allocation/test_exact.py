"""The allocator's optimum against enumerations that share no code with it."""

import numpy as np
import pytest
from support.allocation_reference import in_allowed_set, least_cost, probing_wrenches
from support.layouts import cube, jack

from cube_sim.allocation import Allocator, Status

LIMITS = np.array([-40.0, -3.2, 4.0, 50.0])
VEHICLES = {
    "ideal": cube(),
    "as built": cube(direction_noise=0.05, position_noise_m=0.01, seed=4),
    "one lost": np.delete(cube(direction_noise=0.05, position_noise_m=0.01, seed=4), 2, axis=1),
    "planar": jack(),
}


@pytest.mark.flight
@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
@pytest.mark.parametrize("vehicle", VEHICLES)
def test_costs_what_exhaustive_pinning_says(vehicle, allow_off):
    A = VEHICLES[vehicle]
    allocator = Allocator(A, LIMITS, allow_off=allow_off)
    attainable = unattainable = 0
    for wrench in probing_wrenches(A, allocator.limits, allow_off, seed=len(vehicle)):
        answer = allocator.allocate(wrench)
        reference = least_cost(A, allocator.limits, allow_off, wrench)
        assert in_allowed_set(answer.force, allocator.limits, allow_off).all()
        assert (answer.status == Status.EXACT) == (reference is not None), wrench
        if reference is None:
            unattainable += 1
            continue
        attainable += 1
        assert answer.cost == pytest.approx(reference[0], rel=1e-7, abs=1e-6), wrench
        assert answer.residual <= 1e-6
    assert attainable > 30
    assert unattainable > 3
    assert allocator.effort.disagreements == 0
    assert allocator.effort.unproven == 0
    assert allocator.effort.qps >= attainable


@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
def test_weights_and_a_wanted_force_reach_the_same_optimum(allow_off):
    A = VEHICLES["as built"]
    rng = np.random.default_rng(11)
    target, weights = rng.uniform(-30.0, 40.0, 8), rng.uniform(0.2, 5.0, 8)
    allocator = Allocator(A, LIMITS, allow_off=allow_off, objective="target", target=target, weights=weights)
    for wrench in rng.normal(size=(25, 6)) * [15, 15, 15, 4, 4, 4]:
        answer = allocator.allocate(wrench)
        reference = least_cost(A, allocator.limits, allow_off, wrench, target=target, weights=weights)
        assert answer.cost == pytest.approx(reference[0], rel=1e-7)
        assert np.allclose(answer.force, reference[1], atol=1e-5)


@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
def test_the_reports_enumeration_agrees(allow_off):
    A = jack()
    search = Allocator(A, LIMITS, allow_off=allow_off)
    report = Allocator(A, LIMITS, allow_off=allow_off, method="enumerate")
    for wrench in np.random.default_rng(2).normal(size=(12, 3)) * [20, 5, 5]:
        fast, slow = search.allocate(wrench), report.allocate(wrench)
        assert fast.status == slow.status
        assert fast.cost == pytest.approx(slow.cost, rel=1e-6)
        assert fast.residual == pytest.approx(slow.residual, abs=1e-5)
    assert report.effort.qps >= 12 * (81 if allow_off else 16)


def test_the_reports_enumeration_agrees_on_the_cube():
    A = VEHICLES["as built"]
    search, report = Allocator(A, LIMITS, allow_off=False), Allocator(A, LIMITS, allow_off=False, method="enumerate")
    for wrench in np.random.default_rng(3).normal(size=(3, 6)) * [15, 15, 15, 4, 4, 4]:
        fast, slow = search.allocate(wrench), report.allocate(wrench)
        assert np.array_equal(fast.subset, slow.subset)
        assert np.allclose(fast.force, slow.force, atol=1e-4)
    assert report.effort.qps == 3 * 256


def test_no_dead_zone_and_no_saturation_is_the_pseudo_inverse():
    A = VEHICLES["as built"]
    allocator = Allocator(A, [-1e3, 1e3])
    for wrench in np.random.default_rng(5).normal(size=(20, 6)):
        answer = allocator.allocate(wrench)
        assert np.allclose(answer.force, np.linalg.pinv(A) @ wrench, atol=1e-10)


def test_unit_costs_of_the_ideal_cube():
    """A A^T = diag(8/3 I, 8 a^2 I): a unit force costs 3/8, a unit torque 1 / (8 a^2)."""
    allocator = Allocator(cube(arm_m=0.2), [-10, 10])
    for row, cost in enumerate([3 / 8] * 3 + [1 / (8 * 0.04)] * 3):
        assert allocator.allocate(np.eye(6)[row]).cost == pytest.approx(cost, rel=1e-12)


def test_zero_wrench():
    """Thrusters that may rest do; thrusters that may not run the common regime of ker A at the dead-zone edges."""
    A = cube()
    assert np.array_equal(Allocator(A, LIMITS).allocate(np.zeros(6)).force, np.zeros(8))
    strict = Allocator(A, [-40, -4, 4, 50], allow_off=False).allocate(np.zeros(6))
    assert strict.status == Status.EXACT
    assert np.allclose(A @ strict.force, 0.0, atol=1e-9)
    assert strict.cost == pytest.approx(least_cost(A, np.tile([-40.0, -4, 4, 50], (8, 1)), False, np.zeros(6))[0])


def test_every_attainable_end_point_is_attained():
    """All thrusters at any mix of interval ends: the demand lies on the border of its cell."""
    for A in (cube(), VEHICLES["as built"]):
        allocator = Allocator(A, LIMITS)
        rng = np.random.default_rng(8)
        for _ in range(200):
            force = rng.choice([*LIMITS, 0.0], size=8)
            answer = allocator.allocate(A @ force)
            assert answer.status == Status.EXACT
            assert answer.cost <= force @ force * (1 + 1e-9) + 1e-9


@pytest.mark.parametrize("thrusters", range(1, 13))
@pytest.mark.parametrize("rows", [3, 6])
def test_any_number_of_thrusters_and_any_rank(thrusters, rows):
    """Kernels of every dimension, rank-deficient and zero columns included: exact, or closest, always allowed."""
    rng = np.random.default_rng(100 * rows + thrusters)
    for rank in range(1, min(rows, thrusters) + 1):
        A = rng.normal(size=(rows, rank)) @ rng.normal(size=(rank, thrusters))
        if thrusters > rank + 1:
            A[:, 0] = 0.0
        allocator = Allocator(A, LIMITS, allow_off=bool(rank % 2), method="search")
        for _ in range(3):
            force = np.where(
                rng.random(thrusters) < 0.5, rng.uniform(-40, -3.2, thrusters), rng.uniform(4, 50, thrusters)
            )
            attained = allocator.allocate(A @ force)
            assert attained.status == Status.EXACT
            assert attained.residual <= 1e-6
            assert attained.cost <= force @ force * (1 + 1e-9)
            other = allocator.allocate(100 * rng.normal(size=rows))
            assert in_allowed_set(other.force, allocator.limits, bool(rank % 2)).all()
            assert np.isfinite([other.residual, other.cost]).all()
        assert allocator.effort.unproven == 0
