"""models/remus100.xml against Prestero's printed equations (2001; 4.49, tables B.1 and B.2), integrated apart."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import mujoco
import numpy as np
import pytest
from support.manoeuvring import FLIP, RigidBody, hydrostatics, integrated, kinematics, rotation, servo
from support.places import MODELS

import cube_sim
from cube_sim.spatial import rotation_from_quaternion
from cube_sim.vehicle.pushes import Push, set_push

W, G = 299.0, 9.81
CENTRE = (0.0, 0.0, 0.0196)
ADDED = {"Xu": -0.93, "Yv": -35.5, "Yr": 1.93, "Zw": -35.5, "Zq": -1.93, "Kp": -0.0704}
ADDED |= {"Mw": -1.93, "Mq": -4.88, "Nv": 1.93, "Nr": -4.88}
BODY = RigidBody(W / G, (0.177, 3.45, 3.45), CENTRE, ADDED)
LAG, RATE, LIMIT = 0.1, 0.5, np.radians(13.6)
COMMANDS, THRUSTS = [0.1, 0.25, 0.5, 0.75, 1.0], [0.0386, 0.24125, 0.965, 2.17125, 3.86]
INVERSE = np.linalg.inv(BODY.matrix())


def forces(nu: np.ndarray, stern: float, rudder: float) -> np.ndarray:
    """Prestero's equation 4.49 but for hydrostatics, propeller and what is on the left."""
    u, v, w, p, q, r = nu.tolist()
    return np.array(
        [
            -1.62 * u * abs(u) - 35.5 * w * q - 1.93 * q * q + 35.5 * v * r - 1.93 * r * r,
            -1310.0 * v * abs(v) + 0.632 * r * abs(r) + 5.22 * u * r + 35.5 * w * p + 1.93 * p * q - 28.6 * u * v
            + 9.64 * u * u * rudder,
            -131.0 * w * abs(w) - 0.632 * q * abs(q) - 5.22 * u * q - 35.5 * v * p + 1.93 * r * p - 28.6 * u * w
            - 9.64 * u * u * stern,
            -0.13 * p * abs(p),
            3.18 * w * abs(w) - 188.0 * q * abs(q) - 2.0 * u * q - 1.93 * v * p + 4.86 * r * p + 24.0 * u * w
            - 6.15 * u * u * stern,
            -3.18 * v * abs(v) - 94.0 * r * abs(r) - 2.0 * u * r - 1.93 * w * p - 4.86 * p * q - 24.0 * u * v
            - 6.15 * u * u * rudder,
        ]
    )  # fmt: skip


@dataclass(frozen=True)
class Manoeuvre:
    """Start (u, v, w, p, q, r) in FRD; what is asked of propeller, stern planes and rudder from when on; B [N]."""

    start: tuple[float, ...]
    steps: tuple[tuple[float, float, float, float], ...] = ()
    wrench: tuple[float, ...] = (0.0,) * 6
    lift: float = 308.0

    def asked(self, time: float) -> tuple[float, ...]:
        return next((step[1:] for step in reversed(self.steps) if step[0] <= time), (0.0, 0.0, 0.0))

    def rate(self, state: np.ndarray, asked: tuple[float, ...]) -> np.ndarray:
        q, nu, turns, stern, rudder = state[3:7], state[7:13], state[13], state[14], state[15]
        thrust = np.interp(turns, COMMANDS, THRUSTS, left=0.0)  # the dead zone
        tau = forces(nu, stern, rudder) + hydrostatics(rotation(q), W, self.lift, CENTRE, np.zeros(3)) + self.wrench
        tau[0] += thrust
        tau[3] += thrust * -0.543 / 3.86
        nu_dot = INVERSE @ (tau - BODY.turning(nu))
        moved = (asked[0] - turns) / 0.1, *(servo(asked[k], state[13 + k], LAG, RATE) for k in (1, 2))
        return np.concatenate([kinematics(q, nu), nu_dot, moved])

    def printed(self, duration: float) -> np.ndarray:
        begin = np.concatenate([np.zeros(3), [1.0, 0.0, 0.0, 0.0], self.start, self.asked(0.0)[:1], np.zeros(2)])
        times = (*(step[0] for step in self.steps if 0.0 < step[0] < duration), duration)
        state, before = begin, 0.0
        for time in times:
            asked = self.asked(before)
            state = integrated(lambda _, y, asked=asked: self.rate(y, asked), state, time - before)
            before = time
        return state

    def flown(self, duration: float) -> np.ndarray:
        volume = {"hull:volume": self.lift / (1030.0 * G)}
        model = cube_sim.load_model(MODELS / "remus100.xml", volume, pushes=1)
        model.opt.timestep = 0.0025
        data = mujoco.MjData(model)
        push = Push(tuple(FLIP * self.wrench[:3]), tuple(FLIP * self.wrench[3:]), in_body=True)
        set_push(model, 0, model.body("hull").id, push)
        data.qvel[:] = np.concatenate([FLIP, FLIP]) * self.start
        data.act[0] = self.asked(0.0)[0]  # the propeller turns already
        times = [*(step[0] for step in self.steps), duration] if self.steps else [0.0, duration]
        for begin, end in pairwise(times):
            data.ctrl[:] = self.asked(begin)
            mujoco.mj_step(model, data, nstep=round((end - begin) / model.opt.timestep))
        R = rotation_from_quaternion(data.qpos[3:7])
        w, x, y, z = data.qpos[3:7]
        nu = np.concatenate([FLIP * (R.T @ data.qvel[:3]), FLIP * data.qvel[3:]])
        return np.concatenate([FLIP * data.qpos[:3], [w, x, -y, -z], nu, data.act])


