"""Telling that a simulation has failed, and by which of its numbers."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np

from cube_sim.mission.copying import integration_state, set_integration_state
from cube_sim.native.compiled import compiled
from cube_sim.vehicle.stiffness import stiff_words
from cube_sim.vehicle.vehicle import Vehicle

DIVERGED = 1e6
"""A position [m], velocity [m/s] or acceleration [m/s^2] beyond which a simulation has failed, far from any vehicle."""


def divergence(model: mujoco.MjModel, data: mujoco.MjData, vehicles: Iterable[Vehicle] = ()) -> str | None:
    """Why the state is none that a vehicle can be in; None as long as it may be one.

    Args:
        model: the compiled model.
        data: of that model, its accelerations up to date (mj_forward).
        vehicles: whose stiffness is a likely cause.
    """
    if all_below(DIVERGED, data.qpos, data.qvel, data.qacc):
        return None
    joints_of_positions = np.repeat(np.arange(model.njnt), np.diff([*model.jnt_qposadr, model.nq]))
    causes = (
        ("position", data.qpos, joints_of_positions),
        ("velocity", data.qvel, model.dof_jntid),
        ("acceleration", data.qacc, model.dof_jntid),
    )
    # What is not a number compares as larger than any, for max and for argmax.
    sizes = [np.abs(values) for _, values, _ in causes]
    failed = next(k for k, size in enumerate(sizes) if not size.max() < DIVERGED)
    quantity, values, joints = causes[failed]
    worst = int(np.argmax(sizes[failed]))
    body = model.body(model.jnt_bodyid[joints[worst]]).name
    finite = np.isfinite(values[worst])
    how = f"{values[worst]:.3g} in SI units, beyond {DIVERGED:g}" if finite else "not a number"
    at_start = " before anything has moved (see to the current, the initial state and the model)"
    ending = at_start if data.time == 0.0 else _likely_cause(model, vehicles)
    return f"the {quantity} of '{body}' is {how}{ending}"


def why_broken_off(model: mujoco.MjModel, data: mujoco.MjData, said: str, vehicles: Iterable[Vehicle] = ()) -> str:
    """Why a flight ends because MuJoCo cannot go on; the state stays the last one, the rest of the data is made whole.

    Args:
        model: the compiled model.
        data: which MuJoCo has left in the middle of something.
        said: its words.
        vehicles: whose stiffness is a likely cause.
    """
    state = integration_state(model, data)
    mujoco.mj_resetData(model, data)
    set_integration_state(model, data, state)
    return f"MuJoCo cannot go on: {' '.join(said.split())}{_likely_cause(model, vehicles)}"


def _likely_cause(model: mujoco.MjModel, vehicles: Iterable[Vehicle]) -> str:
    """What of the vehicles is too stiff for the time step, in words behind a failure."""
    words = [word for vehicle in vehicles for word in stiff_words(model, vehicle)]
    return f"; most likely because {words[0]}" if words else ""


@compiled
def all_below(bound, positions, velocities, accelerations):
    """Whether the size of every number is below the bound; that of one that is not a number is not."""
    for values in (positions, velocities, accelerations):
        for value in values:
            if not abs(value) < bound:
                return False
    return True
