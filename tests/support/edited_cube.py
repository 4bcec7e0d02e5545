"""The CUBE's file with a few words changed."""

from __future__ import annotations

import mujoco

from cube_sim.vehicle.plugin.warnings import collect_warnings
from support.places import CUBE

T1 = '<general name="T1" class="thruster" site="T1"'
"""Its first thruster, without the end of the element."""


def edited_text(*replacements: tuple[str, str]) -> str:
    """MJCF in which every old text, which has to be there, is the new one."""
    xml = CUBE.read_text()
    for old, new in replacements:
        assert old in xml
        xml = xml.replace(old, new)
    return xml


def edited(*replacements: tuple[str, str]) -> mujoco.MjSpec:
    """The same, parsed; MuJoCo's warnings about values that are not finite are swallowed."""
    with collect_warnings():
        return mujoco.MjSpec.from_string(edited_text(*replacements))
