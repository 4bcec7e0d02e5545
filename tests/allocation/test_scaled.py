"""The largest attainable part of a wrench in its own direction, against a linear programme on every subset."""

import itertools
from functools import partial

import numpy as np
import pytest
from support.allocation_reference import in_allowed_set, largest_share, least_cost, least_distance
from support.layouts import cube, jack

from cube_sim.allocation import Allocator, FaultTolerant, Health, Status
from cube_sim.errors import AllocationError
from cube_sim.wrench.facets import facet_normals

LIMITS = np.array([-20.0, -3.0, 4.0, 25.0])


def check_scaled(allocator, allow_off, wrench):
    """Whether the wrench had to be scaled; to what is compared."""
    answer = allocator.allocate(wrench)
    assert in_allowed_set(answer.force, allocator.limits, allow_off).all()
    if answer.status == Status.EXACT:
        return False
    scale = largest_share(allocator.A, allocator.limits, allow_off, 0.0 * wrench, wrench)
    assert answer.status == (Status.SCALED if scale else Status.CLOSEST)
    if not scale:
        distance = np.linalg.norm(allocator.wrench_weights * (answer.wrench - wrench))
        assert distance == pytest.approx(
            least_distance(allocator.A, allocator.limits, allow_off, wrench, allocator.wrench_weights),
            rel=1e-7, abs=1e-6,
        )  # fmt: skip
        return True
    assert scale < 1.0
    assert np.allclose(answer.wrench, scale * wrench, atol=1e-5)
    assert answer.cost == pytest.approx(
        least_cost(allocator.A, allocator.limits, allow_off, answer.wrench, tolerance=1e-6)[0], rel=1e-4, abs=1e-4
    )
    return True


@pytest.mark.flight
@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
def test_planar_vehicle_against_linear_programmes(allow_off):
    allocator = Allocator(jack(), LIMITS, allow_off=allow_off, unattainable="scaled")
    rng = np.random.default_rng(2)
    wrenches = [*rng.normal(size=(12, 3)) * [60, 20, 15], *rng.normal(size=(12, 3)) * [4, 2, 1]]
    wrenches += [s * v * row for row in np.eye(3) for s in (1, -1) for v in (1, 300)]
    assert sum(check_scaled(allocator, allow_off, wrench) for wrench in wrenches) > 10
    assert allocator.effort.unproven == 0
    assert allocator.effort.disagreements == 0


@pytest.mark.flight
def test_cube_against_linear_programmes_on_all_256_subsets():
    A = cube(direction_noise=0.05, position_noise_m=0.01, seed=4)
    allocator = Allocator(A, [-40, -10, 10, 50], allow_off=False, unattainable="scaled")
    wrenches = [*np.random.default_rng(7).normal(size=(2, 6)) * [90, 90, 90, 20, 20, 20], 300 * np.eye(6)[0]]
    assert sum(check_scaled(allocator, False, wrench) for wrench in wrenches) >= 2


def test_scales_have_gaps_and_the_largest_is_taken():
    """Two thrusters push 4 to 25 or 0: of 60 there is 50. Of 2 nothing is left, nor of 3.999: the closest is made."""
    A = np.array([[1.0, 1.0], [0, 0], [0, 0]])
    allocator = Allocator(A, [0, 0, 4, 25], unattainable="scaled")
    for demand, made in ((1.9, 0.0), (3.999, 4.0), (5.0, 5.0), (60.0, 50.0), (1e308, 50.0), (-5.0, 0.0)):
        answer = allocator.allocate([demand, 0, 0])
        assert answer.wrench[0] == pytest.approx(made)
        assert answer.status == {5.0: Status.EXACT, 60.0: Status.SCALED, 1e308: Status.SCALED}.get(
            demand, Status.CLOSEST
        )


def test_no_scale_at_all_makes_the_closest_wrench():
    """A thruster that may not rest pushes 4 to 25 or -20 to -3: no part of a demand of 2, nor none of it."""
    allocator = Allocator([[1.0], [0.0], [0.0]], LIMITS, allow_off=False, unattainable="scaled")
    for demand, made in ((2.0, 4.0), (-2.0, -3.0), (30.0, 25.0), (-30.0, -20.0), (0.0, -3.0)):
        answer = allocator.allocate([demand, 0, 0])
        assert answer.status == (Status.SCALED if abs(demand) == 30.0 else Status.CLOSEST)
        assert answer.force == pytest.approx([made])


