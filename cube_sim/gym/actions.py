"""What an agent's numbers between -1 and 1 ask of a vehicle."""

from __future__ import annotations

from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import FlightError
from cube_sim.spatial import Vector
from cube_sim.vehicle.vehicle import Vehicle

ActionKind = Literal["wrench", "forces", "commands"]


class ActionScale(NamedTuple):
    """Between numbers from -1 to 1 and what `Flight.step` takes; 0 is nothing, each side has a scale of its own.

    Attributes:
        kind: wrench: (6,) [N, N m], body axes, to be allocated; forces: (m,) [N] of the thrusters; commands: (m,)
            normalised commands.
        low: (n,) what -1 stands for. Of a wrench: each component's least among all wrenches the thrusters can make,
            whatever comes along with it.
        high: (n,) what 1 stands for.
    """

    kind: ActionKind
    low: Vector
    high: Vector

    @staticmethod
    def of(kind: str, vehicle: Vehicle) -> ActionScale:
        """The scale of a vehicle whose thrusters are whole.

        Raises:
            FlightError: there is no such kind.
        """
        limits, A = vehicle.thrusters.limits, vehicle.actuation_matrix
        least, most = limits[:, 0], limits[:, 3]
        match kind:
            case "wrench":
                ends = A * least, A * most
                return ActionScale("wrench", np.minimum(*ends).sum(axis=1), np.maximum(*ends).sum(axis=1))
            case "forces":
                return ActionScale("forces", least, most)
            case "commands":
                return ActionScale("commands", -np.ones(len(limits)), np.ones(len(limits)))
        raise FlightError(f"no action '{kind}'; there are {', '.join(get_args(ActionKind))}")

    def asked(self, action: ArrayLike) -> Vector:
        """(n,) in the units of `low` and `high`; what lies beyond -1 and 1 is cut.

        Raises:
            FlightError: the action has another shape.
        """
        share = np.asarray(action, dtype=np.float64)
        if share.shape != self.low.shape:
            wanted = "1 number" if len(self.low) == 1 else f"{len(self.low)} numbers"
            raise FlightError(f"the action has shape {share.shape}; it takes {wanted}, {self.low.shape}")
        share = np.clip(share, -1.0, 1.0)
        return np.where(share < 0.0, -share * self.low, share * self.high)

    def share(self, asked: ArrayLike) -> Vector:
        """(n,) from -1 to 1, of what is asked: the inverse; 0 where nothing can be had."""
        value = np.asarray(asked, dtype=np.float64)
        end = np.where(value < 0.0, -self.low, self.high)
        share = np.divide(value, end, out=np.zeros_like(value), where=end > 0.0)
        return np.minimum(np.maximum(share, -1.0), 1.0)
