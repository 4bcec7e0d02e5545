"""The loops against MuJoCo: the wrench they ask for makes the error obey the promised linear equations."""

import mujoco
import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.places import CUBE
from support.swimmer import accelerations, moving, push, swimmer

import cube_sim
from cube_sim.control.attitude_mode import DesiredAttitude
from cube_sim.control.disturbance import DisturbanceObserver
from cube_sim.control.loops import MotionLoops
from cube_sim.guidance.law import DesiredMotion
from cube_sim.spatial import State, quaternion_from_euler, rotation_from_quaternion
from cube_sim.vehicle.state import read_state

STILL_WATER = np.zeros(3)


@pytest.fixture(scope="module")
def coupled():
    return swimmer()


def body_acceleration(data, state, wrench):
    """nu' (6,) in body axes under a wrench, from MuJoCo's forward dynamics."""
    linear, angular = accelerations(data, state, wrench)
    return np.concatenate([state.rotation.T @ linear - np.cross(state.rates, state.velocity), angular])


def test_inverse_dynamics_undo_mujocos_forward_dynamics(coupled):
    model, vehicle = coupled
    rng = np.random.default_rng(5)
    for _ in range(50):
        data, state = moving(rng, model, vehicle)
        nu_dot = rng.normal(size=6)
        current = rng.normal(0.0, 0.3, 3)
        model.opt.wind[:] = current
        nu = np.concatenate([state.velocity, state.rates])
        tau = vehicle.dynamics.wrench(state.rotation, nu, nu_dot, current)
        np.testing.assert_allclose(body_acceleration(data, state, tau), nu_dot, atol=1e-9)
    model.opt.wind[:] = 0.0


def water_damping(vehicle, nu, flow):
    """D nu_r + D_q |nu_r| nu_r (6,) [N, N m] of the swimmer, whose coefficients are diagonal."""
    through = nu - np.append(flow, np.zeros(3))
    linear, quadratic = np.diag(vehicle.dynamics.linear_damping), np.diag(vehicle.dynamics.quadratic_damping)
    return linear * through + quadratic * np.abs(through) * through


def test_the_velocity_error_decays_with_its_time_constant_and_the_damping_of_the_error_helps(coupled):
    """M (nu' - nu'_promised) = D(nu_wanted - c) - D(nu - c): what the water damps of the error, on top of the gains."""
    model, vehicle = coupled
    rng = np.random.default_rng(6)
    loops = MotionLoops(vehicle.dynamics, velocity_time=1.3, attitude_time=1.0, rate_time=0.3)
    for _ in range(20):
        data, state = moving(rng, model, vehicle)
        motion = DesiredMotion(rng.normal(size=3), rng.normal(size=3))
        attitude = DesiredAttitude(quaternion_from_euler(*rng.uniform(-3.0, 3.0, 3)), np.zeros(3))
        current = rng.normal(0.0, 0.2, 3)
        tau, reference = loops.wrench(state, motion, attitude, current)
        nu = np.concatenate([state.velocity, state.rates])
        wanted = np.concatenate([reference.velocity, reference.rates])
        flow = state.rotation.T @ current
        helps = water_damping(vehicle, wanted, flow) - water_damping(vehicle, nu, flow)
        assert helps @ (nu - wanted) < 0.0  # it takes energy out of the error
        model.opt.wind[:] = current
        body_acceleration(data, state, tau - helps)
        model.opt.wind[:] = 0.0
        error = motion.velocity - state.rotation @ state.velocity
        np.testing.assert_allclose(data.qacc[:3], motion.acceleration + error / 1.3, atol=1e-9)


def test_the_attitude_is_reached_the_short_way_from_anywhere_and_q_equals_minus_q(coupled):
    model, vehicle = coupled
    loops = MotionLoops(vehicle.dynamics, velocity_time=1.0, attitude_time=1.0, rate_time=0.3)
    still = DesiredMotion(np.zeros(3), np.zeros(3))
    rng = np.random.default_rng(7)
    for _ in range(5):
        data, state = moving(rng, model, vehicle)
        data.qvel[:] = 0.0
        q = quaternion_from_euler(*rng.uniform(-3.0, 3.0, 3))
        wanted, twin = DesiredAttitude(q, np.zeros(3)), DesiredAttitude(-q, np.zeros(3))
        mujoco.mj_forward(model, data)
        state = read_state(vehicle, data)
        np.testing.assert_array_equal(
            loops.wrench(state, still, wanted, STILL_WATER)[0], loops.wrench(state, still, twin, STILL_WATER)[0]
        )
        angles = []
        for _ in range(1000):
            tau, reference = loops.wrench(state, still, wanted, STILL_WATER)
            angles.append(reference.attitude_error)
            push(data, state, tau)
            mujoco.mj_step(model, data)
            mujoco.mj_forward(model, data)
            state = read_state(vehicle, data)
        assert max(angles) <= angles[0] + 1e-6  # never further away than at the start: no unwinding
        assert angles[-1] < 1e-3


