"""Hulls and links, and the water, whose numbers are most likely in another unit."""

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


def unlikely_bodies(model: mujoco.MjModel, water: WaterParameters) -> Iterator[str]:
    """Sentences on the volumes and centres of buoyancy of hulls and links, and on the density of the water.

    Args:
        model: made by `load_model`.
        water: as `water_of` reads it.
    """
    if not THINNEST <= water.density <= DENSEST:
        yield f"{DENSITY} is {water.density:g} kg/m^3; fresh water has 1000; is it in [kg/m^3]?"
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
        away = float(np.linalg.norm(body.centre_of_buoyancy - model.body_ipos[index]))
        if away > FARTHEST * max(np.cbrt(body.volume), gyration_radius(model, index)):
            yield (
                f"{body.body}:centre_of_buoyancy is {away:.3g} m from the centre of mass of '{body.body}', which "
                f"displaces {body.volume:.2g} m^3; is it in [m]?"
            )


def gyration_radius(model: mujoco.MjModel, body: int) -> float:
    """The largest radius of gyration of a body [m]."""
    return float(np.sqrt(model.body_inertia[body].max() / model.body_mass[body]))


def _masses(model: mujoco.MjModel, names: list[str]) -> dict[str, float]:
    """Body in the water -> mass of it and of what it carries that has no water of its own [kg]."""
    own = {model.body(name).id: name for name in names}
    masses, owners = dict.fromkeys(names, 0.0), [""] * model.nbody
    for i in range(1, model.nbody):  # parents come before what they carry
        owners[i] = own.get(i, owners[int(model.body_parentid[i])])
        if owners[i]:
            masses[owners[i]] += float(model.body_mass[i])
    return masses
