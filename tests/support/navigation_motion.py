"""Motions in closed form, and navigators that fly them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from cube_sim.navigation.aid import Aid, aid_records
from cube_sim.navigation.depth import Depth
from cube_sim.navigation.dvl import Dvl
from cube_sim.navigation.expectation import expect
from cube_sim.navigation.heading import Heading
from cube_sim.navigation.imu import ImuErrors
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.navigator import InitialErrors, Navigator
from cube_sim.navigation.position import PositionFix
from cube_sim.navigation.reading import Fusion, fusion_of
from cube_sim.navigation.sampling import Sampling
from cube_sim.spatial import State, quaternion_from_euler, rotation_from_quaternion

DEG = np.pi / 180.0
DT = 0.02
GRAVITY = np.array([0.0, 0.0, -9.81])

IMU = ImuErrors(0.005 * DEG, 6e-4, 0.1 * DEG, 0.02, 0.0003 * DEG, 1e-4)
FLAWLESS = ImuErrors(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
AIDS: tuple[Aid, ...] = (
    Dvl(Sampling(5.0, 0.1), 0.01, 0.002, 0.005, (0.1, 0.0, -0.2)),
    Depth(Sampling(10.0, 0.05), 0.01, 0.05),
    Heading(Sampling(10.0, 0.05), 0.5 * DEG, 2.0 * DEG),
    PositionFix(Sampling(0.5, 0.5), 0.5),
)
INITIAL = InitialErrors(0.5, 0.05, 1.0 * DEG, 3.0 * DEG)
KNOWN = InitialErrors(0.0, 0.0, 0.0, 0.0)


def truth(position, velocity, angles, turning) -> Motion:
    """From position and velocity (world axes), roll, pitch, yaw and their derivatives."""
    roll, pitch, _ = angles
    R = rotation_from_quaternion(quaternion_from_euler(*angles))
    d_roll, d_pitch, d_yaw = turning
    rates = np.array(
        [
            d_roll - d_yaw * np.sin(pitch),
            d_pitch * np.cos(roll) + d_yaw * np.cos(pitch) * np.sin(roll),
            -d_pitch * np.sin(roll) + d_yaw * np.cos(pitch) * np.cos(roll),
        ]
    )
    return Motion(np.array(position), np.array(velocity), R, rates)


def weaving(t: float) -> Motion:
    """A helix of 3 m radius at 0.4 m/s, swaying in heave, roll and pitch."""
    c, s = np.cos(0.13 * t), np.sin(0.13 * t)
    return truth(
        [3 * c, 3 * s, -8 + 0.05 * t + 0.3 * np.sin(0.4 * t)],
        [-0.39 * s, 0.39 * c, 0.05 + 0.12 * np.cos(0.4 * t)],
        [0.4 * np.sin(0.31 * t), 0.3 * np.sin(0.25 * t), 1.5 + 0.13 * t],
        [0.124 * np.cos(0.31 * t), 0.075 * np.cos(0.25 * t), 0.13],
    )


def tumbling(t: float) -> Motion:
    """The same place, over and over: pitch and roll run through all angles."""
    m = weaving(t)
    return truth(m.position, m.velocity, [0.3 * t, 0.5 * t, 0.2 * t], [0.3, 0.5, 0.2])


def straight(t: float) -> Motion:
    """Level, ahead and northwards at 0.5 m/s."""
    return truth([0, 0.5 * t, -5], [0, 0.5, 0], [0, 0, np.pi / 2], [0, 0, 0])


def truths(motion: Callable[[float], Motion], seconds: float, dt: float = DT) -> list[Motion]:
    return [motion(k * dt) for k in range(round(seconds / dt) + 1)]


def flawless_readings(motions: Sequence[Motion], dt: float = DT) -> list[np.ndarray]:
    """What an inertial unit without errors reads (9,) at each tick of a motion."""
    found = []
    for before, now in zip([motions[0], *motions[:-1]], motions, strict=True):
        turn = Rotation.from_matrix(before.rotation.T @ now.rotation).as_rotvec() / dt
        force = before.rotation.T @ ((now.velocity - before.velocity) / dt - GRAVITY)
        found.append(np.concatenate([turn if found else now.rates, force, now.rates]))
    return found


def on_time(aids: Sequence[Aid]) -> list[Aid]:
    return [replace(aid, sampling=replace(aid.sampling, delay_s=0.0)) for aid in aids]  # type: ignore[type-var]


class Estimate(NamedTuple):
    """What is known at a tick, as a record `ESTIMATE` names it, and the covariance."""

    state: State
    position_sigma: np.ndarray
    velocity_sigma: np.ndarray
    attitude_sigma: np.ndarray
    gyro_bias: np.ndarray
    accelerometer_bias: np.ndarray
    covariance: np.ndarray


class Tick(NamedTuple):
    """A tick of a navigator: its error as the filter defines it, true minus estimated."""

    estimate: Estimate
    fusions: list[Fusion]
    error: np.ndarray


def navigate(motions, seed=0, imu=IMU, aids=AIDS, initial=INITIAL, dt=DT) -> list[Tick]:
    navigator = Navigator(imu, aids, initial, motions[0], seed, GRAVITY, dt)
    ticks = []
    for true in motions:
        fusions = [fusion_of(reading, aids[reading["aid"]].components) for reading in navigator.update(true)]
        answer = navigator.answer[0]
        state = State(*(answer[name] for name in State._fields))
        sigmas = (answer[name] for name in Estimate._fields[1:-1])
        estimate = Estimate(state, *sigmas, navigator.filter.P.copy())
        ticks.append(Tick(estimate, fusions, error_of(navigator, true, estimate)))
    return ticks


class Expected(NamedTuple):
    """What a sensor should read, and its Jacobians, as `expect` says."""

    value: np.ndarray
    H_motion: np.ndarray
    H_constants: np.ndarray


def expected(aid: Aid, motion: Motion, constants: np.ndarray) -> Expected | None:
    """The reading (n,) of a sensor without noise; None where it has none to give."""
    n, c = aid.components, len(constants)
    found = Expected(np.empty(3), np.empty((3, 12)), np.empty((3, 4)))
    told = (tuple(motion[0].tolist()), tuple(motion[1].tolist()), motion[2], tuple(motion[3].tolist()))
    if not expect(aid_records([aid], DT)[0], (*constants.tolist(), *[0.0] * (4 - c)), *told, *found):
        return None
    return Expected(found.value[:n], found.H_motion[:n], found.H_constants[:n, :c])


def error_of(navigator: Navigator, true: Motion, estimate: Estimate) -> np.ndarray:
    state = estimate.state
    R = true.rotation @ state.rotation.T
    axis = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    angle = np.arctan2(np.linalg.norm(axis), 0.5 * (np.trace(R) - 1.0))
    phi = axis * (angle / np.sin(angle) if angle > 1e-8 else 1.0)
    return np.concatenate(
        [
            true.position - state.position,
            true.velocity - state.rotation @ state.velocity,
            phi,
            navigator.true_biases - np.concatenate([estimate.gyro_bias, estimate.accelerometer_bias]),
            *(navigator.true_constants(i) - navigator.filter.constants(i) for i in range(len(navigator.aids))),
        ]
    )
