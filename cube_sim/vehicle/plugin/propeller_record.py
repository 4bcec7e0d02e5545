"""Propellers by their record in a compiled model: how it is written, and what a hull gets of them."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.laws import propeller as law
from cube_sim.vehicle.mjcf.propellers import PropellerParameters


def propeller_rows(
    propellers: Sequence[PropellerParameters | None], hulls: Sequence[str], curves: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The table (n, `law.COLUMNS`) of all propellers but for what `place_propellers` adds, and their points (k,).

    Args:
        propellers: one entry per actuator; None for one that is none.
        hulls: names of the hulls.
        curves: where the curve record of each actuator begins.
    """
    table, points, end = [], [np.zeros(0)], 0
    for actuator, each in enumerate(propellers):
        if each is None:
            continue
        row = np.zeros(law.COLUMNS)
        row[law.HULL], row[law.ACTUATOR], row[law.CURVE] = hulls.index(each.hull), actuator, curves[actuator]
        row[law.RHO_D3], row[law.DIAMETER] = each.density * each.diameter**3, each.diameter
        row[law.ADVANCE], row[law.DELIVERED], row[law.HAND] = 1.0 - each.wake, 1.0 - each.deduction, each.hand
        row[law.SPEEDS : law.SLOWEST], row[law.SLOWEST : law.ARM], row[law.ARM] = each.speeds, each.slowest, each.arm
        if (shaft := each.shaft) is not None:
            numbers = shaft.motor, shaft.resistance, shaft.inertia, shaft.dry, shaft.viscous, shaft.voltage
            row[law.MOTOR : law.DRIVE] = numbers
        row[law.DRIVE] = each.efficiency
        row[law.AHEAD : law.ASTERN] = end, len(each.ahead)
        row[law.ASTERN :] = end + each.ahead.size, len(each.astern)
        table.append(row)
        points += [each.ahead.ravel(), each.astern.ravel()]
        end += each.ahead.size + each.astern.size
    return np.array(table).reshape(-1, law.COLUMNS), np.concatenate(points)


def place_propellers(
    model: mujoco.MjModel, propellers: Sequence[PropellerParameters | None], rows: NDArray[np.float64]
) -> None:
    """Write into rows (n, `law.COLUMNS`) where propellers are on a compiled model, and where their rotors' states lie.

    Args:
        model: compiled.
        propellers: one entry per actuator; None for one that is none.
        rows: changed here.
    """
    for row in rows:
        actuator = int(row[law.ACTUATOR])
        each = propellers[actuator]
        assert each is not None
        site, axes = model.site(each.site), np.zeros(9)
        mujoco.mju_quat2Mat(axes, site.quat)
        row[law.ACTIVATION] = model.actuator_actadr[actuator] + model.actuator_actnum[actuator] - 1
        row[law.PLACE : law.AXIS], row[law.AXIS : law.RHO_D3] = site.pos, axes.reshape(3, 3)[:, 2]
