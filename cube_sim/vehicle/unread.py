"""Numbers that somebody wrote into a compiled model, where nothing reads them."""

from __future__ import annotations

import warnings

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.plugin import layout

_ROUNDING = 1e-9
_READ = {
    "centre_of_buoyancy": slice(layout.CENTRE, layout.ADDED_MASS),
    "added_mass": slice(layout.ADDED_MASS, layout.LINEAR),
    "linear_damping": slice(layout.LINEAR, layout.QUADRATIC),
    "quadratic_damping": slice(layout.QUADRATIC, layout.FORCE),
}
"""Numerics of a hull, and what its record was made from them; matrices lie there column by column."""


def warn_of_unread(model: mujoco.MjModel, hull: str, record: NDArray[np.float64]) -> None:
    """Warn of each numeric of a hull that is not what the water acts by.

    Args:
        model: made by `load_model`.
        hull: its name.
        record: the hull's, of the packed values.
    """
    for parameter, where in _READ.items():
        index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_NUMERIC, f"{hull}:{parameter}")
        if index < 0:
            continue
        written, read = _whole(model.numeric(index).data), record[where]
        if written.size != read.size or not np.allclose(written, read, _ROUNDING, _ROUNDING * np.abs(read).max()):
            name = f"{hull}:{parameter}"
            warnings.warn(
                f"{name} was changed in the compiled model, where nothing reads it: "
                f"cube_sim.set_parameters(model, {{'{name}': ...}}) changes what the water does",
                stacklevel=3,
            )


def _whole(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """As a record has it: a diagonal (6,) as a matrix, and a matrix column by column."""
    if values.size == 6:
        return np.diag(values).ravel()
    return values.reshape(6, 6).T.ravel() if values.size == 36 else values
