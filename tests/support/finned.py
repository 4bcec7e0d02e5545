"""A drawn torpedo: the hull of models/torpedo.xml with fins in place of the thrusters that turn it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from support.places import MODELS

TURNING = r'\n *<(?:site|general) name="(?:rudder|elevator)" class="thruster".*?/>'
FIN = (
    '<numeric name="{name}:fin_area" data="{area}"/><numeric name="{name}:fin_aspect_ratio" data="3"/>'
    '<numeric name="{name}:fin_stall" data="0.3"/><numeric name="{name}:fin_drag" data="0.01 0.9"/>'
)
SIDE = {
    "bow": ("0.6 0 0", "0 1 0"),
    "stern": ("-0.6 0 0", "0 1 0"),
    "fore": ("0.6 0 0", "0 0 1"),
    "aft": ("-0.6 0 0", "0 0 1"),
}


def x_tail(area: float = 0.012, bow_planes: bool = False, side_thrusters: bool = False, makes_roll: bool = True) -> str:
    """MJCF text: four fins astern at 45 degrees, of such areas [m^2], with stall, and what is asked for besides.

    Without roll a rudder and a stern plane, on the hull's axis.
    """
    fins, out = [], 0.13 if makes_roll else 0.0
    four = (("x1", 45.0), ("x2", 135.0), ("x3", 225.0), ("x4", 315.0))
    for name, angle in four if makes_roll else (("plane", 0.0), ("rudder", 90.0)):
        span = np.array([0.0, np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        fins.append((name, np.array([-0.8, 0.0, 0.0]) + out * span, span))
    if bow_planes:
        fins.append(("bow_planes", np.array([0.6, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])))
    sites = servos = numbers = ""
    for name, place, span in fins:
        at, along = (" ".join(f"{number:.9g}" for number in each) for each in (place, span))
        sites += f'<site name="{name}" pos="{at}" xyaxes="1 0 0 {along}"/>'
        servos += f'<general name="{name}" site="{name}" dyntype="user" dynprm="0.08 1" gainprm="0" '
        servos += 'ctrllimited="true" ctrlrange="-0.35 0.35"/>'
        numbers += FIN.format(name=name, area=area)
    for name, (place, axis) in SIDE.items() if side_thrusters else ():
        sites += f'<site name="{name}" class="thruster" pos="{place}" zaxis="{axis}"/>'
        servos += f'<general name="{name}" class="thruster" site="{name}"/>'
    text = re.sub(TURNING, "", (MODELS / "torpedo.xml").read_text())
    if not side_thrusters:  # nothing is left that the hull's own numbers are for
        text = re.sub(r'\n *<numeric name="hull:thruster_.*?/>', "", text)
    for end, more in (("</custom>", numbers), ("</body>", sites), ("</actuator>", servos)):
        text = text.replace(end, f"{more}{end}", 1)
    return text


def mission_of(model: Path) -> dict[str, Any]:
    """A minute along a line at 1.5 m/s, of a vehicle whose file this is."""
    return {
        "schema_version": 1,
        "name": "x_tail",
        "model": str(model),
        "duration_s": 60,
        "path": {"type": "line", "start_m": [0, 0, -10], "end_m": [200, 0, -10]},
        "initial": {"position_m": [0, 0.5, -10], "velocity_m_s": [1.5, 0, 0]},
        "guidance": {"speed_m_s": 1.5},
        "checks": [{"kind": "allowed_forces"}],
    }
