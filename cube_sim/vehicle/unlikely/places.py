"""Sites of thrusters, fins and ballast that lie far off their hull."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

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
