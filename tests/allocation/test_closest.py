"""Wrenches no allowed forces can make: the closest attainable one, and of its forces the cheapest."""

import numpy as np
import pytest
from support.allocation_reference import closest_forces, in_allowed_set, least_cost, least_distance
from support.layouts import bluerov2_heavy, cube, jack

from cube_sim.allocation import Allocator, Status
from cube_sim.allocation.exact import closest_wrench

LIMITS = np.array([-20.0, -3.0, 4.0, 25.0])


def check_closest(allocator, allow_off, wrench):
    answer = allocator.allocate(wrench)
    assert in_allowed_set(answer.force, allocator.limits, allow_off).all()
    if answer.status == Status.EXACT:
        return False
    distance = np.linalg.norm(allocator.wrench_weights * answer.wrench_error)
    assert distance == pytest.approx(
        least_distance(allocator.A, allocator.limits, allow_off, wrench, allocator.wrench_weights), rel=1e-7, abs=1e-6
    )
    cheapest = least_cost(allocator.A, allocator.limits, allow_off, answer.wrench)
    assert answer.cost == pytest.approx(cheapest[0], rel=1e-5, abs=1e-5)
    assert allocator.effort.unproven == 0
    return True


@pytest.mark.flight
@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
def test_planar_vehicle_against_bounded_least_squares_on_every_subset(allow_off):
    allocator = Allocator(jack(), LIMITS, allow_off=allow_off)
    rng = np.random.default_rng(1)
    wrenches = [*rng.normal(size=(25, 3)) * [30, 20, 8], *rng.normal(size=(25, 3)) * [4, 2, 1]]
    wrenches += [s * v * row for row in np.eye(3) for s in (1, -1) for v in (0.1, 1, 30, 200, 1e5)]
    assert sum(check_closest(allocator, allow_off, wrench) for wrench in wrenches) > 20


@pytest.mark.flight
@pytest.mark.parametrize("shape", [(3, 1), (3, 2), (3, 3), (6, 1), (6, 3), (6, 5)])
def test_vehicles_that_cannot_make_most_wrenches(shape):
    rng = np.random.default_rng(shape[0] * shape[1])
    allocator = Allocator(rng.normal(size=shape), LIMITS)
    assert sum(check_closest(allocator, True, 20 * rng.normal(size=shape[0])) for _ in range(8)) > 4


@pytest.mark.flight
def test_cube_against_bounded_least_squares_on_all_256_subsets():
    A = cube(direction_noise=0.05, position_noise_m=0.01, seed=4)
    allocator = Allocator(A, [-40, -10, 10, 50], allow_off=False)
    rng = np.random.default_rng(7)
    wrenches = [*rng.normal(size=(5, 6)) * [90, 90, 90, 20, 20, 20], 300 * np.eye(6)[0], -60 * np.eye(6)[4]]
    assert sum(check_closest(allocator, False, wrench) for wrench in wrenches) >= 3


@pytest.mark.parametrize(
    ("allow_off", "wrench"),
    [
        (True, [14.762395607368724, -29.856409641553377, 39.25982189043817, 10.34256368615195, -5.113843846678851,
                -10.400001685908734]),
        (True, [-22.671361181042435, -41.577349191552734, -10.392306179559816, -11.453590572461, 20.63819959761053,
                -4.399999630737488]),
        (True, [29.041458573611663, -7.433762038202131, -28.86751368814014, -24.74538173341955, -2.7397471095149455,
                9.199999695377276]),
        (False, [-54.196155948052244, 19.29016706573869, -10.392302776460879, -7.8535860404333135, 14.40281666841603,
                 -24.39999776840452]),
    ],
)  # fmt: skip
def test_on_the_border_of_a_subset_its_cheapest_forces_are_found(allow_off, wrench):
    """Thrusters with no freedom left stand a rounding off their dead zone; the others must still be at their best."""
    A = np.delete(cube(), np.random.default_rng(1).choice(8, 1, replace=False), axis=1)
    allocator = Allocator(
        A, [-40, -8, 10, 50], allow_off=allow_off, objective="reactivity_by_side", reactivity=[-32, 44]
    )
    allocator.allocate(wrench)
    assert allocator.effort.disagreements == 0


