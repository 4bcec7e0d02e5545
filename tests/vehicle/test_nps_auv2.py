"""models/nps_auv2.xml against the equations of Healey and Lienard (1993, appendix), integrated apart.

With w - x q in the pitching moment of the strips, as the model's head says.
"""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.manoeuvring import RigidBody
from support.places import MODELS
from support.printed_vehicle import (
    Manoeuvre,
    PrintedVehicle,
    assert_accelerations_are_printed,
    assert_moves_as_printed,
    manoeuvres,
    states,
)

import cube_sim
from cube_sim.vehicle import nps_auv2
from cube_sim.vehicle.fins import Fins

L, W = 5.3, 53400.0
R2, R3, R4, R5 = (500.0 * L**k for k in (2, 3, 4, 5))  # rho/2 L^k
ADDED = {"Xu": -7.6e-3 * R3, "Yv": -5.5e-2 * R3, "Zw": -2.4e-1 * R3}
ADDED |= {"Kp": -1.0e-3 * R5, "Mq": -1.7e-2 * R5, "Nr": -3.4e-3 * R5}
ADDED |= {"Yp": 1.2e-4 * R4, "Kv": 1.2e-4 * R4, "Yr": 1.2e-3 * R4, "Nv": 1.2e-3 * R4}
ADDED |= {"Zq": -6.8e-3 * R4, "Mw": -6.8e-3 * R4, "Kr": -3.4e-5 * R5, "Np": -3.4e-5 * R5}
UNIT_SPEED = 0.012 * 1500.0 / 60.0 * 2.0 * np.pi  # where eta is 1 at 1500 revolutions a minute [m/s]
COMMANDS = np.linspace(0.0, 1.0, 21)


def cross_flow(v: float, w: float, q: float, r: float) -> np.ndarray:
    """Drag across a hull of 0.53 m by 0.53 m, C_Dy = 0.5 and C_Dz = 0.6, by the trapezoidal rule on 11 stations."""
    x = np.linspace(-0.5 * L, 0.5 * L, 11)
    across, down = v + x * r, w - x * q
    speed = np.hypot(across, down)
    drag = 500.0 * 0.53 * (0.5 * across**2 + 0.6 * down**2) / np.where(speed > 0.0, speed, 1.0)
    strips = -drag * across, -drag * down, x * drag * down, -x * drag * across
    Y, Z, M, N = (np.trapezoid(each, x) for each in strips)
    return np.array([0.0, Y, Z, 0.0, M, N])


def race(u: float, turns: float) -> float:
    """epsilon(n), ahead."""
    eta = UNIT_SPEED * turns / u
    C_t, C_t1 = 0.008 * L**2 * eta * abs(eta) / 2.0, 0.008 * L**2 / 2.0
    return -1.0 + np.sign(turns) * (np.sqrt(C_t + 1.0) - 1.0) / (np.sqrt(C_t1 + 1.0) - 1.0)


