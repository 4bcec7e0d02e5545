"""A vehicle as it stands at a moment: its joints and its ballast counted in."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np

from cube_sim.spatial import skew
from cube_sim.vehicle.laws import ballast as law
from cube_sim.vehicle.vehicle import Vehicle


def as_it_stands(model: mujoco.MjModel, name: str, data: mujoco.MjData) -> Vehicle:
    """The vehicle with mass, inertia, water and their centres as joints and ballast are.

    Args:
        model: that it is in.
        name: of the hull.
        data: of the model.

    Raises:
        ModelError: the model has no water, or no such hull.
    """
    vehicle = Vehicle.from_model(model, name, data.qpos)
    if vehicle.ballast is None:
        return vehicle
    displaced, moment = vehicle.displaced_mass, vehicle.displaced_mass * vehicle.centre_of_buoyancy
    M, mass, first = vehicle.mass_matrix, vehicle.mass, vehicle.mass * vehicle.centre_of_mass
    volumes = data.act[vehicle.ballast.activations]
    for row, volume in zip(vehicle.ballast.table, volumes.tolist(), strict=True):
        place = row[law.PLACE : law.LIFT]
        lift, taken_in = row[law.LIFT] * volume, row[law.DENSITY] * volume
        displaced, moment = displaced + lift, moment + lift * place
        mass, first = mass + taken_in, first + taken_in * place
        S = skew(place)
        M = M + taken_in * np.block([[np.eye(3), -S], [S, -S @ S]])
    return replace(
        vehicle,
        mass_matrix=M,
        centre_of_mass=first / mass,
        displaced_mass=displaced,
        centre_of_buoyancy=moment / displaced if displaced > 0.0 else vehicle.centre_of_buoyancy,
    )
