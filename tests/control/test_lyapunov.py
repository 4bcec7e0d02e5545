"""Lyapunov functions along whole trajectories, from many random initial states, for every law that has one.

The kinematic laws are integrated by themselves; the dynamic ones move the hull of the simulator, in which each row of
the equations of motion depends on every other.
"""

from __future__ import annotations

from math import pi

import mujoco
import numpy as np
import pytest
from support.planar_flight import GAINS, HULL, RECORD, SPEED, corrected, derivative, see, step
from support.swimmer import push, swimmer

from cube_sim.control.attitude_mode import DesiredAttitude
from cube_sim.control.loops import MotionLoops
from cube_sim.control.planar.dynamic import STILL, DesiredSpeed, kinematics
from cube_sim.control.planar.model import PlanarMotion
from cube_sim.guidance.approach import Approach
from cube_sim.guidance.arc import circle
from cube_sim.guidance.clocked_target import ClockedTarget
from cube_sim.guidance.helix import Helix
from cube_sim.guidance.point import Point
from cube_sim.guidance.pursuit import Pursuit
from cube_sim.guidance.sinusoid import sinusoid
from cube_sim.guidance.speed import ConstantSpeed, StoppingSpeed
from cube_sim.guidance.spline import spline
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.spatial import conjugate, multiply, quaternion_from_euler
from cube_sim.vehicle.state import read_state

PATHS = {
    "helix": Helix([0.0, 0.0, -8.0], 3.0, 3.0, 2.0),
    "circle": circle([0.0, 0.0, -5.0], 2.0),
    "spline": spline([[0, 0, 0], [4, 3, -2], [8, -2, 1], [9, 4, 3], [14, 5, 0]]),
}


@pytest.mark.parametrize("closing", [0.4, 0.9])
@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS.keys())
def test_path_following_in_3d(path, closing):
    """V = |e|^2 / 2 under s' = v_T + k2 s1 and the approach velocity: V' = -k2 s1^2 - c rho sin(theta), c >= u_d."""
    k2, u_d, psi_a, k_delta, dt = 0.5, 0.4, pi / 3.0, 0.5, 0.1
    law = Approach(ConstantSpeed(u_d), psi_a, k_delta * closing / u_d, None, closing).at_closing_speed(2.0)
    rng = np.random.default_rng(1)

    def rate(x):
        view = VirtualTarget(path, k2, arc_length=x[3]).view(x[:3], np.zeros(3))
        velocity = law.motion(view).velocity
        return np.append(velocity, VirtualTarget(path, k2, arc_length=x[3]).view(x[:3], velocity).speed)

    for _ in range(6):
        s = rng.uniform(0.0, 0.5) * path.length
        x = np.append(path.at(s).position + rng.normal(0.0, 4.0, 3), s)
        V, slope = [], []
        for _ in range(150):
            e = VirtualTarget(path, k2, arc_length=x[3]).view(x[:3], np.zeros(3)).error
            rho = np.hypot(e[1], e[2])
            V.append(0.5 * e @ e)
            slope.append(-k2 * e[0] ** 2 - closing * rho * np.sin(psi_a * np.tanh(k_delta * rho)))
            if not path.closed and not 0.0 < x[3] < path.length:
                break  # at an end the target stands
            x = step(rate, x, dt)
        assert len(V) > 20
        assert np.all(np.diff(V) < 0.0)
        np.testing.assert_allclose(np.diff(V), 0.5 * dt * np.add(slope[1:], slope[:-1]), atol=2e-3 * V[0], rtol=0.03)


def angle_state(path, q):
    """(e, e') of the planar dynamic law, e = psi - delta."""
    motion = PlanarMotion(*q[3:6])
    view = see(path, q[0], q[1], q[2] + motion.side_slip, q[6])
    k = kinematics(RECORD, HULL, motion, view, DesiredSpeed(SPEED), STILL)
    return k.error, k.dpsi - k.ddelta, view


PLANAR = {
    "circle": circle([0.0, 0.0, 0.0], 12.0),
    "sinusoid": sinusoid([0.0, 0.0, 0.0], 13.0, 60.0, 6.0),
    "spline": spline([[0, 0, 0], [30, 10, 0], [60, -15, 0], [75, 30, 0], [120, 40, 0], [190, 10, 0]]),
}


