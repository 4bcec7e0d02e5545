"""The variable ballast of one vehicle, seen together: what pumps it, and what it can lift and weigh."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.laws import ballast as law
from cube_sim.vehicle.plugin import layout, packing


@dataclass(frozen=True)
class Ballast:
    """The k bladders and tanks of a hull, in the order of their sites.

    Attributes:
        names: (k,) of their pumps.
        actuators: (k,) indices into ctrl, the volumes wanted [m^3].
        activations: (k,) indices into act, the volumes [m^3].
        travel: (k,2) least and largest volume [m^3].
        rate: (k,) how fast they are pumped at most [m^3/s].
        table: (k,9) as `cube_sim.vehicle.laws.ballast` has them.
    """

    names: tuple[str, ...]
    actuators: NDArray[np.int_]
    activations: NDArray[np.int_]
    travel: NDArray[np.float64]
    rate: NDArray[np.float64]
    table: NDArray[np.float64]

    @staticmethod
    def from_model(model: mujoco.MjModel, hull: int = 0) -> Ballast:
        """Read the ballast of a hull.

        Args:
            model: made by `load_model`.
            hull: its number among the hulls of the model.

        Raises:
            ModelError: the model has no water.
        """
        table = ballast_rows(packing.packed_parameters(model))
        table = table[table[:, law.HULL] == hull]
        actuators = table[:, law.ACTUATOR].astype(int)
        return Ballast(
            names=tuple(model.actuator(i).name for i in actuators),
            actuators=actuators,
            activations=table[:, law.STATE].astype(int),
            travel=model.actuator_ctrlrange[actuators].copy(),
            rate=model.actuator_dynprm[actuators, 1].copy(),
            table=table,
        )

    @property
    def lift_per_volume(self) -> NDArray[np.float64]:
        """(k,) by how much a cubic metre of each makes the hull lighter under water [kg/m^3]."""
        return self.table[:, law.LIFT] - self.table[:, law.DENSITY]


def ballast_rows(packed: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n,9) all ballast of a model, by its packed parameters, as `cube_sim.vehicle.laws.ballast` has it."""
    start = int(packed[layout.BALLAST])
    count = int(packed[start]) if start >= 0 else 0
    return packed[start + 1 : start + 1 + count * law.COLUMNS].reshape(count, law.COLUMNS).copy()