def forces(nu: np.ndarray, turns: float, rudder: float, stern: float, bow: float) -> np.ndarray:
    """The appendix's right sides but for hydrostatics, thrust and what is on the left; both bow planes at `bow`."""
    u, v, w, p, q, r = nu.tolist()
    eps = race(u, turns)
    X = (
        R4 * (7.0e-3 * p * p - 1.5e-2 * q * q + 4.0e-3 * r * r + 7.5e-4 * p * r)
        + R3 * (-2.0e-1 * w * q - 3.0e-3 * v * p + 2.0e-2 * v * r)
        + R3 * (u * q * (2.5e-2 * stern - 2 * 1.3e-3 * bow) - 1.0e-3 * u * r * rudder)
        + R2 * (5.3e-2 * v * v + 1.7e-1 * w * w + u * w * (4.6e-2 * stern + 2 * 0.5e-2 * bow) + 1.7e-3 * u * v * rudder)
        + R2 * u * u * (-1.0e-2 * stern**2 - 4.0e-3 * bow**2 - 1.0e-2 * rudder**2)
        + eps * (R3 * 2.0e-3 * u * q * stern + R2 * (3.5e-3 * u * w * stern - 1.6e-3 * u * u * stern**2))
        - R2 * 0.00385 * u * u  # of X_prop
    )
    Y = (
        R4 * (4.0e-3 * p * q - 6.5e-3 * q * r)
        + R3 * (3.0e-3 * u * p + 3.0e-2 * u * r + 2.4e-2 * v * q + 2.3e-1 * w * p - 1.9e-2 * w * r)
        + R2 * (-1.0e-1 * u * v + 6.8e-2 * v * w + 2.7e-2 * u * u * rudder)
    )
    Z = (
        R4 * (1.3e-4 * p * p + 6.7e-3 * p * r - 7.4e-3 * r * r)
        + R3 * (-1.4e-1 * u * q - 4.8e-2 * v * p + 4.5e-2 * v * r)
        + R2 * (-3.0e-1 * u * w - 6.8e-2 * v * v + u * u * (-7.3e-2 * stern - 2 * 1.3e-2 * bow))
        + eps * (-R3 * 2.9e-3 * u * q + R2 * (-5.1e-3 * u * w - 1.0e-2 * u * u * stern))
    )
    K = (
        R5 * (-6.9e-5 * p * q + 1.7e-2 * q * r)
        + R4 * (-1.1e-2 * u * p - 8.4e-4 * u * r - 5.1e-3 * v * q - 1.3e-4 * w * p + 1.4e-2 * w * r)
        + R3 * (3.1e-3 * u * v - 1.9e-1 * v * w)
        - eps * R4 * 5.7e-4 * u * p
    )
    M = (
        R5 * (5.3e-5 * p * p + 5.0e-3 * p * r + 2.9e-3 * r * r)
        + R4 * (-6.8e-2 * u * q + 1.2e-3 * v * p + 1.7e-2 * v * r)
        + R3 * (1.0e-1 * u * w - 2.6e-2 * v * v + u * u * (-4.1e-2 * stern + 2 * 3.5e-3 * bow))
        + eps * (-R4 * 1.6e-3 * u * q + R3 * (-2.9e-3 * u * w - 5.2e-3 * u * u * stern))
    )
    N = (
        R5 * (-2.1e-2 * p * q + 2.7e-3 * q * r)
        + R4 * (-8.4e-4 * u * p - 1.6e-2 * u * r - 1.0e-2 * v * q - 1.7e-2 * w * p + 7.4e-3 * w * r)
        + R3 * (-7.4e-3 * u * v - 2.7e-2 * v * w - 1.3e-2 * u * u * rudder)
    )
    return np.array([X, Y, Z, K, M, N]) + cross_flow(v, w, q, r)


NPS = PrintedVehicle(
    path=MODELS / "nps_auv2.xml",
    body=RigidBody(W / 9.81, (2038.0, 13587.0, 13587.0), (0.0, 0.0, 0.061), ADDED, (-13.58, -13.58, -13.58)),
    weight=W,
    density=1000.0,
    forces=forces,
    fins=3,
    commands=tuple(COMMANDS),
    thrusts=tuple(R2 * 0.00385 * (UNIT_SPEED * COMMANDS) ** 2),
    torque_per_thrust=0.0,
    lag_s=0.1,
    rate=10.0,
)
AHEAD, LIMIT = (1.5, 0.0, 0.0, 0.0, 0.0, 0.0), np.radians(20.0)
FINS = ((0.0, 1.0, 0.0, 0.0, 0.0), (2.0, 1.0, 0.0, 0.1, -0.1), (8.0, 1.0, 0.15, -0.1, 0.1), (15.0, 1.0, 0.0, 0.0, 0.05))
TURNS = ((0.0, 0.5), (8.0, 1.0), (16.0, 0.25), (22.0, 0.75))
MANOEUVRES = manoeuvres(
    free_decay=Manoeuvre((1.5, 0.1, -0.1, 0.1, 0.05, -0.05)),
    constant_wrench=Manoeuvre((1.0, 0.0, 0.0, 0.0, 0.0, 0.0), wrench=(60.0, 20.0, 30.0, 20.0, -40.0, 60.0)),
    fin_steps=Manoeuvre(AHEAD, FINS),
    propeller_steps=Manoeuvre(AHEAD, tuple((*step, 0.05, 0.02, 0.0) for step in TURNS)),
    turning_circle=Manoeuvre(AHEAD, ((0.0, 1.0, 0.2, 0.0, 0.0),)),
    turning_circle_at_full_rudder=Manoeuvre(AHEAD, ((0.0, 1.0, LIMIT, 0.0, 0.0),)),
)


