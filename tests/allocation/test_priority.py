"""Demands in two parts, of which the second gives way: against a linear programme on every subset."""

import numpy as np
import pytest
from support.allocation_reference import in_allowed_set, largest_share, least_cost, least_distance
from support.layouts import cube, jack

from cube_sim.allocation import Allocator, FaultTolerant, Status
from cube_sim.errors import AllocationError

LIMITS = np.array([-20.0, -3.0, 4.0, 25.0])
BUILT = cube(direction_noise=0.05, position_noise_m=0.01, seed=4)


def check(allocator, allow_off, primary, secondary):
    """Compare one answer with the references; returns its status."""
    A, limits = allocator.A, allocator.limits
    answer = allocator.allocate_by_priority(primary, secondary)
    assert in_allowed_set(answer.force, limits, allow_off).all()
    assert np.allclose(answer.wrench + answer.wrench_error, primary + secondary)
    share = largest_share(A, limits, allow_off, primary, secondary)
    if share is None:
        assert answer.status == Status.CLOSEST
        weights = allocator.wrench_weights
        distance = np.linalg.norm(weights * (answer.wrench - primary))
        reference = least_distance(A, limits, allow_off, primary, weights)
        assert distance == pytest.approx(reference, rel=1e-7, abs=1e-6)
        return answer.status
    assert answer.status == (Status.EXACT if share > 1.0 - 1e-9 else Status.YIELDED)
    assert np.allclose(answer.wrench, primary + share * secondary, atol=1e-5)
    cheapest = least_cost(A, limits, allow_off, answer.wrench, tolerance=1e-6)
    assert answer.cost == pytest.approx(cheapest[0], rel=1e-4, abs=1e-4)
    return answer.status


@pytest.mark.flight
@pytest.mark.parametrize("method", ["search+proxqp", "enumerate"])
@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
def test_planar_vehicle_against_linear_programmes(allow_off, method):
    allocator = Allocator(jack(), LIMITS, allow_off=allow_off, method=method)
    rng = np.random.default_rng(3)
    count = 20 if method == "search+proxqp" else 6
    primaries = rng.normal(size=(count, 3)) * [8, 3, 3] * rng.choice([0.1, 1.0, 6.0], size=(count, 1))
    secondaries = rng.normal(size=(count, 3)) * [40, 15, 10]
    statuses = [check(allocator, allow_off, *parts) for parts in zip(primaries, secondaries, strict=True)]
    assert set(statuses) == {Status.EXACT, Status.YIELDED, Status.CLOSEST} or count < 20
    assert statuses.count(Status.YIELDED) > count // 4
    assert allocator.effort.unproven == 0
    assert allocator.effort.disagreements == 0


@pytest.mark.flight
def test_cube_against_linear_programmes_on_all_256_subsets():
    """Torques first, forces as far as they go: what a controller that wants its attitude asks for."""
    allocator = Allocator(BUILT, [-40, -10, 10, 50], allow_off=False)
    rng = np.random.default_rng(7)
    for _ in range(2):
        torque, force = np.zeros(6), np.zeros(6)
        torque[3:], force[:3] = 3.0 * rng.normal(size=3), 300.0 * rng.normal(size=3)
        assert check(allocator, False, torque, force) == Status.YIELDED


@pytest.mark.parametrize("method", ["search", "enumerate"])
def test_a_share_at_the_border_of_what_is_attainable_is_yielding_too(method):
    """Motor 2 makes next to nothing: a rounding of the share is many of its force, which is at its limit."""
    A = np.array(
        [
            [0.66410098, 0.01682453, -0.7233043, -0.93748738],
            [-0.47435391, 0.00994989, -1.46572931, -0.19872034],
            [-0.38060022, 0.05150709, -0.64723481, -1.94291853],
        ]
    )
    limits = [[-44.7, -3.1, 3.7, 64.3], [-32.8, -4.4, 3.7, 50.3], [-56.3, 0, 0, 32.6], [-46.0, -2.6, 6.6, 51.8]]
    primary = np.array([3.33599253, 1.73881024, 0.99478183])
    secondary = np.array([13.86028701, -81.82159915, 39.23969439])
    assert check(Allocator(A, limits, method=method), True, primary, secondary) == Status.YIELDED


