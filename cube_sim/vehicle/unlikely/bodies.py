"""Hulls and links, the water and gravity, whose numbers are most likely in another unit."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np

from cube_sim.vehicle.mjcf.numeric_names import DENSITY
from cube_sim.vehicle.mjcf.parameters import WaterParameters

LIGHTEST, HEAVIEST = 10.0, 25e3
"""Masses per volume [kg/m^3] between which a body lies: foams have 20 and more, osmium has 22 600 (a choice)."""
THINNEST, DENSEST = 100.0, 20e3
"""Densities of a liquid [kg/m^3] between which it lies: liquid hydrogen has 71, mercury 13 500 (a choice)."""
FARTHEST = 10.0
"""Distance of a centre from that of mass, in V^(1/3) and in radii of gyration, beyond which it is named (a choice)."""
NARROWEST, WIDEST = 0.1, 5.0
"""Largest radius of gyration of a body, in V^(1/3), between which it lies (a choice).

A ball has 0.39, one of tungsten that a hull of no weight makes neutral 0.15; torpedoes have up to 1.7, and a rod 60
times as long as thick 4.8.
"""
STRONGEST = 30.0
"""Gravity beyond which it is worth a word [m/s^2]: Jupiter has 25 (a choice)."""


def unlikely_bodies(model: mujoco.MjModel, water: WaterParameters) -> Iterator[str]:
    """Sentences on the volumes, inertias and centres of buoyancy of hulls and links, on the water and on gravity.

    Args:
        model: made by `load_model`.
        water: as `water_of` reads it.
    """
    if not THINNEST <= water.density <= DENSEST:
        yield f"{DENSITY} is {water.density:g} kg/m^3; fresh water has 1000; is it in [kg/m^3]?"
    yield from _of_gravity(model)
    masses = _masses(model, [each.body for each in (*water.hulls, *water.links)])
    for body in (*water.hulls, *water.links):
        if body.volume == 0.0:
            continue
        mass = masses[body.body]
        if not LIGHTEST <= mass / body.volume <= HEAVIEST:
            yield (
                f"{body.body}:volume is {body.volume:.3g} m^3, and '{body.body}' has a mass of {mass:.3g} kg; is it in "
                "[m^3], and the mass in [kg]?"
            )
            continue  # its size is not known then
        index = model.body(body.body).id
        gyration = gyration_radius(model, index)
        if model.body_mass[index] > 0.0 and not NARROWEST <= gyration / np.cbrt(body.volume) <= WIDEST:
            yield (
                f"inertia of '{body.body}' is {' '.join(f'{each:.3g}' for each in model.body_inertia[index])} kg m^2 "
                f"about its principal axes, a radius of gyration of {gyration:.3g} m for {model.body_mass[index]:.3g} "
                f"kg, and it displaces {body.volume:.2g} m^3; is it in [kg m^2]?"
            )
            gyration = 0.0  # it is not known then
        away = float(np.linalg.norm(body.centre_of_buoyancy - model.body_ipos[index]))
        if away > FARTHEST * max(np.cbrt(body.volume), gyration):
            yield (
                f"{body.body}:centre_of_buoyancy is {away:.3g} m from the centre of mass of '{body.body}', which "
                f"displaces {body.volume:.2g} m^3; is it in [m]?"
            )


def _of_gravity(model: mujoco.MjModel) -> Iterator[str]:
    gravity, told = model.opt.gravity, " ".join(f"{each:g}" for each in model.opt.gravity)
    if gravity[2] > 0.0:
        yield f"gravity is {told} m/s^2 and points up, for the world's z axis does; 0 0 -9.81 points down"
    if (strength := float(np.linalg.norm(gravity))) > STRONGEST:
        yield f"gravity is {strength:g} m/s^2; that of the earth is 9.81; is it in [m/s^2]?"


def gyration_radius(model: mujoco.MjModel, body: int) -> float:
    """The largest radius of gyration of a body [m]; 0 of one without mass of its own."""
    mass = float(model.body_mass[body])
    return float(np.sqrt(model.body_inertia[body].max() / mass)) if mass > 0.0 else 0.0


def _masses(model: mujoco.MjModel, names: list[str]) -> dict[str, float]:
    """Body in the water -> mass of it and of what it carries that has no water of its own [kg]."""
    own = {model.body(name).id: name for name in names}
    masses, owners = dict.fromkeys(names, 0.0), [""] * model.nbody
    for i in range(1, model.nbody):  # parents come before what they carry
        owners[i] = own.get(i, owners[int(model.body_parentid[i])])
        if owners[i]:
            masses[owners[i]] += float(model.body_mass[i])
    return masses