@pytest.mark.flight
@pytest.mark.parametrize("name", MANOEUVRES)
def test_it_moves_as_the_printed_equations_say(name):
    assert_moves_as_printed(NPS, MANOEUVRES[name])


def test_its_accelerations_are_the_printed_ones():
    assert_accelerations_are_printed(NPS, 0.3)


@pytest.mark.parametrize("turns", [-1.0, 0.0, 1.0])
def test_the_race_does_not_jump_where_the_hull_stops(turns):
    """Its terms hold eta, which is infinite at rest."""
    act, still = np.array([turns, 0.2, -0.3, 0.1]), (np.zeros(3), np.eye(3), np.zeros(6))
    flows = [np.array([u, 0.1, -0.2, 0.3, 0.0, 0.1]) for u in (-0.5, -1e-9, 0.0, 1e-9)]
    wrenches = [nps_auv2.race(0.0, *still, flow, act, act) for flow in flows]
    assert np.ptp(wrenches, axis=0).max() < 1e-4
    assert (np.abs(wrenches[0]).max() > 100.0) == (turns > 0.0)


def test_its_fins_tell_controllers_the_derivatives_of_the_printed_forces():
    fins = Fins.from_model(cube_sim.load_model(NPS.path))
    assert fins.names == ("rudder", "stern_planes", "bow_planes")
    flip = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
    for nu, _, act in states(NPS, 5, 0.3, seed=1):
        found = flip[:, None] * fins.effectiveness(act[1:], flip * nu)
        steady, steps = nu[0] / UNIT_SPEED, 1e-4 * np.eye(3)  # the race of the moment is not their own
        printed = [
            (forces(nu, steady, *(act[1:] + step)) - forces(nu, steady, *(act[1:] - step))) / 2e-4 for step in steps
        ]
        np.testing.assert_allclose(found, np.transpose(printed), rtol=1e-7, atol=1e-6)


def test_at_steady_speed_the_propeller_drives_it_at_that_of_its_revolutions():
    model = cube_sim.load_model(NPS.path)
    data = mujoco.MjData(model)
    data.qvel[0], data.ctrl[0], data.act[0] = UNIT_SPEED, 1.0, 1.0
    mujoco.mj_forward(model, data)
    assert data.qacc[0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.flight
def test_it_flies_to_another_depth_and_heading_by_its_fins():
    model = cube_sim.load_model(NPS.path)
    data, fins = mujoco.MjData(model), Fins.from_model(model)
    data.qpos[:3], data.qvel[0], data.ctrl[0], data.act[0] = (0.0, 0.0, -10.0), 1.5, 1.0, 1.0
    height, heading, inertia = -12.0, np.radians(40.0), 50e3  # M and N with the water's share [kg m^2]
    for _ in range(1200):
        mujoco.mj_forward(model, data)
        R, rates = data.xmat[1].reshape(3, 3), data.qvel[3:6]
        flow = np.concatenate([R.T @ data.qvel[:3], rates])
        climb = np.clip(0.1 * (height - data.qpos[2]), -0.25, 0.25)
        off = np.array([np.arcsin(R[2, 0]) - climb, heading - np.arctan2(R[1, 0], R[0, 0])])
        moment = inertia * (0.09 * off - 0.5 * rates[1:])
        B = fins.effectiveness(np.zeros(3), flow)[4:]
        data.ctrl[fins.actuators] = np.clip(np.linalg.pinv(B) @ moment, *fins.travel.T)
        mujoco.mj_step(model, data, nstep=10)
    R = data.xmat[1].reshape(3, 3)
    assert data.qpos[2] == pytest.approx(height, abs=0.2)
    assert np.arctan2(R[1, 0], R[0, 0]) == pytest.approx(heading, abs=0.02)
    assert np.degrees(np.abs(np.arcsin(R[2, :2]))).max() < 2.0  # level again
