"""The fins of one vehicle, seen together: what turns them, and what they can do at the speed they have."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.vehicle.laws import fin as law
from cube_sim.vehicle.laws.body_lift import (
    COEFFICIENT,
    HULL,
    PRODUCT_COLUMNS,
    STRIP_COLUMNS,
    deflected_wrench,
)
from cube_sim.vehicle.plugin import layout, packing

ANGLES = 65
"""Deflections at which it is looked at what a fin makes over its travel."""


class FinsAtSpeed(NamedTuple):
    """What k fins do at one speed straight ahead, as the columns and limits of thrusters.

    Attributes:
        speed_m_s: through the water.
        matrix: (6,k) wrench for a newton of each [1, m]; zero at rest.
        limits: (k,4) least and largest force each makes over its travel, like [F_max-, F_DZ-, F_DZ+, F_max+] [N].
        angles: (k, `ANGLES`) deflections over its travel [rad].
        forces: (k, `ANGLES`) what each makes there [N].
    """

    speed_m_s: float
    matrix: NDArray[np.float64]
    limits: NDArray[np.float64]
    angles: NDArray[np.float64]
    forces: NDArray[np.float64]

    def limits_within(self, travel: NDArray[np.float64]) -> NDArray[np.float64]:
        """(k,4) limits [N] of fins that have less travel left.

        Args:
            travel: (k,2) least and largest deflection [rad]; where 0 is not between them, no force counts.
        """
        limits = self.limits.copy()
        for i, (low, high) in enumerate(travel.tolist()):
            angles, forces = self.angles[i], self.forces[i]
            if low <= angles[0] and high >= angles[-1]:
                continue
            left = [0.0]
            if low <= 0.0 <= high:
                left += np.interp([max(low, angles[0]), min(high, angles[-1])], angles, forces).tolist()
                left += forces[(angles >= low) & (angles <= high)].tolist()
            limits[i, 0], limits[i, 3] = min(left), max(left)
        return limits


@dataclass(frozen=True)
class Fins:
    """The k fins of a hull that have a servo, in the order of their sites.

    A fin's force depends on the flow, so it is no thruster: it has no limits in newtons. A controller asks for the
    `effectiveness` at the velocity of the moment, and has a linear actuation in deflections, within their travel.

    Attributes:
        names: (k,) of their servos.
        actuators: (k,) indices into ctrl, the angles wanted [rad].
        activations: (k,) indices into act, the deflections [rad].
        travel: (k,2) least and largest deflection [rad].
        lag_s: (k,) time constants of the servos [s].
        rate: (k,) how fast they turn at most [rad/s].
        table: (k, 16) the fins as `cube_sim.vehicle.laws.fin` has them.
        linear: (n, 6) products of velocities and a deflection, see `cube_sim.vehicle.laws.body_lift.deflected_wrench`.
        square: (n, 6) products of velocities and the square of one.
    """

    names: tuple[str, ...]
    actuators: NDArray[np.int_]
    activations: NDArray[np.int_]
    travel: NDArray[np.float64]
    lag_s: NDArray[np.float64]
    rate: NDArray[np.float64]
    table: NDArray[np.float64]
    linear: NDArray[np.float64]
    square: NDArray[np.float64]

    @staticmethod
    def from_model(model: mujoco.MjModel, hull: int = 0) -> Fins:
        """Read the fins of a hull.

        Args:
            model: made by `load_model`.
            hull: its number among the hulls of the model.

        Raises:
            ModelError: the model has no water.
        """
        _, _, table, linear, square = lift_tables(packing.packed_parameters(model))
        moved = np.flatnonzero((table[:, law.HULL] == hull) & (table[:, law.SERVO] >= 0.0))
        table, linear, square = table[moved], _of_fins(linear, moved), _of_fins(square, moved)
        activations = table[:, law.SERVO].astype(int)
        actuators = np.array([np.flatnonzero(model.actuator_actadr == a)[0] for a in activations], dtype=int)
        return Fins(
            names=tuple(model.actuator(i).name for i in actuators),
            actuators=actuators,
            activations=activations,
            travel=model.actuator_ctrlrange[actuators].copy(),
            lag_s=model.actuator_dynprm[actuators, 0].copy(),
            rate=model.actuator_dynprm[actuators, 1].copy(),
            table=table,
            linear=linear,
            square=square,
        )

    def wrench(self, deflections: ArrayLike, nu_r: ArrayLike) -> NDArray[np.float64]:
        """(6,) the wrench of all of them together [N, N m], body axes.

        Args:
            deflections: (k,) [rad].
            nu_r: (6,) velocity of the hull through the water [m/s, rad/s], body axes.
        """
        flow = tuple(np.asarray(nu_r, dtype=float).tolist())
        angles = np.asarray(deflections, dtype=float).tolist()
        each = [self._wrench(k, angle, flow) for k, angle in zip(range(len(self.table)), angles, strict=True)]
        return np.array(each).reshape(-1, 6).sum(axis=0)

    def at_speed(self, speed_m_s: float) -> FinsAtSpeed:
        """The fins as actuators whose force is asked for, for a hull that moves straight ahead.

        Args:
            speed_m_s: through the water.
        """
        ahead = np.array([speed_m_s, 0.0, 0.0, 0.0, 0.0, 0.0])
        k = len(self.names)
        still = np.zeros(k)
        slopes = self.effectiveness(still, ahead)
        force = np.linalg.norm(slopes[:3], axis=0)
        matrix = slopes / np.where(force > 0.0, force, 1.0)
        limits = np.zeros((k, 4))
        angles, forces = np.linspace(self.travel[:, 0], self.travel[:, 1], ANGLES, axis=1), np.zeros((k, ANGLES))
        for i in range(k):
            for j, angle in enumerate(angles[i].tolist()):
                more = self.wrench(np.where(np.arange(k) == i, angle, 0.0), ahead) - self.wrench(still, ahead)
                forces[i, j] = float(more[:3] @ matrix[:3, i])
            limits[i, 0], limits[i, 3] = min(0.0, *forces[i].tolist()), max(0.0, *forces[i].tolist())
        return FinsAtSpeed(speed_m_s, matrix, limits, angles, forces)

    def with_area(self, factor: float) -> Fins:
        """The same with so many times the area."""
        table = self.table.copy()
        table[:, law.HALF_DENSITY_AREA] *= factor
        linear, square = self.linear.copy(), self.square.copy()
        linear[:, COEFFICIENT] *= factor
        square[:, COEFFICIENT] *= factor
        return replace(self, table=table, linear=linear, square=square)

    def effectiveness(self, deflections: ArrayLike, nu_r: ArrayLike, step: float = 1e-4) -> NDArray[np.float64]:
        """(6,k) derivative of the wrench by each deflection [N/rad, N m/rad], at that flow.

        It is the actuation matrix of the fins: zero at rest, it grows with the square of the speed.

        Args:
            deflections: (k,) about which [rad].
            nu_r: (6,) velocity of the hull through the water [m/s, rad/s], body axes.
            step: of the central difference [rad].
        """
        flow = tuple(np.asarray(nu_r, dtype=float).tolist())
        columns = np.empty((6, len(self.names)))
        for k, angle in enumerate(np.asarray(deflections, dtype=float).tolist()):
            ahead, back = (self._wrench(k, angle + s, flow) for s in (step, -step))
            columns[:, k] = (ahead - back) / (2.0 * step)
        return columns

    def _wrench(self, k: int, angle: float, flow: tuple[float, ...]) -> NDArray[np.float64]:
        lift = law.fin_wrench(self.table[k], angle, flow)
        return np.add(lift, deflected_wrench(self.linear, self.square, k, angle, flow))


def lift_tables(packed: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """What lifts the hulls of a model, by its packed parameters.

    Products of velocities (n,6), strips (n,4), all fins (n,16), fixed ones too, and the products with a deflection and
    with its square (n,6).
    """
    start = int(packed[layout.LIFT])
    columns = PRODUCT_COLUMNS, STRIP_COLUMNS, law.COLUMNS, PRODUCT_COLUMNS, PRODUCT_COLUMNS
    counts = packed[start : start + len(columns)].astype(int).tolist() if start >= 0 else [0] * len(columns)
    start += len(columns)
    tables = []
    for count, width in zip(counts, columns, strict=True):
        tables.append(packed[start : start + count * width].reshape(count, width).copy())
        start += count * width
    return tuple(tables)


def _of_fins(products: NDArray[np.float64], fins: NDArray[np.int_]) -> NDArray[np.float64]:
    """The products of some fins, by their numbers among these."""
    kept = products[np.isin(products[:, HULL], fins)]
    kept[:, HULL] = np.searchsorted(fins, kept[:, HULL])
    return kept
