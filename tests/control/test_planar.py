"""The planar laws: their own differential equations, their convergence, and what the printed forms cost."""

from math import inf, pi

import numpy as np
import pytest
from support.planar_flight import (
    GAINS,
    HULL,
    LAW,
    SPEED,
    command,
    corrected,
    derivative,
    fly,
    printed,
    see,
    start,
    step,
    turned,
)

from cube_sim.control.planar.approach_angle import ApproachAngle
from cube_sim.control.planar.dynamic import DesiredSpeed
from cube_sim.control.planar.model import PlanarMotion, sway_acceleration
from cube_sim.control.planar.path_view import wrap
from cube_sim.guidance.arc import circle
from cube_sim.guidance.line import Line
from cube_sim.guidance.sinusoid import sinusoid
from cube_sim.guidance.spline import spline

PATHS = {
    "line": Line([0.0, 0.0, 0.0], [400.0, 0.0, 0.0]),
    "circle": circle([0.0, 0.0, 0.0], 12.0),
    "right-hand circle": circle([0.0, 0.0, 0.0], 12.0, clockwise=True),
    "sinusoid": sinusoid([0.0, 0.0, 0.0], 13.0, 60.0, 6.0),
    "varying curvature": spline([[0, 0, 0], [30, 10, 0], [60, -15, 0], [75, 30, 0], [120, 40, 0], [190, 10, 0]]),
}


@pytest.fixture(params=PATHS.values(), ids=PATHS.keys())
def path(request):
    return request.param


def error_of(path, q):
    """psi - delta, not wrapped across the run of a test."""
    motion = PlanarMotion(*q[3:6])
    view = see(path, q[0], q[1], q[2] + motion.side_slip, q[6])
    return view.psi - LAW.approach.at(view.y1).value, view


def kinematic_rate(path, q):
    """Of [x, y, psi_B, u, v, r, s] when the yaw rate is exactly the law's and surge is kept; r itself plays no part."""
    x, y, psi_B, u, v, _, s = q
    motion = PlanarMotion(u, v, 0.0)
    view = see(path, x, y, psi_B + motion.side_slip, s)
    r, ds = turned(motion, view)
    dv = sway_acceleration(HULL, PlanarMotion(u, v, r))
    return np.array([u * np.cos(psi_B) - v * np.sin(psi_B), u * np.sin(psi_B) + v * np.cos(psi_B), r, 0, dv, 0, ds])


def random_states(path, seed, n):
    """Up to far from the path, at any heading, at forward speed."""
    rng = np.random.default_rng(seed)
    for _ in range(n):
        s = rng.uniform(0.1, 0.8) * path.length
        x, y, _ = path.at(s).position + np.array([*rng.normal(0.0, 15.0, 2), 0.0])
        yield np.array([x, y, rng.uniform(-pi, pi), rng.uniform(0.5, 2.0), rng.normal(0, 0.3), rng.normal(0, 0.2), s])


def test_the_kinematic_law_lets_the_angle_error_decay_at_k1_whatever_the_state(path):
    """(psi - delta)' = -k1 (psi - delta), by finite differences along the motion: both loops must be solved for it."""
    h = 1e-5
    for q in random_states(path, 1, 60):
        rate = kinematic_rate(path, q)
        before, after = error_of(path, q - h * rate)[0], error_of(path, q + h * rate)[0]
        e = wrap(error_of(path, q)[0])
        assert wrap(after - before) / (2.0 * h) == pytest.approx(-GAINS.k1 * e, abs=2e-6)


