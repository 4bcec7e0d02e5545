"""Forces from outside on the hulls of a model while it is used, by the table that `load_model` keeps room for."""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.vehicle.laws.push import COLUMNS
from cube_sim.vehicle.plugin import layout, packing

Triple = tuple[float, float, float]


class Push(NamedTuple):
    """A force and a torque on a hull that set in, hold and fade.

    Attributes:
        force: [N].
        torque: [N m].
        point: at which the force acts, from the body origin in body axes [m].
        in_body: whether both turn with the hull; else they keep their directions in the world.
        start_s: when it sets in [s].
        ramp_s: in which time it grows, and fades in the end [s].
        end_s: when it has faded [s].
    """

    force: Triple = (0.0, 0.0, 0.0)
    torque: Triple = (0.0, 0.0, 0.0)
    point: Triple = (0.0, 0.0, 0.0)
    in_body: bool = False
    start_s: float = 0.0
    ramp_s: float = 0.0
    end_s: float = inf


def push_table(model: mujoco.MjModel) -> NDArray[np.float64] | None:
    """(n, `COLUMNS`) the pushes of a model, see `cube_sim.vehicle.laws.push`: a view; None where it has no room."""
    packed = packing.packed_parameters(model)
    start = int(packed[layout.PUSHES])
    if start < 0:
        return None
    n = int(packed[start])
    return packed[start + 1 : start + 1 + n * COLUMNS].reshape(n, COLUMNS)


def hull_number(model: mujoco.MjModel, body: int) -> int:
    """Which of the model's hulls a body is, as its table of pushes counts them.

    Raises:
        ModelError: it is no hull.
    """
    packed = packing.packed_parameters(model)
    start = int(packed[layout.HULLS])
    for k in range(int(packed[layout.COUNT])):
        if int(packed[start + k * layout.HULL_SIZE + layout.BODY]) == body:
            return k
    raise ModelError(model.body(body).name, "is no hull")


def set_push(model: mujoco.MjModel, row: int, body: int, push: Push) -> None:
    """Let a hull be pushed. Every MjData that steps the model sees it from its next step on.

    Args:
        model: made by `load_model` with room for pushes; changed here.
        row: of the table.
        body: index of the hull.
        push: what pushes.

    Raises:
        ModelError: there is no such row, or the body is no hull.
    """
    table = push_table(model)
    if table is None or not 0 <= row < len(table):
        raise ModelError("", f"has room for {0 if table is None else len(table)} pushes, none for number {row}")
    fades = max(push.start_s + push.ramp_s, push.end_s - push.ramp_s)
    times = push.start_s, push.start_s + push.ramp_s, fades, push.end_s
    table[row] = (hull_number(model, body), push.in_body, *push.point, *push.force, *push.torque, *times)