def test_turning_with_the_desired_rate_needs_no_error(coupled):
    model, vehicle = coupled
    loops = MotionLoops(vehicle.dynamics, velocity_time=1.0, attitude_time=1.0, rate_time=0.3)
    data, state = moving(np.random.default_rng(8), model, vehicle)
    w_W = state.rotation @ state.rates
    attitude = DesiredAttitude(state.quaternion, w_W)
    on_course = DesiredMotion(state.rotation @ state.velocity, np.zeros(3))
    tau, reference = loops.wrench(state, on_course, attitude, STILL_WATER)
    np.testing.assert_allclose(reference.rates, state.rates, atol=1e-12)
    acceleration = body_acceleration(data, state, tau)
    np.testing.assert_allclose(state.rotation @ acceleration[3:], 0.0, atol=1e-9)  # w_W is constant


def test_the_observer_is_a_first_order_filter_of_the_true_disturbance():
    model = cube_sim.load_model(CUBE)
    vehicle = cube_sim.Vehicle.from_model(model)
    data = mujoco.MjData(model)
    observer, dt, time = DisturbanceObserver(vehicle.dynamics, 0.8), 0.01, 0.8
    disturbance = np.array([8.0, -5.0, 3.0, 0.4, -0.3, 0.2])
    estimates = []
    for _ in range(400):
        mujoco.mj_forward(model, data)
        state = read_state(vehicle, data)
        estimates.append(observer.update(state, np.zeros(6), STILL_WATER, dt))
        push(data, state, disturbance)
        mujoco.mj_step(model, data)
    t = dt * np.arange(len(estimates))
    expected = np.outer(1.0 - np.exp(-t / time), disturbance)
    # the tick's own discretisation is the only difference: half a tick of lag, and drag over a tick
    np.testing.assert_allclose(np.array(estimates), expected, atol=0.02 * np.abs(disturbance).max())
    np.testing.assert_allclose(estimates[-1], disturbance, rtol=0.02)


def test_rotations_and_quaternions_agree():
    from cube_sim.spatial import quaternion_from_rotation

    rng = np.random.default_rng(9)
    for q in rng.normal(size=(200, 4)):
        unit = q / np.linalg.norm(q)
        R = rotation_from_quaternion(unit)
        back = quaternion_from_rotation(R)
        np.testing.assert_allclose(back, unit if unit[0] >= 0.0 else -unit, atol=1e-12)


def test_what_turns_a_hull_back_stiffly_stays_in_the_loop(tmp_path):
    """A torpedo with four fins: the righting moment in roll is left to the water, that in pitch is not."""
    (tmp_path / "hull.xml").write_text(catalogue()["torpedo_four_fins"].make())
    hull = cube_sim.Vehicle.from_model(cube_sim.load_model(str(tmp_path / "hull.xml"))).dynamics
    loops = MotionLoops(hull, velocity_time=0.5, attitude_time=1.5, rate_time=0.45)
    level = DesiredAttitude(quaternion_from_euler(0.0, 0.0, 0.0), np.zeros(3))
    still = DesiredMotion(np.zeros(3), np.zeros(3))
    for angles, own in (([0.1, 0.0, 0.0], 0.0), ([0.0, 0.1, 0.0], 1.0)):
        q = quaternion_from_euler(*angles)
        state = State(np.zeros(3), q, rotation_from_quaternion(q), np.zeros(3), np.zeros(3))
        tau, _ = loops.wrench(state, still, level, STILL_WATER)
        axis = 3 + int(np.argmax(angles))
        rates = -2.0 * np.sin(0.05) / 1.5 * np.eye(6)[axis]
        back = hull.total_mass[axis, axis] * rates[axis] / 0.45 + hull.damping(rates)[axis]
        righting = hull.righting_moment[2] * np.sin(0.1)
        assert tau[axis] == pytest.approx(back + own * righting, rel=1e-3)