def test_what_is_attainable_whole_is_allocated_as_ever():
    one, other = Allocator(BUILT, LIMITS, reversal_penalty=50.0), Allocator(BUILT, LIMITS, reversal_penalty=50.0)
    rng = np.random.default_rng(8)
    for primary, secondary in rng.normal(size=(30, 2, 6)) * [5, 5, 5, 1, 1, 1]:
        both, whole = one.allocate_by_priority(primary, secondary), other.allocate(primary + secondary)
        assert both.status == whole.status == Status.EXACT
        assert both.force.tobytes() == whole.force.tobytes()


def test_scaling_is_yielding_with_nothing_kept():
    scaled, yielding = Allocator(jack(), LIMITS, unattainable="scaled"), Allocator(jack(), LIMITS)
    for wrench in np.random.default_rng(4).normal(size=(30, 3)) * [60, 20, 15]:
        one, other = scaled.allocate(wrench), yielding.allocate_by_priority(np.zeros(3), wrench)
        if one.status == Status.CLOSEST:
            assert not other.force.any()
            continue
        assert np.allclose(one.force, other.force, atol=1e-9)
        assert {one.status: other.status} in ({Status.SCALED: Status.YIELDED}, {Status.EXACT: Status.EXACT})


@pytest.mark.parametrize(
    ("primary", "secondary", "made", "status"),
    [
        (10.0, 60.0, 50.0, Status.YIELDED),
        (3.0, 2.0, 5.0, Status.EXACT),
        (3.0, -1.0, 4.0, Status.CLOSEST),  # 2 to 3: not attainable anywhere
        (5.0, -2.0, 4.0, Status.YIELDED),  # 3 to 5: from 4 on
        (2.5, -6.0, 0.0, Status.YIELDED),  # -3.5 to 2.5: 0 alone
        (60.0, -20.0, 40.0, Status.EXACT),
        (60.0, 5.0, 50.0, Status.CLOSEST),
        (60.0, 0.0, 50.0, Status.CLOSEST),
        (1e300, -1e300, 0.0, Status.EXACT),
        (5.0, 1e305, 50.0, Status.YIELDED),
        (1e305, 5.0, 50.0, Status.CLOSEST),
    ],
)
def test_shares_have_gaps_and_the_largest_is_taken(primary, secondary, made, status):
    """One pair of thrusters pushes 4 to 50 N, or rests."""
    A = np.array([[1.0, 1.0], [0, 0], [0, 0]])
    answer = Allocator(A, [0, 0, 4, 25]).allocate_by_priority([primary, 0, 0], [secondary, 0, 0])
    assert answer.wrench[0] == pytest.approx(made)
    assert answer.status == status


def test_what_no_forces_can_make_is_left_out_of_both():
    A = np.array([[1.0, 1, 1, 1], [0, 0, 0, 0], [-1, 1, -1, 1]])
    allocator = Allocator(A, LIMITS)
    answer = allocator.allocate_by_priority([0, 7, 10.0], [200.0, 3, 0])
    share = largest_share(A, allocator.limits, True, np.array([0, 0, 10.0]), np.array([200.0, 0, 0]))
    assert answer.status == Status.YIELDED
    assert np.allclose(answer.wrench, [200.0 * share, 0, 10.0], atol=1e-6)


@pytest.mark.parametrize("part", [0, 1])
def test_a_part_that_is_no_number_makes_no_wrench(part):
    parts = [np.ones(6), np.ones(6)]
    parts[part] = np.array([np.nan, 0, 0, 0, 0, 0])
    answer = Allocator(BUILT, LIMITS).allocate_by_priority(*parts)
    assert answer.status == Status.INVALID_WRENCH
    assert not answer.force.any()


@pytest.mark.parametrize("parts", [(np.inf, -np.inf), (1e308, 1e308), (-1e308, -1e308)])
def test_parts_whose_sum_is_no_number_make_no_wrench(parts):
    """Without a warning, too."""
    answer = Allocator(jack(), LIMITS).allocate_by_priority(*(np.array([part, 0.0, 0.0]) for part in parts))
    assert (answer.status, answer.force.any()) == (Status.INVALID_WRENCH, False)


def test_a_part_too_large_to_be_taken_off_a_demand_makes_no_wrench():
    allocator = FaultTolerant(jack(), LIMITS, lambda A, limits, _: Allocator(A, limits))
    answer = allocator.allocate([-1.7e308, 0.0, 0.0], [1.7e308, 0.0, 0.0])
    assert (answer.status, answer.force.any()) == (Status.INVALID_WRENCH, False)


def test_a_part_of_the_wrong_size_is_named():
    with pytest.raises(AllocationError, match=r"shape \(3,\); A has 6 rows"):
        Allocator(BUILT, LIMITS).allocate_by_priority(np.zeros(6), np.zeros(3))
