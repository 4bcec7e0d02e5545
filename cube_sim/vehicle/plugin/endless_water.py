"""A model whose water has no surface, for what is read off it wherever it stands."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco
import numpy as np

from cube_sim.vehicle.plugin import layout, packing


@contextmanager
def endless_water(model: mujoco.MjModel) -> Iterator[None]:
    """The model in water that ends nowhere; afterwards its surface is where it was.

    At its reference pose a hull often lies in the surface, and would be read off half dry.

    Args:
        model: made by `load_model`; changed while the context lasts.

    Raises:
        ModelError: the model has no water.
    """
    packed = packing.packed_parameters(model)
    surface = packed[layout.SURFACE]
    packed[layout.SURFACE] = np.inf
    try:
        yield
    finally:
        packed[layout.SURFACE] = surface