def test_attitude_first_by_default():
    """The default gives up force to keep torque; plain weights do not."""
    A = cube()
    demand = np.array([150.0, 150.0, 0.0, 0.0, 0.0, 12.0])
    careful, plain = Allocator(A, LIMITS), Allocator(A, LIMITS, wrench_weights=np.ones(6))
    torque_error = [np.linalg.norm(a.allocate(demand).wrench_error[3:]) for a in (careful, plain)]
    assert torque_error[0] < 0.5 < 10.0 < torque_error[1]


def test_residual_is_in_newton_by_the_stated_length():
    allocator = Allocator(cube(arm_m=0.2), LIMITS)
    assert allocator.length_m == pytest.approx(0.2 * np.sqrt(3))
    answer = allocator.allocate([0, 0, 0, 0, 0, 100.0])
    assert answer.status == Status.CLOSEST
    assert np.allclose(answer.wrench + answer.wrench_error, [0, 0, 0, 0, 0, 100.0])
    scaled = answer.wrench_error / np.repeat([1.0, 0.2 * np.sqrt(3)], 3)
    assert answer.residual == pytest.approx(np.linalg.norm(scaled))


def test_unreachable_rows_do_not_disturb_reachable_ones():
    """Pairs of fore-aft thrusters make surge and yaw; a sway demand on top changes nothing but the residual."""
    A = np.array([[1.0, 1, 1, 1], [0, 0, 0, 0], [-1, 1, -1, 1]])
    allocator = Allocator(A, LIMITS)
    without, with_sway = allocator.allocate([20, 0, 5]), allocator.allocate([20, 7, 5])
    assert without.status == Status.EXACT
    assert with_sway.status == Status.CLOSEST
    assert np.allclose(without.force, with_sway.force, atol=1e-6)
    assert with_sway.residual == pytest.approx(7.0)


@pytest.mark.flight
@pytest.mark.parametrize(("method", "calls"), [("search", 40), ("enumerate", 1)])
def test_of_many_equally_close_wrenches_the_cheapest_is_made(method, calls):
    """One thruster per axis that may not rest: up to 64 wrenches lie round a demand; reversals tell them apart."""
    limits, price = np.tile([-10.0, -2.0, 2.0, 10.0], (6, 1)), 100.0
    allocator = Allocator(np.eye(6), limits, allow_off=False, reversal_penalty=price, method=method)
    rng, most = np.random.default_rng(12), 0
    for call in range(calls):
        last = rng.choice([-5.0, 5.0], 6)
        allocator.allocate(last)
        wrench = np.where(rng.random(6) < 0.1 * (call % 4), rng.normal(size=6), 0.0)
        answer = allocator.allocate(wrench)
        forces, farther = closest_forces(np.eye(6), limits, False, wrench, allocator.wrench_weights)
        forces = forces[farther < 1e-9]
        cost = np.sum(forces**2, axis=1) + price * np.sum(forces * last < 0.0, axis=1)
        np.testing.assert_allclose(answer.force, forces[np.argmin(cost)], atol=1e-6)
        assert answer.cost == pytest.approx(cost.min())
        assert answer.status == Status.CLOSEST
        most = max(most, len(forces))
    assert most > 32


def test_of_many_equally_close_wrenches_ties_keep_the_previous_subset():
    allocator = Allocator(np.eye(6), [-10, -2, 2, 10], allow_off=False)
    for last in np.random.default_rng(13).choice([-5.0, 5.0], (40, 6)):
        allocator.allocate(last)
        np.testing.assert_allclose(allocator.allocate(np.zeros(6)).force, 0.4 * last)


def test_more_equally_close_wrenches_than_are_kept_are_no_proof(monkeypatch):
    allocator = Allocator(np.eye(6), [-10, -2, 2, 10], allow_off=False)
    t, metric = allocator._problem, allocator._closest.metric
    intervals, bounds = (
        closest_wrench.SideIntervals(t.low, t.high, t.masks, t.relaxed[0]),
        np.tile([-10.0, 10.0], (6, 1)),
    )
    for kept, proven in ((64, True), (63, False)):
        monkeypatch.setattr(closest_wrench, "CANDIDATES", kept)
        forces, closest, sure, _ = closest_wrench.closest_wrenches.py_func(
            np.zeros(6), metric, intervals, bounds, 1e-8, 1e-8
        )
        assert (len(forces), closest, sure) == (kept, kept, proven)


