"""Faults of servos in MuJoCo's state: against closed forms, and the compiled callbacks against their plain Python."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support import plain_callbacks
from support.finned import x_tail
from support.places import MODELS

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.fin_faults import (
    jam_fin,
    loosen_fin,
    repair_fin,
    servo_rows,
    shorten_travel,
    slow_fin,
)
from cube_sim.vehicle.fins import Fins
from cube_sim.vehicle.plugin import packing

LAG_S, RATE, TRAVEL = 0.08, 1.0, 0.35


def tail(**how) -> tuple[mujoco.MjModel, mujoco.MjData, Fins]:
    model = cube_sim.load_model(mujoco.MjSpec.from_string(x_tail(**how)))
    return model, mujoco.MjData(model), Fins.from_model(model)


def turned(model, data, fins, command, seconds):
    """Deflections (n,k) over time, all told the same, the hull held in place."""
    rows = []
    for _ in range(round(seconds / model.opt.timestep)):
        data.ctrl[fins.actuators] = command
        data.qvel[:] = 0.0
        mujoco.mj_step(model, data)
        rows.append(data.act[fins.activations])
    return np.array(rows)


def test_each_fault_does_what_it_says():
    model, data, fins = tail()
    model.opt.timestep = 0.001
    turned(model, data, fins, 0.1, 2.0)
    jam_fin(model, "x1")
    jam_fin(model, "x2", -0.2)
    slow_fin(model, "x3", 0.05)
    shorten_travel(model, "x4", -0.05, 0.15)
    rows = turned(model, data, fins, 0.3, 1.0)
    assert rows[:, 0] == pytest.approx(0.1, abs=1e-9)  # it stays where it was
    assert rows[-1, 1] == pytest.approx(-0.2, abs=1e-4)  # it goes to its angle, no faster than it turns
    assert np.diff(rows[:, 1]).min() >= -RATE * 0.001 - 1e-12
    assert np.diff(rows[:, 2]) == pytest.approx(0.05 * 0.001, rel=1e-9)
    assert rows[-1, 3] == pytest.approx(0.15, abs=1e-4)
    assert turned(model, data, fins, -0.3, 2.0)[-1, [0, 1, 3]] == pytest.approx([0.1, -0.2, -0.05], abs=1e-4)
    for fin in fins.names:
        repair_fin(model, fin)
    assert turned(model, data, fins, 0.2, 2.0)[-1] == pytest.approx(0.2, abs=1e-6)


def test_whole_servos_turn_as_they_did():
    """A slow one with its own rate, and one short of its whole travel, have no fault: the same bits."""
    flown = []
    for broken in (False, True):
        model, data, fins = tail()
        if broken:
            slow_fin(model, "x1", RATE)
            shorten_travel(model, "x2", -TRAVEL, TRAVEL)
        data.qvel[0] = 1.5
        for k in range(300):
            data.ctrl[fins.actuators] = 0.3 * np.sin(0.05 * k + np.arange(4))
            mujoco.mj_step(model, data)
        flown.append(np.concatenate([data.qpos, data.qvel, data.act]))
    assert flown[0].tobytes() == flown[1].tobytes()


@pytest.mark.parametrize("linear", [False, True])
def test_a_loose_fin_follows_the_flow_and_loses_its_lift(linear):
    """Its deflection goes to the angle of the flow with the servo's lag, and its lift with it."""
    if linear:
        model = cube_sim.load_model(MODELS / "remus100.xml")
        fins, name, lag = Fins.from_model(model), "rudder", 0.1
    else:
        model, _, fins = tail()
        name, lag = "x1", LAG_S
    data, k = mujoco.MjData(model), fins.names.index(name)
    nu = np.array([1.5, 0.2, -0.15, 0.0, 0.1, 0.2])
    loosen_fin(model, name)
    data.qvel[:] = nu
    data.qpos[3:7] = 1.0, 0.0, 0.0, 0.0
    u, n = _flow_at(fins.table[k], nu)
    vane = n / u if linear else np.arctan2(n, u)
    mujoco.mj_forward(model, data)
    assert data.act_dot[fins.activations[k]] == pytest.approx((vane - 0.0) / lag, rel=1e-12)
    data.act[fins.activations[k]] = vane
    mujoco.mj_forward(model, data)
    assert data.act_dot[fins.activations[k]] == pytest.approx(0.0, abs=1e-12)
    wrench = fins._wrench(k, vane, tuple(nu.tolist()))
    whole = fins._wrench(k, 0.0, tuple(nu.tolist()))
    drag = 0.0 if linear else fins.table[k, 10] * fins.table[k, 13] * (u * u + n * n)  # C_D0 alone is left
    assert np.linalg.norm(wrench[:3]) == pytest.approx(drag, rel=1e-9, abs=1e-12)
    assert np.linalg.norm(wrench[:3]) < 0.5 * np.linalg.norm(whole[:3])


def _flow_at(row, nu):
    at = nu[:3] + np.cross(nu[3:], row[1:4])
    return float(row[4:7] @ at), float(row[7:10] @ at)


def test_a_jam_goes_there_as_an_independent_integration():
    model, data, fins = tail()
    model.opt.timestep = 0.002
    jam_fin(model, "x3", 0.25)

    def slope(t, y):
        return np.clip((0.25 - y) / LAG_S, -RATE, RATE)

    mujoco.mj_step(model, data, nstep=200)
    truth = solve_ivp(slope, (0, 0.4), [0.0], method="DOP853", rtol=1e-12, atol=1e-14, max_step=1e-3).y[0, -1]
    assert data.act[fins.activations[2]] == pytest.approx(truth, rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_the_compiled_callbacks_are_their_plain_python(seed):
    rng = np.random.default_rng(seed)
    model, data, fins = tail(bow_planes=True)
    faults = [
        lambda fin: jam_fin(model, fin),
        lambda fin: jam_fin(model, fin, 0.1),
        lambda fin: slow_fin(model, fin, 0.3),
        lambda fin: shorten_travel(model, fin, -0.1, 0.2),
        lambda fin: loosen_fin(model, fin),
    ]
    for fin, index in zip(fins.names, rng.permutation(5), strict=True):
        faults[index](fin)
    data.qvel[:], data.qpos[3:7] = rng.normal(size=6), rng.normal(size=4)
    data.ctrl[fins.actuators], data.act[fins.activations] = rng.uniform(-0.5, 0.5, (2, 5))
    mujoco.mj_forward(model, data)
    servo = plain_callbacks.callbacks()["servo"]
    for actuator, activation in zip(fins.actuators, fins.activations, strict=True):
        assert servo(model._address, data._address, int(actuator)) == data.act_dot[activation]


def test_other_parameters_leave_a_fault_as_it_is():
    model, _, _ = tail()
    jam_fin(model, "x2", 0.1)
    before = servo_rows(packing.packed_parameters(model)).copy()
    cube_sim.set_parameters(model, {"x1:fin_area": [0.02]})
    assert servo_rows(packing.packed_parameters(model)).tobytes() == before.tobytes()


@pytest.mark.parametrize(
    ("fault", "word"),
    [
        (lambda model: jam_fin(model, "x9"), "the model has x1, x2, x3, x4"),
        (lambda model: jam_fin(model, "x1", 0.5), "it turns from -0.35 to 0.35 rad"),
        (lambda model: slow_fin(model, "x1", 0.0), "positive"),
        (lambda model: shorten_travel(model, "x1", 0.2, 0.1), "increasing"),
    ],
)
def test_what_cannot_be_is_refused(fault, word):
    model, _, _ = tail()
    with pytest.raises(ModelError, match=word):
        fault(model)