@pytest.mark.flight
def test_lyapunov_functions_decrease_along_the_kinematic_law_from_everywhere(path):
    """V1 = (psi - delta)^2 / 2 at every step; V2 = (s1^2 + y1^2) / 2 from when the angle error has gone."""
    for q in random_states(path, 2, 6):
        V1, V2 = [], []
        for _ in range(300):
            e, view = error_of(path, q)
            V1.append(0.5 * wrap(e) ** 2)
            V2.append(0.5 * (view.s1**2 + view.y1**2))
            q = step(lambda q: kinematic_rate(path, q), q, 0.1)
        assert np.all(np.diff(V1) <= 1e-12)
        settled = int(np.argmax(np.array(V1) < 1e-7))
        assert 0 < settled < 250
        assert np.all(np.diff(V2[settled:]) <= 1e-3 * np.sqrt(np.array(V2[settled:-1])) * np.sqrt(1e-7))


def test_the_dynamic_law_makes_the_angle_error_a_damped_oscillator(path):
    """e'' + (k1 + k3) e' + (k5 + k1 k3) e = 0, by differences along the vehicle's own equations of motion."""
    k1, _, k3, _, k5 = GAINS
    h = 1e-3
    for q in random_states(path, 3, 25):
        if q[3] < LAW.least_speed:
            continue
        e0, e1, e2 = (error_of(path, step(lambda q: derivative(corrected, path, q)[0], q, t))[0] for t in (-h, 0.0, h))
        rate, bend = wrap(e2 - e0) / (2.0 * h), (wrap(e2 - e1) - wrap(e1 - e0)) / h**2
        assert bend + (k1 + k3) * rate + (k5 + k1 * k3) * wrap(e1) == pytest.approx(0.0, abs=2e-4)


@pytest.mark.flight
def test_it_converges_from_farther_than_the_smallest_radius_of_curvature(path):
    """The point of the 2007 result; s1, y1, psi and u - u_d all vanish."""
    tightest = min(1.0 / max(np.hypot(*path.at(s).curvature), 1e-9) for s in np.linspace(0.0, path.length, 2001))
    for left in (-20.0, 20.0):
        assert path is PATHS["line"] or abs(left) > tightest
        flight = fly(corrected, path, start(path, left, turn=2.0), 80.0)
        assert np.abs(flight[-100:, 1:5]).max() < 1e-4


def residual(law):
    """Largest |y1| [m] on the sinusoid once everything has settled; its smallest radius is 7 m."""
    flight = fly(law, PATHS["sinusoid"], start(PATHS["sinusoid"], 15.0), 90.0)
    return np.abs(flight[flight[:, 0] > 50.0, 2]).max()


def test_the_corrected_law_leaves_nothing():
    assert residual(corrected) < 1e-6


def test_the_printed_law_stays_most_of_a_metre_off_the_path():
    assert residual(printed()) == pytest.approx(0.80, rel=0.05)


@pytest.mark.flight
def test_each_printed_difference_costs_what_it_costs():
    """With the other two mended: subtracting the resistances, g_c s' for g_c s'^2, not solving for r' in beta''."""
    assert residual(printed(square=True, loop_solved=True)) == pytest.approx(0.28, rel=0.1)
    assert residual(printed(resistance=1.0, loop_solved=True)) == pytest.approx(0.039, rel=0.05)
    assert residual(printed(resistance=1.0, square=True)) == pytest.approx(0.081, rel=0.05)
    assert residual(printed(resistance=1.0, square=True, loop_solved=True)) < 1e-6


def test_nothing_is_singular_at_the_centre_of_curvature():
    """At 1 - c_c y1 = 0, where laws for the closest point of the path divide by zero."""
    ring = PATHS["circle"]
    centre = see(ring, 0.0, 0.0, 0.3, 5.0)
    assert 1.0 - centre.c_c * centre.y1 == pytest.approx(0.0, abs=1e-15)
    commands = [corrected(PlanarMotion(1.5, 0.0, 0.0), see(ring, x, 0.0, 0.3, 5.0)) for x in (-1e-6, 0.0, 1e-6)]
    assert np.all(np.isfinite(commands))
    np.testing.assert_allclose(commands[0], commands[2], rtol=1e-4, atol=1e-2)
    flight = fly(corrected, ring, [0.0, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0], 80.0)
    assert np.abs(flight[-50:, 1:5]).max() < 1e-4


