"""What the flow lifts of a hull, made into products of two velocities for those who reckon with it.

Manoeuvring derivatives are such products. A fin that is not deflected is one as long as it does not stall and meets the
flow nearly along its chord; the strips of a hull are fitted. What this leaves out is part of what a controller does not
know beforehand.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.fins import lift_tables
from cube_sim.vehicle.laws import body_lift, fin
from cube_sim.vehicle.mjcf.body_lift import CORIOLIS, coriolis_products
from cube_sim.vehicle.plugin import layout, packing

if TYPE_CHECKING:
    from cube_sim.vehicle.dynamics import Dynamics

Tensor = NDArray[np.float64]
GRID = np.linspace(-1.0, 1.0, 21)
"""Shares of speed and rate at which the strips are fitted (a choice)."""


@dataclass(frozen=True)
class HullLift:
    """What the flow lifts of one hull, F_i = sum P_ijk nu_j nu_k + Q_ijk nu_j |nu_k|, body axes.

    Attributes:
        products: P (6,6,6) of its table; what the switch of the added mass's Coriolis terms leaves out is not in it.
        absolute: Q (6,6,6) of its table and of its strips.
        fins: Q (6,6,6) of its fins, not deflected.
        holds_coriolis: whether its table has Munk moment and Coriolis terms of the added mass in it.
        of_links: added mass (6,6) of links, whose such terms are in no table.
    """

    products: Tensor
    absolute: Tensor
    fins: Tensor
    holds_coriolis: bool
    of_links: NDArray[np.float64]

    @staticmethod
    def from_model(
        model: mujoco.MjModel, hull: int, added_mass: NDArray[np.float64], of_links: NDArray[np.float64]
    ) -> HullLift | None:
        """Read it off a model; None for a hull that has none.

        Args:
            model: made by `load_model`.
            hull: its number among the hulls of the model.
            added_mass: M_A (6,6) of it with all it carries.
            of_links: what of that is of links.
        """
        packed = packing.packed_parameters(model)
        products, strips, fins = (_of(table, hull) for table in lift_tables(packed)[:3])
        if not (len(products) or len(strips) or len(fins)):
            return None
        body = int(packed[int(packed[layout.HULLS]) + hull * layout.HULL_SIZE + layout.BODY])
        name = f"{model.body(body).name}:{CORIOLIS}"
        numerics = {model.numeric(i).name for i in range(model.nnumeric)}
        holds = name in numerics and float(model.numeric(name).data[0]) == 0.0
        signed, absolute = np.zeros((6, 6, 6)), _of_strips(strips)
        for row in products:
            i, j, k = (int(row[c]) for c in (body_lift.AXIS, body_lift.FIRST, body_lift.SECOND))
            (absolute if row[body_lift.ABSOLUTE] else signed)[i, j, k] += row[body_lift.COEFFICIENT]
        if holds:
            signed -= coriolis_of(added_mass - of_links)
        return HullLift(signed, absolute, sum(map(_of_fin, fins), np.zeros((6, 6, 6))), holds, of_links)

    def known_as(self, dynamics: Dynamics, drag: float = 1.0, fins: float = 1.0) -> Dynamics:
        """A hull's equations of motion with this lift in them.

        Args:
            dynamics: the others of its numbers.
            drag: factor on what its tables say.
            fins: factor on the area of its fins.
        """
        from dataclasses import replace

        signed = drag * self.products
        if self.holds_coriolis:
            signed = signed + coriolis_of(dynamics.added_mass - self.of_links)
        return replace(dynamics, velocity_products=signed, absolute_products=drag * self.absolute + fins * self.fins)


def coriolis_of(added_mass: NDArray[np.float64]) -> Tensor:
    """P (6,6,6) of +C_A(nu) nu, which takes the Coriolis terms of an added mass (6,6) out again."""
    P = np.zeros((6, 6, 6))
    for i, j, k, coefficient in coriolis_products(added_mass):
        P[i, j, k] += coefficient
    return P


def _of(table: NDArray[np.float64], hull: int) -> NDArray[np.float64]:
    """The rows of one hull, whose number stands in the first column."""
    return table[table[:, 0] == hull]


def _of_fin(row: NDArray[np.float64]) -> Tensor:
    """Q (6,6,6) of a fin that is not deflected: -rho S/2 (a |u| n along the normal + C_D0 |u| u along the chord)."""
    place, chord, normal = (row[c : c + 3] for c in (fin.PLACE, fin.CHORD, fin.NORMAL))
    ahead = int(np.argmax(np.abs(chord)))
    Q = np.zeros((6, 6, 6))
    for axis, coefficient in ((normal, row[fin.SLOPE]), (chord, row[fin.DRAG])):
        along = np.concatenate([axis, np.cross(place, axis)])
        Q[:, :, ahead] -= row[fin.HALF_DENSITY_AREA] * coefficient * abs(chord[ahead]) * np.outer(along, along)
    return Q


def _of_strips(strips: NDArray[np.float64]) -> Tensor:
    """Q (6,6,6) of the flow across a hull, in one plane at a time: fitted by v|v|, v|r|, r|v| and r|r|."""
    Q = np.zeros((6, 6, 6))
    if not len(strips):
        return Q
    reach = float(np.max(np.abs(strips[:, body_lift.STATION])))
    for speed, rate in ((1, 5), (2, 4)):
        pairs = [(speed, speed), (speed, rate), (rate, speed), (rate, rate)]
        rows, wrenches = [], []
        for v in GRID:
            for r in GRID / reach:
                nu = np.zeros(6)
                nu[speed], nu[rate] = v, r
                rows.append([nu[j] * abs(nu[k]) for j, k in pairs])
                wrenches.append(body_lift.strips_wrench(strips, strips[0, 0], tuple(nu.tolist())))
        fitted, _, _, _ = np.linalg.lstsq(np.array(rows), np.array(wrenches), rcond=None)
        for (j, k), column in zip(pairs, fitted, strict=True):
            Q[:, j, k] += column
    return Q
