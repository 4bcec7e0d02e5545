"""Manoeuvres of torpedo-shaped vehicles, flown by cube_sim and by the equations their authors printed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import mujoco
import numpy as np

import cube_sim
from cube_sim.spatial import rotation_from_quaternion
from cube_sim.vehicle.pushes import Push, set_push
from support.manoeuvring import FLIP, RigidBody, hydrostatics, integrated, kinematics, rotation, servo

STEP_S = 0.0025


@dataclass(frozen=True)
class PrintedVehicle:
    """A model, and what its authors printed of it in FRD.

    Attributes:
        path: of the MJCF.
        body: mass, inertia and added mass.
        weight: W [N].
        density: of its water [kg/m^3].
        forces: velocity (6,), command of the propeller and deflections -> wrench (6,) but for hydrostatics, thrust and
            what is on the left.
        fins: how many there are.
        commands: of the propeller, from the end of its dead zone on.
        thrusts: at these [N].
        torque_per_thrust: K_prop / X_prop [m].
        lag_s: of propeller and servos [s].
        rate: of the servos at most [rad/s].
    """

    path: Path
    body: RigidBody
    weight: float
    density: float
    forces: Callable[..., np.ndarray]
    fins: int
    commands: tuple[float, ...]
    thrusts: tuple[float, ...]
    torque_per_thrust: float
    lag_s: float
    rate: float

    def rate_of(self, state: np.ndarray, asked: tuple[float, ...], wrench: np.ndarray, lift: float) -> np.ndarray:
        """d/dt of [position, quaternion, nu, command of the propeller, deflections]; the wrench is from outside."""
        q, nu, turns, angles = state[3:7], state[7:13], state[13], state[14:]
        thrust = np.interp(turns, self.commands, self.thrusts, left=0.0)
        tau = self.forces(nu, turns, *angles) + wrench
        tau += hydrostatics(rotation(q), self.weight, lift, self.body.centre, np.zeros(3))
        tau[0] += thrust
        tau[3] += thrust * self.torque_per_thrust
        nu_dot = np.linalg.solve(self.body.matrix(), tau - self.body.turning(nu))
        turned = [servo(target, angle, self.lag_s, self.rate) for target, angle in zip(asked[1:], angles, strict=True)]
        return np.concatenate([kinematics(q, nu), nu_dot, [(asked[0] - turns) / self.lag_s, *turned]])


@dataclass(frozen=True)
class Manoeuvre:
    """Start (u, v, w, p, q, r) in FRD; rows time, then what is asked of propeller and fins from then on.

    The wrench is from outside, in body axes; the lift [N] is W where it is None.
    """

    start: tuple[float, ...]
    steps: tuple[tuple[float, ...], ...] = ()
    wrench: tuple[float, ...] = (0.0,) * 6
    lift: float | None = None

    def printed(self, vehicle: PrintedVehicle, duration: float) -> np.ndarray:
        """The state at the end by the printed equations."""
        steps = self._steps(vehicle.fins)
        state = np.concatenate([np.zeros(3), [1.0, 0.0, 0.0, 0.0], self.start, steps[0][1:2], np.zeros(vehicle.fins)])
        wrench, lift = np.array(self.wrench), self._lift(vehicle)
        for (begin, *asked), (end, *_) in pairwise([*steps, (duration,)]):
            state = integrated(
                lambda _, y, asked=tuple(asked): vehicle.rate_of(y, asked, wrench, lift), state, end - begin
            )
        return state

    def flown(self, vehicle: PrintedVehicle, duration: float) -> np.ndarray:
        """The same by cube_sim."""
        volume = {"hull:volume": self._lift(vehicle) / (vehicle.density * 9.81)}
        model = cube_sim.load_model(vehicle.path, volume, pushes=1)
        model.opt.timestep = STEP_S
        data = mujoco.MjData(model)
        push = Push(tuple(FLIP * self.wrench[:3]), tuple(FLIP * self.wrench[3:]), in_body=True)
        set_push(model, 0, model.body("hull").id, push)
        data.qvel[:] = np.concatenate([FLIP, FLIP]) * self.start
        steps = self._steps(vehicle.fins)
        data.act[0] = steps[0][1]  # the propeller turns already
        for (begin, *asked), (end, *_) in pairwise([*steps, (duration,)]):
            data.ctrl[:] = asked
            mujoco.mj_step(model, data, nstep=round((end - begin) / model.opt.timestep))
        R = rotation_from_quaternion(data.qpos[3:7])
        w, x, y, z = data.qpos[3:7]
        nu = np.concatenate([FLIP * (R.T @ data.qvel[:3]), FLIP * data.qvel[3:]])
        return np.concatenate([FLIP * data.qpos[:3], [w, x, -y, -z], nu, data.act])

    def _steps(self, fins: int) -> tuple[tuple[float, ...], ...]:
        return self.steps or ((0.0,) * (2 + fins),)

    def _lift(self, vehicle: PrintedVehicle) -> float:
        return vehicle.weight if self.lift is None else self.lift


def manoeuvres(
    *,
    free_decay: Manoeuvre,
    constant_wrench: Manoeuvre,
    fin_steps: Manoeuvre,
    propeller_steps: Manoeuvre,
    turning_circle: Manoeuvre,
    turning_circle_at_full_rudder: Manoeuvre,
) -> dict[str, Manoeuvre]:
    """What every such vehicle is held to, by name."""
    return {name.replace("_", " "): manoeuvre for name, manoeuvre in locals().items()}


def assert_moves_as_printed(vehicle: PrintedVehicle, manoeuvre: Manoeuvre, duration: float = 30.0) -> None:
    """Both ways of flying a manoeuvre end in the same state within 1e-6 (SI units)."""
    expected, found = manoeuvre.printed(vehicle, duration), manoeuvre.flown(vehicle, duration)
    assert np.abs(expected[:3]).max() > 5.0  # it went somewhere
    assert np.abs(found - expected).max() < 1e-6


def states(vehicle: PrintedVehicle, n: int, deflection: float, seed: int = 0) -> Iterator[tuple[np.ndarray, ...]]:
    """n random velocities ahead (6,), attitudes (4,), and activations: the propeller's, and deflections up to one."""
    rng = np.random.default_rng(seed)
    for _ in range(n):
        nu = np.array([rng.uniform(0.1, 2.0), *rng.normal(size=5) * 0.3])
        q = rng.normal(size=4)
        yield nu, q, np.array([rng.uniform(0.3, 1.0), *rng.uniform(-deflection, deflection, vehicle.fins)])