AHEAD = (1.54, 0.0, 0.0, 0.0, 0.0, 0.0)
FINS = ((0.0, 1.0, 0.0, 0.0), (2.0, 1.0, 0.07, 0.0), (8.0, 1.0, -0.07, 0.05), (15.0, 1.0, 0.0, 0.0))
PROPELLER = ((0.0, 0.5, 0.04, 0.0), (8.0, 1.0, 0.04, 0.0), (16.0, 0.25, 0.04, 0.0), (22.0, 0.75, 0.04, 0.0))
MANOEUVRES = {
    "free decay": Manoeuvre((1.5, 0.1, -0.1, 0.3, 0.1, -0.1), lift=W),  # as printed, it would glide astern
    "constant wrench": Manoeuvre((1.0, 0.0, 0.0, 0.0, 0.0, 0.0), wrench=(3.0, 0.5, 9.0, 0.1, -0.4, 0.3)),
    "fin steps": Manoeuvre(AHEAD, FINS),
    "propeller steps": Manoeuvre(AHEAD, PROPELLER),
    "turning circle": Manoeuvre(AHEAD, ((0.0, 1.0, 0.04, 0.07),)),
    "turning circle at full rudder": Manoeuvre(AHEAD, ((0.0, 1.0, 0.04, LIMIT),)),
}


@pytest.mark.flight
@pytest.mark.parametrize("name", MANOEUVRES)
def test_it_moves_as_the_printed_equations_say(name):
    manoeuvre = MANOEUVRES[name]
    expected, found = manoeuvre.printed(30.0), manoeuvre.flown(30.0)
    assert np.abs(expected[:3]).max() > 5.0  # it went somewhere
    assert np.abs(found - expected).max() < 1e-6


def test_its_accelerations_are_the_printed_ones():
    model = cube_sim.load_model(MODELS / "remus100.xml")
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    for _ in range(20):
        q = rng.normal(size=4)
        nu = np.array([rng.uniform(0.1, 2.0), *rng.normal(size=5) * 0.3])
        data.qpos[3:7] = q / np.linalg.norm(q) * [1.0, 1.0, -1.0, -1.0]
        R = rotation_from_quaternion(data.qpos[3:7])
        data.qvel[:] = np.concatenate([R @ (FLIP * nu[:3]), FLIP * nu[3:]])
        data.act[:] = rng.uniform(-0.2, 0.2, 3)
        data.act[0] = 0.75
        mujoco.mj_forward(model, data)
        linear = R.T @ data.qacc[:3] - np.cross(FLIP * nu[3:], FLIP * nu[:3])
        found = np.concatenate([FLIP * linear, FLIP * data.qacc[3:]])
        expected = Manoeuvre(AHEAD).rate(np.concatenate([np.zeros(3), q, nu, data.act]), (0.0,) * 3)[7:13]
        np.testing.assert_allclose(found, expected, atol=1e-11 * max(1.0, np.abs(expected).max()))
