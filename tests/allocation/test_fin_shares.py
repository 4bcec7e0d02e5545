"""What fins are asked for: the nearest point of a box, and shares between fins and thrusters."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from support import plain_callbacks
from support.lifting import Fin
from support.water_bodies import DENSITY

from cube_sim.allocation.box_least_squares import nearest_in_box
from cube_sim.allocation.fin_shares import FinParts, share_with_fins, steer_fins
from cube_sim.vehicle.laws.fin import fin_wrench

X, Y, Z = np.eye(3)
AHEAD = (1.5, 0.0, 0.0, 0.0, 0.0, 0.0)
TRAVEL = 0.4


def row(fin: Fin) -> np.ndarray:
    induced = 1.0 / (np.pi * fin.drag[1] * fin.aspect)
    stall = np.inf if fin.stall is None else fin.stall
    numbers = 0.5 * DENSITY * fin.area, fin.slope, stall, fin.drag[0], induced, -1.0
    return np.array([0.0, *fin.place, *fin.chord, *fin.normal, *numbers])


def parts(fins, thrusters, forces, reach=10.0, stalls=False) -> FinParts:
    A = np.array(thrusters, dtype=float).reshape(-1, 6).T.copy()
    scale = np.array([1.0] * 3 + [1.0 / 0.5] * 3)
    moving = scale[:, None] * A
    beyond = np.eye(6) - moving @ np.linalg.pinv(moving)
    k = len(fins)
    table = np.array([row(fin) for fin in fins]).reshape(k, 16)
    travel = np.tile([-TRAVEL, TRAVEL], (k, 1))
    limits = np.array(forces, dtype=float).reshape(-1, 2)
    none = np.zeros((0, 6))
    return FinParts(table, none, none, travel, np.full(k, reach), A, limits, beyond, scale, stalls)


def shared(given, demand, nu_r=AHEAD, deflections=None, ratio=1.0, law=share_with_fins):
    k = len(given.table)
    at = np.zeros(k) if deflections is None else np.array(deflections, dtype=float)
    wanted, made, rest = np.empty(k), np.empty(6), np.empty(6)
    missed = law(given, np.array(demand, dtype=float), nu_r, at, ratio, wanted, made, rest)
    left = given.scale * (np.array(demand, dtype=float) - made - rest)  # no thruster makes that
    np.testing.assert_allclose(left @ (given.scale[:, None] * given.thrusters), 0.0, atol=1e-9)
    assert missed == 0.0 or missed == pytest.approx(float(np.linalg.norm(left)))
    assert missed > 0.0 or np.linalg.norm(left) <= 1.001e-3 * np.linalg.norm(given.scale * demand)
    return wanted, made, rest


def rudder(stall=None) -> Fin:
    return Fin("rudder", np.array([-0.6, 0.0, 0.0]), X, Y, 0.01, 3.0, stall=stall)


PROPELLER = [1.0, 0.0, 0.0, -0.14, 0.0, 0.0]
SIDE_THRUSTER = [0.0, 1.0, 0.0, 0.0, 0.0, -0.6]


@pytest.mark.parametrize("seed", range(40))
def test_the_nearest_point_of_a_box_is_scipys(seed):
    rng = np.random.default_rng(seed)
    p = int(rng.integers(1, 9))
    C, target = rng.normal(size=(6, p)) * 10.0 ** rng.uniform(-2, 2, p), 10.0 * rng.normal(size=6)
    price, low = 10.0 ** rng.uniform(-6, 0, p), -rng.uniform(0, 2, p)
    high = low + rng.uniform(0, 3, p) * (rng.random(p) < 0.8)
    x = rng.normal(size=p)
    nearest_in_box(C, target, price, low, high, x)
    assert np.all((x >= low) & (x <= high))
    open_ended = np.maximum(high, low + 1e-12)
    stacked, wanted = np.vstack([C, np.diag(np.sqrt(price))]), np.concatenate([target, np.zeros(p)])
    best = lsq_linear(stacked, wanted, (low, open_ended), method="bvls", tol=1e-14)
    cost = np.sum((stacked @ x - wanted) ** 2)
    assert cost <= 2.0 * best.cost * (1.0 + 1e-9) + 1e-9


def test_a_fin_makes_what_it_can_and_leaves_the_rest():
    given = parts([rudder()], [PROPELLER], [[-2.0, 4.0]])
    full = np.array(fin_wrench(given.table[0], 0.1, AHEAD))
    wanted, made, rest = shared(given, full + 2.0 * np.array(PROPELLER))
    assert wanted[0] == pytest.approx(0.1, rel=1e-6)
    np.testing.assert_allclose(made, full, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(rest, 2.0 * np.array(PROPELLER), atol=1e-9)
    wanted, made, rest = shared(given, 10.0 * full)
    assert wanted[0] == TRAVEL
    np.testing.assert_allclose(made, TRAVEL / 0.1 * full, rtol=1e-9)
    np.testing.assert_allclose(rest, 0.0, atol=1e-9)


def test_what_nobody_makes_is_missed_and_not_asked_of_the_propeller():
    """A torque that is missed counts by the fins' arm: by the propeller's, of 0.14 m, it would outweigh its force."""
    given = parts([rudder()], [PROPELLER], [[-2.0, 4.0]])
    _, _, rest = shared(given, [2.0, 0.0, 0.0, 0.3, 0.0, 0.0])
    assert rest[0] == pytest.approx(2.0 * (1.0 - 0.14 * 0.3 / 0.5) / (1.0 + (0.14 / 0.5) ** 2), rel=0.1)


def test_fins_come_before_thrusters_that_could_do_it_too():
    given = parts([rudder()], [PROPELLER, SIDE_THRUSTER], [[-2.0, 4.0], [-50.0, 50.0]])
    full = np.array(fin_wrench(given.table[0], 0.1, AHEAD))
    wanted, _, rest = shared(given, full)
    assert wanted[0] == pytest.approx(0.1, rel=0.02)
    assert np.linalg.norm(rest) < 0.02 * np.linalg.norm(full)
    wanted, _, rest = shared(given, 10.0 * full)
    assert wanted[0] == TRAVEL
    np.testing.assert_allclose(rest, 6.0 * full, rtol=1e-9)


def test_at_rest_fins_are_asked_for_nothing():
    given = parts([rudder(0.3)], [PROPELLER], [[-2.0, 4.0]])
    wanted, made, rest = shared(given, [0.0, 3.0, 0.0, 0.0, 0.0, -2.0], nu_r=(0.0,) * 6)
    assert wanted[0] == 0.0
    assert not made.any()
    assert not rest.any()


@pytest.mark.parametrize("at", [0.3, -0.3])
def test_near_rest_a_fin_is_turned_back_and_the_thruster_makes_it(at):
    """At 0.02 m/s all its travel makes 2.5 mN; it turns back no faster than its servo does."""
    given = parts([rudder()], [PROPELLER, SIDE_THRUSTER], [[-20, 40], [-20, 20]], reach=0.1)
    slow, demand = (0.02, 0.0, 0.0, 0.0, 0.0, 0.0), [0.0, 3.0, 0.0, 0.0, 0.0, -1.8]
    wanted, made, _ = shared(given, demand, slow, [at])
    assert wanted[0] == pytest.approx(at - np.copysign(0.1, at))
    wanted, made, rest = shared(given, demand, slow, [0.0])
    assert abs(wanted[0]) < 0.01
    across = parts([rudder(stall=0.3)], [PROPELLER, SIDE_THRUSTER], [[-20, 40], [-20, 20]], reach=0.1)
    assert abs(shared(across, demand, (0.001, 0.02, 0.0, 0.0, 0.0, 0.0))[0][0]) < 0.01  # not turned into the flow
    np.testing.assert_allclose(made + rest, demand, atol=1e-9)


def test_a_fin_is_asked_no_farther_than_its_servo_turns_it():
    given = parts([rudder()], [PROPELLER], [[-2.0, 4.0]], reach=0.06)
    wanted, _, _ = shared(given, [0.0, 100.0, 0.0, 0.0, 0.0, -60.0], deflections=[0.1])
    assert wanted[0] == pytest.approx(0.16)
    wanted, _, _ = shared(given, [0.0, 100.0, 0.0, 0.0, 0.0, -60.0], deflections=[0.38])
    assert wanted[0] == TRAVEL


def test_a_fin_is_not_asked_to_stall():
    """The flow comes 0.2 rad aslant: a deflection counts from there."""
    given = parts([rudder(0.25)], [PROPELLER], [[-2.0, 4.0]])
    nu_r = (1.5, 1.5 * np.tan(0.2), 0.0, 0.0, 0.0, 0.0)
    for push, end in ((-100.0, 0.2 - 0.19), (100.0, 0.2 + 0.19)):
        wanted, _, _ = shared(given, [0.0, push, 0.0, 0.0, 0.0, -0.6 * push], nu_r)
        assert wanted[0] == pytest.approx(end, abs=1e-9)


def test_the_curve_of_a_fin_that_stalls_is_followed():
    given = parts([rudder(0.4)], [PROPELLER], [[-20.0, 20.0]])
    asked = np.array(fin_wrench(given.table[0], 0.2, AHEAD)) - fin_wrench(given.table[0], 0.0, AHEAD)
    wanted, made, rest = shared(given, asked + np.array(PROPELLER) * 3.0, deflections=[-0.1])
    assert wanted[0] == pytest.approx(0.2, abs=2e-3)
    # What is missed beyond the propeller's reach counts as made: no thruster makes it up.
    assert np.linalg.matrix_rank(np.column_stack([rest, PROPELLER]), tol=1e-9) == 1
    assert np.linalg.norm(made - asked) < 0.02 * np.linalg.norm(asked)


def test_four_fins_at_45_degrees_make_roll_too():
    """An X-tail; the propeller's roll is taken off by the fins."""
    fins = []
    for angle in (45.0, 135.0, 225.0, 315.0):
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        span, normal = np.array([0.0, c, s]), np.array([0.0, -s, c])
        fins.append(Fin(f"x{angle:g}", np.array([-0.6, 0.0, 0.0]) + 0.1 * span, X, normal, 0.005, 3.0))
    given = parts(fins, [PROPELLER], [[-4.0, 8.0]])
    for asked in ([3.0, 1.0, 0.0, 0.0, 0.0, -0.6], [3.0, 0.0, 1.0, 0.1, 0.6, 0.0]):
        wanted, made, rest = shared(given, asked)
        assert np.abs(wanted).max() < TRAVEL
        np.testing.assert_allclose(rest, 3.0 * np.array(PROPELLER), atol=1e-5)
        np.testing.assert_allclose(made + rest, asked, atol=1e-5)


def test_uncompiled_and_in_a_current_it_is_the_same():
    given = parts([rudder(0.3), rudder()], [PROPELLER, SIDE_THRUSTER], [[-2.0, 4.0], [-1.0, 1.0]])
    plain = plain_callbacks.plain("cube_sim.allocation.fin_shares")
    demand, R = np.array([1.0, 9.0, 0.5, 0.1, 0.2, -4.0]), np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    current, velocity, rates = np.array([0.2, -0.1, 0.05]), np.array([1.4, 0.1, 0.0]), np.array([0.0, 0.1, -0.1])
    at = np.array([0.02, -0.05])
    nu_r = (*(velocity - R.T @ current).tolist(), *rates.tolist())
    expected = shared(given, demand, nu_r, at)
    for law in (steer_fins, plain.steer_fins):
        found = np.empty(2), np.empty(6), np.empty(6)
        law(given, demand, np.ascontiguousarray(R), velocity, rates, current, at, 1.0, *found)
        for a, b in zip(found, expected, strict=True):
            np.testing.assert_allclose(a, b, atol=1e-9)
