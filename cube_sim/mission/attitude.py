"""The attitude a scenario's `control.attitude` block asks for, and whether it gives way to the path."""

from __future__ import annotations

from typing import assert_never

import numpy as np

from cube_sim.control.along_path import AlongPath
from cube_sim.control.attitude_mode import AttitudeMode
from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.free_attitude import FreeAttitude
from cube_sim.control.look_at import LookAt
from cube_sim.scenario import attitude_blocks as blocks
from cube_sim.scenario.schema import ControlBlock
from cube_sim.spatial import quaternion_from_euler
from cube_sim.vehicle.dynamics import Dynamics

FREE_SLOWNESS = 3.0
"""How many times slower than its attitude loop a free vehicle looks for its attitude."""


def attitude_of(block: blocks.NamedAttitude, dynamics: Dynamics, attitude_time_s: float) -> AttitudeMode:
    """The rule for the desired attitude.

    Args:
        block: the scenario's.
        dynamics: what the controller knows of the vehicle.
        attitude_time_s: of the attitude loop [s].
    """
    match block:
        case blocks.AlongPathBlock():
            return AlongPath()
        case blocks.FixedAttitudeBlock():
            return FixedAttitude(quaternion_from_euler(*np.radians(block.attitude_deg)))
        case blocks.FreeAttitudeBlock():
            return FreeAttitude(dynamics, FREE_SLOWNESS * attitude_time_s)
        case blocks.LookAtBlock():
            axis = np.array(block.axis)
            return LookAt(np.array(block.point_m), axis / np.linalg.norm(axis), block.near_m, attitude_time_s)
        case _:
            assert_never(block)


def is_path_first(control: ControlBlock) -> bool:
    """Whether the attitude is the secondary task."""
    if control.priority is not None:
        return control.priority == "path"
    return isinstance(control.attitude, blocks.FreeAttitudeBlock | blocks.LookAtBlock)
