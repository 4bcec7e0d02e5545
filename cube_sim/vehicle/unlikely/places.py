"""Sites of thrusters, fins and ballast that lie far off their hull, and those that two thrusters push at."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

import mujoco
import numpy as np

from cube_sim.vehicle.mjcf.parameters import WaterParameters
from cube_sim.vehicle.mjcf.thruster_elements import is_thruster
from cube_sim.vehicle.unlikely.bodies import FARTHEST, gyration_radius


def unlikely_places(model: mujoco.MjModel, water: WaterParameters, sizes: Mapping[str, float]) -> Iterator[str]:
    """Sentences on sites on a hull, each once, of actuators and of fins that nothing turns.

    Args:
        model: made by `load_model`.
        water: as `water_of` reads it.
        sizes: as `sizes_of` returns them.
    """
    moved = [int(model.actuator_trnid[i, 0]) for i in range(model.nu) if is_thruster(model, i)]
    sites = [*moved, *(model.site(each.site).id for each in (*water.fins, *water.ballast))]
    for site in dict.fromkeys(sites):
        body = int(model.site_bodyid[site])
        hull = model.body(body).name
        if hull not in sizes:
            continue
        away = float(np.linalg.norm(model.site_pos[site] - model.body_ipos[body]))
        if away > FARTHEST * max(np.cbrt(sizes[hull]), gyration_radius(model, body)):
            yield (
                f"site '{model.site(site).name}' lies {away:.3g} m from the centre of mass of '{hull}', which "
                f"displaces {sizes[hull]:.2g} m^3; is its pos in [m]?"
            )
    yield from _shared(model, sizes)


def _shared(model: mujoco.MjModel, sizes: Mapping[str, float]) -> Iterator[str]:
    """Sentences on sites of two thrusters that push as one, but for pairs that turn against one another."""
    on: dict[int, list[int]] = {}
    for i in range(model.nu):
        if (
            is_thruster(model, i)
            and model.body(model.body_rootid[model.site_bodyid[model.actuator_trnid[i, 0]]]).name in sizes
        ):
            on.setdefault(int(model.actuator_trnid[i, 0]), []).append(i)
    for site, thrusters in on.items():
        for one, other in pairwise(thrusters):
            if model.actuator_gear[one, 5] * model.actuator_gear[other, 5] >= 0.0:
                yield (
                    f"thrusters '{model.actuator(one).name}' and '{model.actuator(other).name}' both push at site "
                    f"'{model.site(site).name}', and so along one line; has each a site of its own?"
                )
