"""What a compiled model says of its water: its numerics, read again as its file's were."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.mjcf.parameters import WaterParameters, read_parameters
from cube_sim.vehicle.mjcf.thruster_elements import is_thruster, thruster_element
from cube_sim.vehicle.plugin import layout, packing


def water_of(model: mujoco.MjModel, numerics: Mapping[str, NDArray[np.float64]] | None = None) -> WaterParameters:
    """What the numerics say of a compiled model's elements.

    Args:
        model: made by `load_model`.
        numerics: name -> values (n,) in place of all that the model has.

    Raises:
        ModelError: they make no sense.
    """
    if numerics is None:
        numerics = {each.name: each.data for each in map(model.numeric, range(model.nnumeric - 1))}
    named = [i for i in range(1, model.nbody) if model.body(i).name]
    bodies = {model.body(i).name: _carrier(model, i) for i in named}
    thrusters = [thruster_element(model, i) if is_thruster(model, i) else None for i in range(model.nu)]
    sites = {
        model.site(i).name: model.body(model.site_bodyid[i]).name for i in range(model.nsite) if model.site(i).name
    }
    packed = packing.packed_parameters(model)
    table = packed[int(packed[layout.THRUSTERS]) :][: model.nu]

    def moved(kind: int) -> dict[str, int]:
        return {model.site(model.actuator_trnid[i, 0]).name: int(i) for i in np.flatnonzero(table == kind)}

    servos, pumps = moved(layout.FIN_SERVO), moved(layout.BALLAST_STATE)
    return read_parameters(numerics, bodies, thrusters, sites, servos, pumps)


def _carrier(model: mujoco.MjModel, body: int) -> str | None:
    """Name of the free body of the world that a body is, or that carries it; None where there is none."""
    root = int(model.body_rootid[body])
    first, count = model.body_jntadr[root], model.body_jntnum[root]
    free = count == 1 and model.jnt_type[first] == mujoco.mjtJoint.mjJNT_FREE
    return model.body(root).name if free else None
