"""The planar laws in water that moves: the same differential equations over ground, known current or none told."""

from math import pi

import numpy as np
import pytest
from support.planar_flight import (
    GAINS,
    INFANTE,
    LAW,
    SPEED,
    acceleration,
    command,
    corrected,
    derivative,
    flow_of,
    fly,
    in_body,
    see,
    start,
    step,
    turned,
)

from cube_sim.control.planar.dynamic import DesiredSpeed, Water
from cube_sim.control.planar.model import PlanarCurrent, PlanarMotion, through
from cube_sim.control.planar.path_view import wrap
from cube_sim.guidance.arc import circle
from cube_sim.guidance.line import Line
from cube_sim.guidance.sinusoid import sinusoid

PATHS = {
    "line": Line([0.0, 0.0, 0.0], [400.0, 0.0, 0.0]),
    "circle": circle([0.0, 0.0, 0.0], 12.0),
    "sinusoid": sinusoid([0.0, 0.0, 0.0], 13.0, 60.0, 6.0),
}
ACROSS = (0.1, 0.3)


@pytest.fixture(params=PATHS.values(), ids=PATHS.keys())
def path(request):
    return request.param


def error_of(path, q):
    """psi - delta of the course over ground."""
    view = see(path, q[0], q[1], q[2] + PlanarMotion(*q[3:6]).side_slip, q[6])
    return wrap(view.psi - LAW.approach.at(view.y1).value)


def random_states(path, seed, n):
    """Up to far from the path at any heading, ahead over ground and through the water, in a current of each its own."""
    rng = np.random.default_rng(seed)
    for _ in range(n):
        s = rng.uniform(0.1, 0.8) * path.length
        x, y, _ = path.at(s).position + np.array([*rng.normal(0.0, 15.0, 2), 0.0])
        q = np.array([x, y, rng.uniform(-pi, pi), rng.uniform(0.7, 2.0), rng.normal(0, 0.3), rng.normal(0, 0.2), s])
        yield q, rng.uniform(-0.4, 0.4, 2)


def test_the_dynamic_law_makes_the_angle_of_the_course_a_damped_oscillator_in_any_current(path):
    """e'' + (k1 + k3) e' + (k5 + k1 k3) e = 0, by differences along the equations of motion in the current."""
    k1, _, k3, _, k5 = GAINS
    h = 1e-3
    for q, current in random_states(path, 3, 25):
        e0, e1, e2 = (
            error_of(path, step(lambda q: derivative(corrected, path, q, current)[0], q, t))  # noqa: B023
            for t in (-h, 0.0, h)
        )
        rate, bend = wrap(e2 - e0) / (2.0 * h), (wrap(e2 - e1) - wrap(e1 - e0)) / h**2
        assert bend + (k1 + k3) * rate + (k5 + k1 * k3) * e1 == pytest.approx(0.0, abs=2e-4)


def test_surge_over_ground_decays_to_the_speed_wanted_at_k4(path):
    for q, current in random_states(path, 5, 25):
        rate, _ = derivative(corrected, path, q, current)
        assert rate[3] == pytest.approx(-GAINS.k4 * (q[3] - SPEED), abs=1e-12)


def test_the_kinematic_law_lets_the_angle_of_the_course_decay_at_k1(path):
    """(psi - delta)' = -k1 (psi - delta) for a hull that turns as it says, at a surge over ground that is kept."""

    def rate(q, current):
        x, y, psi_B, u, v, _, s = q
        motion, flow = PlanarMotion(u, v, 0.0), in_body(current, psi_B)
        r, ds = turned(motion, see(path, x, y, psi_B + motion.side_slip, s), flow)
        dv = acceleration(PlanarMotion(u, v, r), flow, 0.0, 0.0)[1]
        return np.array([u * np.cos(psi_B) - v * np.sin(psi_B), u * np.sin(psi_B) + v * np.cos(psi_B), r, 0, dv, 0, ds])

    h = 1e-5
    for q, current in random_states(path, 1, 40):
        slope = rate(q, current)
        change = wrap(error_of(path, q + h * slope) - error_of(path, q - h * slope)) / (2.0 * h)
        assert change == pytest.approx(-GAINS.k1 * error_of(path, q), abs=2e-6)


@pytest.mark.flight
def test_told_the_current_it_converges_to_nothing_from_farther_than_the_radius_of_curvature(path):
    flight = fly(corrected, path, start(path, 20.0, turn=2.0), 90.0, current=ACROSS)
    assert np.abs(flight[-100:, 1:5]).max() < 1e-4


@pytest.mark.flight
def test_not_told_the_law_of_still_water_stands_off_the_path(path):
    flight = fly(lambda motion, view, _: corrected(motion, view), path, start(path, 5.0), 90.0, current=ACROSS)
    assert np.abs(flight[-100:, 2]).max() > 0.1


def test_on_a_line_the_hull_meets_the_water_head_on_and_crabs_over_ground():
    q = np.array(start(PATHS["line"], 0.0))
    for _ in range(900):
        q = step(lambda q: derivative(corrected, PATHS["line"], q, (0.0, 0.3))[0], q, 0.1)
    flow = in_body((0.0, 0.3), q[2])
    assert q[4] - flow.v == pytest.approx(0.0, abs=1e-6)  # no flow from the side
    assert q[2] == pytest.approx(-np.arcsin(0.3 / (q[3] - flow.u)), abs=1e-6)


def test_how_much_of_a_yaw_rate_turns_the_course_is_positive_while_the_hull_moves_ahead():
    rng = np.random.default_rng(8)
    ratio = INFANTE.m_ur / INFANTE.m_v
    for _ in range(200):
        u, u_r, v = rng.uniform(0.05, 2.0), rng.uniform(0.05, 2.0), rng.normal()
        gain = INFANTE.loop_gain(PlanarMotion(u, v, 0.0), PlanarCurrent(u - u_r, rng.normal()))
        assert gain == pytest.approx((v * v + (1.0 - ratio) * u * u_r) / (u * u + v * v), rel=1e-12)
        assert gain > 0.0


def test_in_still_water_nothing_is_changed_by_a_bit():
    rng = np.random.default_rng(4)
    for q, _ in random_states(PATHS["sinusoid"], 6, 50):
        motion, view = PlanarMotion(*q[3:6]), see(PATHS["sinusoid"], q[0], q[1], rng.uniform(-pi, pi), q[6])
        assert command(motion, view, DesiredSpeed(SPEED)) == command(motion, view, DesiredSpeed(SPEED), Water())
        u, v, r = motion
        assert flow_of(motion, PlanarCurrent(0.0, 0.0)) == motion
        assert INFANTE.loop_gain(motion) == 1.0 - INFANTE.m_ur / INFANTE.m_v * np.cos(np.arctan2(v, u)) ** 2
        assert through(motion, PlanarCurrent(0.0, 0.0)) == (u, v, r)


def test_what_the_model_does_not_explain_is_taken_off_what_is_asked():
    motion, view = PlanarMotion(1.4, -0.2, 0.1), see(PATHS["circle"], 11.0, 3.0, 1.8, 5.0)
    plain = corrected(motion, view)
    ahead, turned = corrected(motion, view, Water(du=0.02)), corrected(motion, view, Water(dr=0.01))
    assert (plain.F - ahead.F, plain.Gamma - ahead.Gamma) == pytest.approx((0.02 * INFANTE.m_u, 0.0))
    assert (plain.F - turned.F, plain.Gamma - turned.Gamma) == pytest.approx((0.0, 0.01 * INFANTE.m_r))
