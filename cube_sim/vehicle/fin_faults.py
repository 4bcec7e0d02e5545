"""Faults of the fins of a model while it is used, without compiling it again.

As in `cube_sim.vehicle.faults` each function writes a few numbers inside the model, which every MjData that steps it
sees from its next step on. What a fin has had before is over: of one fin there is one fault.
"""

from __future__ import annotations

from math import inf

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import among
from cube_sim.vehicle.laws import servo_fault as law
from cube_sim.vehicle.plugin import layout, packing


def jam_fin(model: mujoco.MjModel, fin: str, angle_rad: float | None = None) -> None:
    """Let a fin stand still whatever it is told.

    Args:
        model: made by `load_model`; changed here.
        fin: name of the actuator that turns it.
        angle_rad: that it goes to, at its servo's rate, and stays at [rad]; None for where it is.

    Raises:
        ModelError: no such fin, or an angle outside its travel.
    """
    row = _row(model, fin)
    if angle_rad is None:
        _put(row, fastest=0.0)
        return
    low, high = model.actuator_ctrlrange[int(row[law.ACTUATOR])]
    if not low <= angle_rad <= high:
        raise ModelError(fin, f"cannot jam at {angle_rad:g} rad; it turns from {low:g} to {high:g} rad")
    _put(row, target=angle_rad)


def slow_fin(model: mujoco.MjModel, fin: str, rate_rad_s: float) -> None:
    """Let a fin turn no faster than a rate [rad/s].

    Raises:
        ModelError: no such fin, or a rate that is not positive.
    """
    if not 0.0 < rate_rad_s < inf:
        raise ModelError(fin, f"turns by {rate_rad_s:g} rad/s at most; a positive rate is right, or jam it")
    _put(_row(model, fin), fastest=rate_rad_s)


def shorten_travel(model: mujoco.MjModel, fin: str, least_rad: float, most_rad: float) -> None:
    """Let a fin turn within an angle only; one that is beyond goes back.

    Args:
        model: made by `load_model`; changed here.
        fin: name of the actuator that turns it.
        least_rad: least deflection left [rad].
        most_rad: largest.

    Raises:
        ModelError: no such fin, or an empty travel.
    """
    if not least_rad < most_rad:
        raise ModelError(fin, f"is to turn from {least_rad:g} to {most_rad:g} rad; increasing angles are right")
    _put(_row(model, fin), least=least_rad, most=most_rad)


def loosen_fin(model: mujoco.MjModel, fin: str) -> None:
    """Let a fin follow the flow, without lift.

    Raises:
        ModelError: no such fin.
    """
    _put(_row(model, fin), loose=1.0)


def repair_fin(model: mujoco.MjModel, fin: str) -> None:
    """Let a fin do what it is told again.

    Raises:
        ModelError: no such fin.
    """
    _put(_row(model, fin))


def servo_rows(packed: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n,7) the servos of a model, as `cube_sim.vehicle.laws.servo_fault` has them: a view, to read and to write."""
    start = int(packed[layout.SERVOS])
    count = int(packed[start]) if start >= 0 else 0
    return packed[start + 1 : start + 1 + count * law.COLUMNS].reshape(count, law.COLUMNS)


def _row(model: mujoco.MjModel, fin: str) -> NDArray[np.float64]:
    rows = servo_rows(packing.packed_parameters(model))
    for row in rows:
        if model.actuator(int(row[law.ACTUATOR])).name == fin:
            return row
    names = [model.actuator(int(row[law.ACTUATOR])).name for row in rows]
    raise ModelError(fin, f"turns no fin; the model has {among(fin, names) if names else 'no fin that a servo turns'}")


def _put(
    row: NDArray[np.float64],
    *,
    target: float = np.nan,
    fastest: float = inf,
    least: float = -inf,
    most: float = inf,
    loose: float = 0.0,
) -> None:
    row[law.TARGET :] = target, fastest, least, most, loose
