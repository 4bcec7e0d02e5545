"""What is worth a word about the numbers of a model, part by part."""

from __future__ import annotations

from dataclasses import replace

import mujoco

from cube_sim.vehicle.compiled_water import water_of
from cube_sim.vehicle.mjcf.parameters import WaterParameters
from cube_sim.vehicle.unlikely.ballast import unlikely_ballast
from cube_sim.vehicle.unlikely.bodies import unlikely_bodies
from cube_sim.vehicle.unlikely.fins import unlikely_fins
from cube_sim.vehicle.unlikely.places import unlikely_places
from cube_sim.vehicle.unlikely.propellers import unlikely_propellers
from cube_sim.vehicle.unlikely.servos import unlikely_servos
from cube_sim.vehicle.unlikely.sizes import sizes_of


def unlikely_words(model: mujoco.MjModel, hull: str | None = None) -> list[str]:
    """Sentences on the numbers that are most likely not meant; each names the part, the number and its unit.

    Args:
        model: made by `load_model`; read as it is now.
        hull: whose alone; None: those of all.

    Raises:
        ModelError: the model has no water.
    """
    water = water_of(model) if hull is None else _of_one(water_of(model), hull)
    sizes = sizes_of(water)
    return [
        *unlikely_bodies(model, water),
        *unlikely_places(model, water, sizes),
        *unlikely_fins(model, water.fins, sizes),
        *unlikely_ballast(model, water, sizes),
        *unlikely_propellers(water, sizes),
        *unlikely_servos(model, [each.body for each in water.hulls]),
    ]


def _of_one(water: WaterParameters, hull: str) -> WaterParameters:
    """The same of one hull and what it carries alone."""
    return replace(
        water,
        hulls=tuple(each for each in water.hulls if each.body == hull),
        links=tuple(each for each in water.links if each.hull == hull),
        fins=tuple(each for each in water.fins if each.hull == hull),
        ballast=tuple(each for each in water.ballast if each.hull == hull),
        thrusters=tuple(
            each for each in water.thrusters if each and (each.propeller is None or each.propeller.hull == hull)
        ),
    )