def test_turned_away_from_the_path_it_takes_the_short_way_round():
    motion = PlanarMotion(SPEED, 0.0, 0.0)
    line = PATHS["line"]
    left, right = (corrected(motion, see(line, 10.0, 0.0, turn, 10.0)).Gamma for turn in (pi - 0.1, -pi + 0.1))
    assert left < 0.0 < right
    assert left == pytest.approx(-right)
    # many turns of the heading change nothing
    again = corrected(motion, see(line, 10.0, 0.0, pi - 0.1 + 20.0 * pi, 10.0)).Gamma
    assert again == pytest.approx(left, rel=1e-9)


@pytest.mark.flight
@pytest.mark.parametrize("u", [0.0, -0.5])
def test_it_starts_from_rest_and_from_going_astern(u):
    for v in (0.0, 0.2):
        q = start(PATHS["sinusoid"], 8.0, u=u)
        q[4] = v
        flight = fly(corrected, PATHS["sinusoid"], q, 90.0, dt=0.05)
        assert np.all(np.isfinite(flight))
        assert np.abs(flight[-50:, 1:5]).max() < 1e-3


def test_far_away_the_approach_angle_neither_overflows_nor_exceeds_psi_a():
    angle = ApproachAngle(pi / 4.0, 0.5)
    for y1 in (-1e6, -1e3, 1e3, 1e6):
        assert angle.at(y1) == (-np.sign(y1) * pi / 4.0, 0.0, 0.0)
    h = 1e-5
    for y1 in np.linspace(-6.0, 6.0, 41):
        low, here, high = angle.at(y1 - h), angle.at(y1), angle.at(y1 + h)
        assert (high.value - low.value) / (2.0 * h) == pytest.approx(here.slope, abs=1e-9)
        assert (high.slope - low.slope) / (2.0 * h) == pytest.approx(here.bend, abs=1e-9)


def test_the_target_keeps_to_its_speed_limit_and_the_vehicle_still_converges():
    limited = LAW._replace(target_speed_limit=2.0).record[0]

    def law(motion, view):
        asked = command(motion, view, DesiredSpeed(SPEED), law=limited)
        assert abs(asked.ds) <= 2.0
        return asked

    q = start(PATHS["sinusoid"], 20.0)
    q[6] = 60.0  # the target starts far ahead
    assert np.abs(fly(law, PATHS["sinusoid"], q, 110.0)[-50:, 1:5]).max() < 1e-4


def test_a_speed_that_changes_is_followed_without_lag():
    """u_d = 1.5 + 0.3 sin(t/5) with its derivatives: u - u_d vanishes, and so does y1 on a curved path."""
    ring, q, t = PATHS["circle"], np.array(start(PATHS["circle"], 15.0)), 0.0

    def wanted(t):
        return DesiredSpeed(1.5 + 0.3 * np.sin(t / 5.0), 0.06 * np.cos(t / 5.0), -0.012 * np.sin(t / 5.0))

    def rate(q):
        moment = q[7]
        inner, _ = derivative(lambda motion, view: command(motion, view, wanted(moment)), ring, q[:7])
        return np.append(inner, 1.0)

    q = np.append(q, t)
    for _ in range(900):
        q = step(rate, q, 0.1)
    _, view = error_of(ring, q)
    assert abs(q[3] - wanted(q[7]).value) < 1e-6
    assert abs(view.y1) < 1e-5


def test_without_a_limit_the_law_of_the_target_is_the_literatures():
    view = see(PATHS["line"], 7.0, 3.0, 0.4, 5.0)
    motion = PlanarMotion(1.2, 0.1, 0.0)
    assert LAW.target_speed_limit == inf
    assert corrected(motion, view).ds == pytest.approx(motion.speed * np.cos(0.4) + GAINS.k2 * 2.0)