@pytest.mark.flight
@pytest.mark.parametrize("path", PLANAR.values(), ids=PLANAR.keys())
def test_the_planar_dynamic_law(path):
    """W = k5 e^2 / 2 + z^2 / 2 with z = e' + k1 e: W' = -k1 k5 e^2 - k3 z^2. Then the distance falls, too."""
    k1, _, k3, _, k5 = GAINS
    rng = np.random.default_rng(2)
    for _ in range(4):
        s = rng.uniform(0.1, 0.4) * path.length
        x, y, _ = path.at(s).position + np.array([*rng.normal(0.0, 15.0, 2), 0.0])
        T = path.at(s).rotation[:, 0]
        heading = np.arctan2(T[1], T[0]) + rng.uniform(-1.2, 1.2)
        q = np.array([x, y, heading, rng.uniform(0.8, 2.0), rng.normal(0.0, 0.2), rng.normal(0.0, 0.1), s])
        W, slope, V, rest = [], [], [], []
        for _ in range(1200):
            e, de, view = angle_state(path, q)
            z = de + k1 * e
            W.append(0.5 * k5 * e**2 + 0.5 * z**2)
            slope.append(-k1 * k5 * e**2 - k3 * z**2)
            V.append(0.5 * (view.s1**2 + view.y1**2))
            rest.append(abs(e) + abs(q[3] - SPEED))
            q = step(lambda q: derivative(corrected, path, q)[0], q, 0.02)
        assert np.all(np.diff(W) <= 1e-6 * W[0])  # a spline's curvature rate jumps at its points, inside a step
        np.testing.assert_allclose(np.diff(W), 0.01 * np.add(slope[1:], slope[:-1]), atol=2e-4 * W[0])
        settled = int(np.argmax(np.array(rest) < 1e-4))
        assert 0 < settled < 1100
        assert np.all(np.diff(V[settled:]) <= 1e-5 * np.sqrt(V[settled:-1]))


@pytest.fixture(scope="module")
def coupled():
    model, vehicle = swimmer()
    model.opt.timestep = 0.005
    return model, vehicle


TARGETS = {
    "tracking": (PATHS["helix"], ConstantSpeed(0.4)),
    "hover": (Point([1.0, 0.5, -7.0], 0.0), StoppingSpeed(ConstantSpeed(0.4), 0.0, 2.0)),
}


@pytest.mark.flight
@pytest.mark.parametrize(("path", "profile"), TARGETS.values(), ids=TARGETS.keys())
def test_the_tracking_loop_and_the_attitude_loop_of_the_hull(coupled, path, profile):
    """Two energies that fall at every step in MuJoCo, from any attitude and motion.

    Translation: with sigma = c tanh(|e| / (c T_e)) and v~ = v - v_d, the integral of sigma over |e| plus T_v |v~|^2 / 4
    falls by -sigma^2 + sigma e/|e| v~ - |v~|^2 / 2 < 0. Rotation: with w~ = w - w_ref, 2 (1 - eta) + T_a T_r |w~|^2 / 8
    falls by -2 |eps|^2 / T_a + eps w~ - T_a |w~|^2 / 4 < 0.
    """
    model, vehicle = coupled
    T_e, c, T_v, T_a, T_r = 2.0, 0.3, 1.0, 1.0, 0.3
    loops = MotionLoops(vehicle.dynamics, T_v, T_a, T_r)
    law = Pursuit(profile, T_e, c)
    rng = np.random.default_rng(3)
    for _ in range(3):
        data = mujoco.MjData(model)
        data.qpos[:3] = path.at(0.0).position + rng.normal(0.0, 1.5, 3)
        data.qpos[3:7] = quaternion_from_euler(*rng.uniform(-pi, pi, 3))
        data.qvel[:] = rng.normal(0.0, 0.5, 6)
        wanted = DesiredAttitude(quaternion_from_euler(*rng.uniform(-pi, pi, 3)), np.zeros(3))
        target = ClockedTarget(path, profile)
        translation, rotation = [], []
        for _ in range(4000):
            mujoco.mj_forward(model, data)
            state = read_state(vehicle, data)
            velocity = state.rotation @ state.velocity
            view = target.view(state.position, velocity)
            motion = law.motion(view)
            tau, reference = loops.wrench(state, motion, wanted, np.zeros(3))
            slip, turn = velocity - motion.velocity, state.rates - reference.rates
            x = np.linalg.norm(view.error) / (c * T_e)
            translation.append(c**2 * T_e * np.log(np.cosh(x)) + 0.25 * T_v * slip @ slip)
            eta = abs(multiply(conjugate(wanted.quaternion), state.quaternion)[0])
            rotation.append(2.0 * (1.0 - eta) + T_a * T_r / 8.0 * turn @ turn)
            push(data, state, tau)
            mujoco.mj_step(model, data)
            target.advance(view.speed, model.opt.timestep)
        for energy in (np.array(translation), np.array(rotation)):
            # the wrench is held over a step, which leaves it some 1e-5 m and rad to live on
            assert np.all(np.diff(energy) <= 1e-9 + 1e-4 * model.opt.timestep * energy[:-1])
            assert energy[-1] < 2e-3 * energy[0]