def assert_accelerations_are_printed(vehicle: PrintedVehicle, deflection: float) -> None:
    """At 20 random states, with deflections [rad] up to the one given, within 1e-11."""
    for nu, q, act in states(vehicle, 20, deflection):
        found, expected = accelerations(vehicle, nu, q, act)
        np.testing.assert_allclose(found, expected, atol=1e-11 * max(1.0, np.abs(expected).max()))


def accelerations(
    vehicle: PrintedVehicle, nu: np.ndarray, q: np.ndarray, act: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """nu' (6,) in FRD by cube_sim and as printed.

    Args:
        vehicle: loaded as its file says but neutral.
        nu: (6,) FRD.
        q: attitude (4,), NED and FRD.
        act: command of the propeller and deflections.
    """
    model = cube_sim.load_model(vehicle.path, {"hull:volume": vehicle.weight / (vehicle.density * 9.81)})
    data = mujoco.MjData(model)
    data.qpos[3:7] = q / np.linalg.norm(q) * [1.0, 1.0, -1.0, -1.0]
    R = rotation_from_quaternion(data.qpos[3:7])
    data.qvel[:] = np.concatenate([R @ (FLIP * nu[:3]), FLIP * nu[3:]])
    data.act[:] = act
    mujoco.mj_forward(model, data)
    linear = R.T @ data.qacc[:3] - np.cross(FLIP * nu[3:], FLIP * nu[:3])
    found = np.concatenate([FLIP * linear, FLIP * data.qacc[3:]])
    state = np.concatenate([np.zeros(3), q, nu, act])
    return found, vehicle.rate_of(state, tuple(act), np.zeros(6), vehicle.weight)[7:13]
