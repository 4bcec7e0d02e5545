"""A vehicle of four thrusters with a bladder, a tank and a battery that slides, and a mission of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

MODEL = """<mujoco model="ballasted">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="0.01" integrator="RK4" gravity="0 0 -9.81"/>
  <custom>
    <numeric name="water:density" data="1000"/>
    <numeric name="hull:volume" data="0.054"/>
    <numeric name="hull:added_mass" data="5 60 60 0.5 8 8"/>
    <numeric name="hull:linear_damping" data="3 20 20 2 10 10"/>
    <numeric name="hull:quadratic_damping" data="10 200 200 4 30 30"/>
    <numeric name="hull:thruster_characteristic" data="-1 -20 0 0 1 20"/>
    <numeric name="hull:thruster_dead_zone" data="0 0"/>
    <numeric name="bladder:ballast_displaces" data="1"/>
    <numeric name="tank:ballast_density" data="1000"/>
  </custom>
  <default><general gear="0 0 1 0 0 0" gainprm="0"/></default>
  <worldbody>
    <body name="hull">
      <freejoint name="hull"/>
      <inertial pos="0 0 -0.03" mass="50" diaginertia="0.6 9 9"/>
      <geom type="capsule" size="0.1 0.5" zaxis="1 0 0"/>
      <site name="bladder" pos="0.1 0 0" size="0.05"/>
      <site name="tank" pos="-0.2 0 0" size="0.05"/>
      <site name="port" pos="-0.5 0.1 0" zaxis="1 0 0"/>
      <site name="starboard" pos="-0.5 -0.1 0" zaxis="1 0 0"/>
      <site name="bow" pos="0.4 0 0" zaxis="0 0 1"/>
      <site name="stern" pos="-0.4 0 0" zaxis="0 0 1"/>
      <body name="battery">
        <joint name="slide" type="slide" axis="1 0 0" range="-0.3 0.3"/>
        <inertial pos="0 0 0" mass="4" diaginertia="0.01 0.01 0.01"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <general name="port" site="port" dyntype="filter" dynprm="0.1" biastype="user"/>
    <general name="starboard" site="starboard" dyntype="filter" dynprm="0.1" biastype="user"/>
    <general name="bow" site="bow" dyntype="filter" dynprm="0.1" biastype="user"/>
    <general name="stern" site="stern" dyntype="filter" dynprm="0.1" biastype="user"/>
    <general name="bladder" site="bladder" dyntype="user" dynprm="0.5 5e-5" ctrlrange="-1e-3 1e-3"/>
    <general name="tank" site="tank" dyntype="user" dynprm="0.5 1e-4" ctrlrange="0 2e-3"/>
    <position name="battery" joint="slide" kp="2000" kv="400" gear="1 0 0 0 0 0" ctrlrange="-0.3 0.3"/>
  </actuator>
</mujoco>
"""


def ballasted(folder: Path, **changes: Any) -> dict[str, Any]:
    """A mission along a line at a depth, its model written into a folder.

    Args:
        folder: for the model.
        changes: keys in place of its own.
    """
    model = folder / "ballasted.xml"
    model.write_text(MODEL)
    return {
        "schema_version": 1,
        "name": "ballasted",
        "model": str(model),
        "duration_s": 12,
        "surface_m": None,
        "path": {"type": "line", "start_m": [0, 0, -5], "end_m": [20, 0, -5]},
        "initial": {"position_m": [0, 0, -5]},
        "guidance": {"speed_m_s": 0.3},
        "setpoints": {
            "tank": {"times_s": [0, 3, 6], "values": [5e-4, 5e-4, 1e-3]},
            "battery": {"times_s": [0, 5], "values": [0.02, -0.02], "between": "held"},
        },
        "events": [
            {"kind": "setpoint", "at_s": 4.99, "actuator": "bladder", "value": 4e-4, "over_s": 2},
            {"kind": "setpoint", "at_s": 8, "actuator": "battery", "value": 0.1},
        ],
        "checks": [{"kind": "signal", "signal": "setpoints.reached", "statistic": "max", "at_most": 1}],
        **changes,
    }
