"""The compiled model against Fossen's equations integrated by other means, with every coupling there can be."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from support.water_bodies import flown, fossen, get_state, random_body, reference, set_state, tumbling


@pytest.mark.flight
@pytest.mark.parametrize(("seed", "ratio"), [(0, 0.5), (1, 1.5), (2, 5.8), (3, 3.0)])
def test_tumbling_body_follows_the_reference(seed, ratio):
    rng = np.random.default_rng(seed)
    body, start = random_body(rng, ratio), tumbling(rng)
    assert np.linalg.eigvals(np.linalg.solve(body.rigid, body.added)).real.max() == pytest.approx(ratio)
    expected = reference(body, start, 3.0)
    assert np.abs(expected[:3] - start[:3]).max() > 0.1  # it went somewhere
    error = np.abs(flown(body.model(timestep=0.005), start, 3.0) - expected)
    assert error[:3].max() < 1e-7
    assert error.max() < 1e-6


@pytest.mark.parametrize(("integrator", "order"), [("RK4", 4), ("Euler", 1), ("implicitfast", 1), ("implicit", 1)])
def test_order_of_convergence(integrator, order):
    """Without quadratic drag: |x| x has no third derivative at 0, which costs RK4 an order when x crosses it."""
    rng = np.random.default_rng(7)
    body, start = replace(random_body(rng, 3.0), quadratic=np.zeros((6, 6))), tumbling(rng)
    expected = reference(body, start, 1.0)
    steps = [0.02, 0.01, 0.005, 0.0025]
    errors = np.array([np.abs(flown(body.model(integrator, h), start, 1.0) - expected).max() for h in steps])
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all(np.abs(orders - order) < 0.35), orders


@pytest.mark.parametrize("seed", range(20))
def test_acceleration_is_fossens_to_rounding(seed):
    """One evaluation, no integration: also with a wrench applied."""
    rng = np.random.default_rng(100 + seed)
    body, state = random_body(rng, rng.uniform(0.1, 6.0)), tumbling(rng)
    wrench = rng.normal(size=6) * 5.0
    model = body.model()
    data = mujoco.MjData(model)
    set_state(data, state)
    mujoco.mj_kinematics(model, data)
    R = data.xmat[1].reshape(3, 3)
    data.qfrc_applied[:6] = np.concatenate([R @ wrench[:3], wrench[3:]])
    mujoco.mj_forward(model, data)
    w, v = state[10:], state[7:10]
    nu_dot = np.concatenate([R.T @ data.qacc[:3] - np.cross(w, v), data.qacc[3:6]])
    expected = fossen(body, state, wrench)[7:]
    np.testing.assert_allclose(nu_dot, expected, atol=1e-11 * max(1.0, np.abs(expected).max()))


def test_mujoco_sees_the_whole_inertia():
    """Full M, inverse dynamics and kinetic energy all hold M_RB + M_A."""
    rng = np.random.default_rng(5)
    body, state = random_body(rng, 4.0), tumbling(rng)
    model = body.model()
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    set_state(data, state)
    mujoco.mj_forward(model, data)
    full = np.zeros((6, 6))
    mujoco.mju_sym2dense(full, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    R = data.xmat[1].reshape(3, 3)
    B = np.block([[R.T, np.zeros((3, 3))], [np.zeros((3, 3)), np.eye(3)]])
    np.testing.assert_allclose(full, B.T @ (body.rigid + body.added) @ B, atol=1e-11)
    nu = get_state(data)[7:]
    assert data.energy[1] == pytest.approx(0.5 * nu @ (body.rigid + body.added) @ nu, rel=1e-12)


def test_inverse_dynamics_returns_the_applied_force():
    rng = np.random.default_rng(6)
    body, state = random_body(rng, 4.0), tumbling(rng)
    model = body.model()
    data = mujoco.MjData(model)
    set_state(data, state)
    data.qfrc_applied[:] = applied = rng.normal(size=6) * 3.0
    mujoco.mj_forward(model, data)
    mujoco.mj_inverse(model, data)
    np.testing.assert_allclose(data.qfrc_inverse, applied, atol=1e-10)


def test_transition_matrix_is_that_of_the_reference():
    """mjd_transitionFD reruns parts of the pipeline; A must be the derivative of the flow over one step."""
    rng = np.random.default_rng(8)
    body, state = random_body(rng, 3.0), tumbling(rng)
    model = body.model("Euler", 0.002)
    data = mujoco.MjData(model)
    set_state(data, state)
    A = np.zeros((12, 12))
    mujoco.mjd_transitionFD(model, data, 1e-6, True, A, None, None, None)
    literal = np.zeros((12, 12))
    for column in range(12):
        ends = []
        for sign in (1.0, -1.0):
            other = mujoco.MjData(model)
            set_state(other, state)
            if column < 6:
                step = np.zeros(6)
                step[column] = sign * 1e-6
                mujoco.mj_integratePos(model, other.qpos, step, 1.0)
            else:
                other.qvel[column - 6] += sign * 1e-6
            mujoco.mj_step(model, other)
            ends.append(other)
        difference = np.zeros(6)
        mujoco.mj_differentiatePos(model, difference, 2e-6, ends[1].qpos, ends[0].qpos)
        literal[:, column] = np.concatenate([difference, (ends[0].qvel - ends[1].qvel) / 2e-6])
    np.testing.assert_allclose(A, literal, atol=1e-7)


def test_accelerometer_feels_the_water():
    """A body held by nothing: the accelerometer at the origin reads R'(a - g) of the true acceleration."""
    rng = np.random.default_rng(9)
    body, state = random_body(rng, 4.0), tumbling(rng)
    model = body.model(inside='<site name="imu"/>', extra='<sensor><accelerometer site="imu"/></sensor>')
    data = mujoco.MjData(model)
    set_state(data, state)
    mujoco.mj_forward(model, data)
    R = data.xmat[1].reshape(3, 3)
    expected = fossen(body, state)[7:10] + np.cross(state[10:], state[7:10]) + R.T @ [0.0, 0.0, 9.81]
    np.testing.assert_allclose(data.sensordata, expected, atol=1e-10)


