"""What a model has of a parameter that a scenario may give another value, and factors on it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import among
from cube_sim.scenario.values import Numbers
from cube_sim.vehicle.mjcf.elements import ELEMENT_PARAMETERS, element_values
from cube_sim.vehicle.vehicle import hull_names


def parameter_values(name: str, given: Mapping[str, Numbers], model: mujoco.MjModel) -> NDArray[np.float64]:
    """Its values (n,), as the scenario has them; of a lag one for each thruster that it is of.

    Args:
        name: of a custom numeric, or of what the elements say.
        given: values in place of the model's.
        model: compiled, with those in it.

    Raises:
        ModelError: there is no such parameter; says which there are.
    """
    if name in given:
        return np.array(given[name])
    if (values := element_values(model, name)) is not None:
        return values
    names = [model.numeric(i).name for i in range(model.nnumeric)]
    if name not in names:
        listed = [each for each in names if ":" in each and not each.startswith("cube_sim")]
        listed += [f"{hull}:{each}" for hull in hull_names(model) for each in ELEMENT_PARAMETERS]
        raise ModelError(name, f"no '{name}'; the model has {among(name, listed)}")
    return np.array(model.numeric(name).data, dtype=np.float64)


def factors_on(name: str, numbers: NDArray[np.float64], drawn: Any) -> NDArray[np.float64]:
    """One for each number (n,); one factor on a characteristic is on its forces, and its commands stay."""
    factors = np.broadcast_to(np.asarray(drawn, dtype=np.float64), numbers.shape).copy()
    if np.ndim(drawn) == 0 and name.endswith(":thruster_characteristic"):
        factors[0::2] = 1.0
    return factors
