"""models/remus100.xml against Prestero's printed equations (2001; 4.49, tables B.1 and B.2), integrated apart."""

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
)

import cube_sim

W = 299.0
ADDED = {"Xu": -0.93, "Yv": -35.5, "Yr": 1.93, "Zw": -35.5, "Zq": -1.93, "Kp": -0.0704}
ADDED |= {"Mw": -1.93, "Mq": -4.88, "Nv": 1.93, "Nr": -4.88}


def forces(nu: np.ndarray, turns: float, stern: float, rudder: float) -> np.ndarray:
    """Prestero's equation 4.49 but for hydrostatics, propeller and what is on the left; no race."""
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


REMUS = PrintedVehicle(
    path=MODELS / "remus100.xml",
    body=RigidBody(W / 9.81, (0.177, 3.45, 3.45), (0.0, 0.0, 0.0196), ADDED),
    weight=W,
    density=1030.0,
    forces=forces,
    fins=2,
    commands=(0.1, 0.25, 0.5, 0.75, 1.0),  # the dead zone ends at 0.1
    thrusts=(0.0386, 0.24125, 0.965, 2.17125, 3.86),
    torque_per_thrust=-0.543 / 3.86,
    lag_s=0.1,
    rate=0.5,
)
B, LIMIT = 308.0, np.radians(13.6)
AHEAD = (1.54, 0.0, 0.0, 0.0, 0.0, 0.0)
FINS = ((0.0, 1.0, 0.0, 0.0), (2.0, 1.0, 0.07, 0.0), (8.0, 1.0, -0.07, 0.05), (15.0, 1.0, 0.0, 0.0))
PROPELLER = ((0.0, 0.5, 0.04, 0.0), (8.0, 1.0, 0.04, 0.0), (16.0, 0.25, 0.04, 0.0), (22.0, 0.75, 0.04, 0.0))
MANOEUVRES = manoeuvres(
    free_decay=Manoeuvre((1.5, 0.1, -0.1, 0.3, 0.1, -0.1), lift=W),  # with B it would glide astern
    constant_wrench=Manoeuvre((1.0, 0.0, 0.0, 0.0, 0.0, 0.0), wrench=(3.0, 0.5, 9.0, 0.1, -0.4, 0.3), lift=B),
    fin_steps=Manoeuvre(AHEAD, FINS, lift=B),
    propeller_steps=Manoeuvre(AHEAD, PROPELLER, lift=B),
    turning_circle=Manoeuvre(AHEAD, ((0.0, 1.0, 0.04, 0.07),), lift=B),
    turning_circle_at_full_rudder=Manoeuvre(AHEAD, ((0.0, 1.0, 0.04, LIMIT),), lift=B),
)


@pytest.mark.flight
@pytest.mark.parametrize("name", MANOEUVRES)
def test_it_moves_as_the_printed_equations_say(name):
    assert_moves_as_printed(REMUS, MANOEUVRES[name])


def test_its_accelerations_are_the_printed_ones():
    assert_accelerations_are_printed(REMUS, 0.2)


@pytest.mark.flight
def test_as_published_it_dives_at_15_degrees_at_no_deflection_as_the_analysis_says():
    """Full thrust and every deflection of the stern planes, by MuJoCo alone: 9 N of lift leave a few degrees."""
    model = cube_sim.load_model(MODELS / "remus100.xml")
    propeller, planes = (model.actuator(name).id for name in ("propeller", "stern_planes"))
    angles = []
    for deflection in np.linspace(-LIMIT, LIMIT, 9):
        data, dive = mujoco.MjData(model), np.radians(10.0)
        data.qpos[2:7] = -60.0, np.cos(dive / 2), 0.0, np.sin(dive / 2), 0.0
        data.qvel[:3] = 1.2 * np.cos(dive), 0.0, -1.2 * np.sin(dive)
        data.ctrl[propeller], data.ctrl[planes] = 1.0, deflection
        mujoco.mj_step(model, data, nstep=round(60.0 / model.opt.timestep))
        before = data.qpos[:3].copy()
        mujoco.mj_step(model, data, nstep=round(20.0 / model.opt.timestep))
        dx, dy, dz = data.qpos[:3] - before
        angles.append(np.degrees(np.arctan2(-dz, np.hypot(dx, dy))))
    assert max(angles) < 10.0
    assert max(angles) - min(angles) > 5.0  # the planes do steer it
