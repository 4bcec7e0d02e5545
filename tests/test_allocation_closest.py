"""Wrenches no allowed forces can make: the closest attainable one, and of its forces the cheapest."""

import numpy as np
import pytest
from allocation_reference import cube, in_allowed_set, jack, least_cost, least_distance

from cube_sim.allocation import Allocator, Status

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


@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
def test_planar_vehicle_against_bounded_least_squares_on_every_subset(allow_off):
    allocator = Allocator(jack(), LIMITS, allow_off=allow_off)
    rng = np.random.default_rng(1)
    wrenches = [*rng.normal(size=(25, 3)) * [30, 20, 8], *rng.normal(size=(25, 3)) * [4, 2, 1]]
    wrenches += [s * v * row for row in np.eye(3) for s in (1, -1) for v in (0.1, 1, 30, 200, 1e5)]
    assert sum(check_closest(allocator, allow_off, wrench) for wrench in wrenches) > 20


@pytest.mark.parametrize("shape", [(3, 1), (3, 2), (3, 3), (6, 1), (6, 3), (6, 5)])
def test_vehicles_that_cannot_make_most_wrenches(shape):
    rng = np.random.default_rng(shape[0] * shape[1])
    allocator = Allocator(rng.normal(size=shape), LIMITS)
    assert sum(check_closest(allocator, True, 20 * rng.normal(size=shape[0])) for _ in range(8)) > 4


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
    """Motors with no freedom left stand a rounding off their dead zone; the others must still be at their best."""
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
    """Pairs of fore-aft motors make surge and yaw; a sway demand on top changes nothing but the residual."""
    A = np.array([[1.0, 1, 1, 1], [0, 0, 0, 0], [-1, 1, -1, 1]])
    allocator = Allocator(A, LIMITS)
    without, with_sway = allocator.allocate([20, 0, 5]), allocator.allocate([20, 7, 5])
    assert without.status == Status.EXACT
    assert with_sway.status == Status.CLOSEST
    assert np.allclose(without.force, with_sway.force, atol=1e-6)
    assert with_sway.residual == pytest.approx(7.0)