def test_a_demand_that_stays_is_not_left_at_nothing():
    """Half a newton of torque lies in the gap of two thrusters, beside a force that they make easily: it is made."""
    A = np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]])
    answer = Allocator(A, LIMITS, unattainable="scaled").allocate([20.0, 0.0, 0.5])
    assert answer.status == Status.CLOSEST
    assert answer.wrench == pytest.approx([20.0, 0.0, 0.0])


def test_direction_is_kept_where_the_closest_wrench_turns():
    demand = np.array([150.0, 40.0, 0.0, 0.0, 0.0, 12.0])
    scaled = Allocator(cube(), LIMITS, unattainable="scaled").allocate(demand)
    closest = Allocator(cube(), LIMITS).allocate(demand)
    assert np.linalg.norm(np.outer(scaled.wrench, demand) - np.outer(demand, scaled.wrench)) < 1e-6
    assert np.linalg.norm(np.outer(closest.wrench, demand) - np.outer(demand, closest.wrench)) > 1.0


def test_what_no_forces_can_make_is_left_out_first():
    A = np.array([[1.0, 1, 1, 1], [0, 0, 0, 0], [-1, 1, -1, 1]])
    allocator = Allocator(A, LIMITS, unattainable="scaled")
    assert np.allclose(allocator.allocate([20, 7, 5]).wrench, [20, 0, 5])
    assert np.allclose(
        allocator.allocate([200, 7, 10]).wrench[[0, 2]],
        largest_share(A, allocator.limits, True, np.zeros(3), np.array([200, 0, 10.0])) * np.array([200, 10]),
    )


@pytest.mark.flight
def test_methods_faults_and_change_limits_scale_alike():
    A, rng = jack(), np.random.default_rng(5)
    for options in ({}, {"change_limit": 3.0}, {"objective": "reactivity_by_side", "reactivity": [-9.0, 9.0]}):

        def build(A, limits, _, method, options=options):
            return Allocator(A, limits, method=method, unattainable="scaled", **options)

        search, enumerate_ = (
            FaultTolerant(A, LIMITS, partial(build, method=method)) for method in ("search", "enumerate")
        )
        for allocator in (search, enumerate_):
            allocator.set_health(Health.whole(4).with_thruster(1, 0.5))
        for wrench in rng.normal(size=(6, 3)) * [60, 20, 15]:
            one, other = search.allocate(wrench), enumerate_.allocate(wrench)
            assert one.status == other.status
            assert np.allclose(one.wrench, other.wrench, atol=1e-4)


def test_unknown_choice_is_refused():
    with pytest.raises(AllocationError, match="unattainable"):
        Allocator(jack(), LIMITS, unattainable="shrink")


@pytest.mark.parametrize("unit", [1e-11, 1e9])
def test_the_share_does_not_depend_on_the_unit_of_the_wrench(unit):
    A = cube(direction_noise=0.05, position_noise_m=0.01, seed=4)
    wrench = np.array([150.0, -40.0, 60.0, 5.0, 0.0, 3.0])
    answers = [
        Allocator(u * A, [-40, -10, 10, 50], allow_off=False, unattainable="scaled").allocate(u * wrench)
        for u in (1.0, unit)
    ]
    assert answers[0].status == answers[1].status == Status.SCALED
    np.testing.assert_allclose(answers[1].wrench / unit, answers[0].wrench, atol=1e-6)


@pytest.mark.parametrize("columns", [jack(), cube(), cube()[:, 1:], np.random.default_rng(1).normal(size=(4, 9))])
def test_facets_are_perpendicular_to_every_set_of_columns_that_spans_one(columns):
    """One set after the other, by singular values; a repeated column or one of zeros adds none."""
    r = len(columns)
    expected = []
    for chosen in itertools.combinations(range(columns.shape[1]), r - 1):
        U, sigma, _ = np.linalg.svd(columns[:, chosen])
        if sigma[-1] > 1e-9 and not any(abs(abs(U[:, -1] @ known) - 1.0) < 1e-12 for known in expected):
            expected.append(U[:, -1])
    for given in (columns, np.column_stack([columns, 2.0 * columns[:, 0], np.zeros(r)]), 1e-12 * columns):
        normals = facet_normals(given)
        assert normals.shape == (len(expected), r)
        np.testing.assert_allclose(np.abs(normals @ np.array(expected).T).max(axis=0), 1.0, atol=1e-12)