def test_an_frd_table_converts_as_the_conventions_say():
    """Fossen's equations in FRD axes, and the model from the table converted entry by entry: one acceleration."""
    odd = np.array([[(i % 3 != 0) != (j % 3 != 0) for j in range(6)] for i in range(6)])
    names = "XYZKMN", "uvwpqr"
    changed = {names[0][i] + "_" + names[1][j] for i in range(6) for j in range(6) if odd[i, j]}
    assert {"X_q", "K_v", "X_w"} <= changed
    assert not {"Y_r", "N_v", "M_w", "X_u"} & changed
    sign, flip = np.where(odd, -1.0, 1.0), np.array([1.0, -1.0, -1.0])
    for seed in range(5):
        rng = np.random.default_rng(seed)
        frd, state = random_body(rng), tumbling(rng)
        flu = replace(
            frd,
            cg=flip * frd.cg,
            cb=flip * frd.cb,
            inertia_at_cg=sign[:3, :3] * frd.inertia_at_cg,
            added=sign * frd.added,
            linear=sign * frd.linear,
            quadratic=sign * frd.quadratic,
        )
        turned, both = np.zeros(4), np.concatenate([flip, flip])
        mujoco.mju_mulQuat(turned, state[3:7], np.array([0.0, 1.0, 0.0, 0.0]))
        model = flu.model()
        data = mujoco.MjData(model)
        set_state(data, np.concatenate([state[:3], turned, both * state[7:]]))
        mujoco.mj_forward(model, data)
        R, nu = data.xmat[1].reshape(3, 3), both * state[7:]
        nu_dot = np.concatenate([R.T @ data.qacc[:3] - np.cross(nu[3:], nu[:3]), data.qacc[3:]])
        expected = both * fossen(frd, state)[7:]
        np.testing.assert_allclose(nu_dot, expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())
