"""The thrusters of a hull read back from the compiled model."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.characteristic import Characteristic
from cube_sim.vehicle.plugin import layout
from cube_sim.vehicle.pulse import PulseRange
from cube_sim.vehicle.thrusters import Thrusters


def thrusters_of(model: mujoco.MjModel, packed: NDArray[np.float64], body: int) -> Thrusters:
    """The thrusters that push one hull, in the order of the model's actuators.

    Args:
        model: made by `load_model`.
        packed: its numbers.
        body: index of the hull.
    """
    actuators = [i for i in range(model.nu) if _pushes(model, packed, i, body)]
    starts = [int(packed[int(packed[layout.THRUSTERS]) + i]) for i in actuators]
    return Thrusters(
        names=tuple(model.actuator(i).name for i in actuators),
        actuators=np.array(actuators, dtype=int),
        characteristics=tuple(_characteristic(packed, start) for start in starts),
        power_coefficients=np.array([packed[start + layout.POWER :][:2] for start in starts]).reshape(-1, 2),
        lag_s=np.array([model.actuator_dynprm[i, 0] for i in actuators]),
        voltage=np.array([packed[start + layout.VOLTAGE] for start in starts]),
        pulse_ranges=tuple(_pulse_range(packed, start) for start in starts),
    )


def _pushes(model: mujoco.MjModel, packed: NDArray[np.float64], actuator: int, body: int) -> bool:
    if packed[int(packed[layout.THRUSTERS]) + actuator] < 0.0:
        return False
    site = model.actuator_trnid[actuator, 0]
    return bool(model.body_rootid[model.site_bodyid[site]] == body)


def _characteristic(packed: NDArray[np.float64], start: int) -> Characteristic:
    n = int(packed[start + layout.POINTS])
    curve = start + layout.CURVE
    return Characteristic(
        commands=packed[curve : curve + n],
        forces=packed[curve + n : curve + 2 * n],
        force_dead_zone=(float(packed[start + layout.ZONE_LOW]), float(packed[start + layout.ZONE_HIGH])),
    )


def _pulse_range(packed: NDArray[np.float64], start: int) -> PulseRange | None:
    widths = packed[start + layout.PULSE : start + layout.PULSE + 3]
    return None if np.isnan(widths[0]) else PulseRange(*widths.tolist())