def test_what_can_be_made_is_made_to_rounding_beside_what_cannot():
    """A dead zone keeps the torque 120 away in the norm, beside which a force off by 1e-4 N shows as 1e-10 only."""
    allocator = Allocator(np.eye(3)[:, [0, 1, 1, 2]], [-40, -4, 5, 50], allow_off=False, method="search")
    for sway in np.linspace(-7.0, -6.0, 40):
        answer = allocator.allocate([0.0, sway, 0.0])
        assert answer.status == Status.CLOSEST
        np.testing.assert_allclose(answer.wrench, [-4.0, sway, -4.0], atol=1e-6)


@pytest.mark.flight
@pytest.mark.parametrize("size", [1e2, 1e4, 1e6, 1e8])
@pytest.mark.parametrize(
    ("A", "allow_off"),
    [
        (np.eye(3), True),
        (np.eye(3), False),
        (jack(), True),
        (jack(), False),
        (bluerov2_heavy()[:, [0, 1, 3, 4, 5, 6]], False),
        (cube(0.2, 0.05, 0.01, 4)[:, 2:], False),
    ],
    ids=["axes, off", "axes", "planar, off", "planar", "two planes", "as built"],
)
def test_beside_a_far_component_the_others_are_made_as_well_as_can_be(A, allow_off, size):
    """From all they can make, 34 N to 136 N, to a million times that, against bounded least squares on every subset."""
    n, m = A.shape
    limits = np.tile([-29.0, -3.0, 4.0, 34.0], (m, 1))
    allocator = Allocator(A, limits, allow_off=allow_off)
    rng = np.random.default_rng(3)
    for _ in range(4):
        wrench = rng.normal(size=n) * np.repeat([15.0, 2.0], [n - n // 2, n // 2])
        wrench[rng.integers(n)] = size
        answer = allocator.allocate(wrench)
        forces, farther = closest_forces(A, limits, allow_off, wrench, allocator.wrench_weights)
        closest = (forces @ A.T)[farther < 1e-8]
        assert np.abs(closest - answer.wrench).max(axis=1).min() < 1e-3
        assert answer.status == Status.CLOSEST


@pytest.mark.parametrize("method", ["search+proxqp", "enumerate"])
@pytest.mark.parametrize("size", [1e5, 1e9, 1e155, 1e300, 1.7e308])
def test_a_component_of_any_size_leaves_the_others_alone(size, method):
    allocator = Allocator(np.eye(3), [-10, -2, 2, 10], method=method)
    answer = allocator.allocate([size, 5, 4])
    np.testing.assert_allclose(answer.force, [10, 5, 4], atol=1e-6)
    assert answer.residual == pytest.approx(min(size, 1e300), abs=11)
    assert allocator.effort.disagreements == 0
    np.testing.assert_allclose(allocator.allocate([-3, size, 0.7 * size]).force, [-3, 10, 10], atol=1e-6)
    np.testing.assert_allclose(allocator.allocate_by_priority([size, 5, 4], [0, 0, 1]).force, [10, 5, 4], atol=1e-6)


@pytest.mark.parametrize("span", [1e4, 1e6])
@pytest.mark.parametrize("torques_first", [True, False])
def test_wrench_weights_as_different_as_is_allowed(span, torques_first):
    A, limits = cube(0.2, 0.05, 0.01, 4)[:, [0, 1, 2, 4, 5, 7]], np.tile([-29.0, -3.0, 4.0, 34.0], (6, 1))
    weights = np.repeat([1.0, span] if torques_first else [span, 1.0], 3)
    allocator = Allocator(A, limits, allow_off=False, wrench_weights=weights)
    for wrench in np.random.default_rng(5).normal(size=(4, 6)) * [90, 90, 90, 14, 14, 14]:
        answer = allocator.allocate(wrench)
        forces, farther = closest_forces(A, limits, False, wrench, weights)
        assert np.abs(forces @ A.T - answer.wrench).max(axis=1)[np.argmin(farther)] < 1e-6
        assert answer.status == Status.CLOSEST


def test_a_far_demand_whose_direction_is_bent_to_be_computed_is_not_called_proven():
    """A component beyond 1e7 times the largest wrench is shortened, a small one beside it kept."""
    allocator = Allocator(np.array([[1, 0, 0.02], [0, 1, 0], [0, 0.2, 1]]), [-40, -4, 4, 40], method="search")
    assert allocator.allocate([1e10, 0.0, -3e4]).status == Status.UNPROVEN_CLOSEST
    assert allocator.allocate([1e10, 0.0, 0.0]).status == Status.CLOSEST
    assert allocator.allocate([1e8, 0.0, -3e4]).status == Status.CLOSEST
