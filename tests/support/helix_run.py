"""A run to record: a helix flown by closed forms, on a vehicle with eight thrusters.

Every row is a function of the tick, so any slice of the recording can be computed again by a test.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np

from cube_sim.recording.channels import Channel, channel_table
from cube_sim.recording.header import RunHeader
from cube_sim.recording.recorder import Recorder
from cube_sim.recording.run_end import RunEnd
from cube_sim.verdict import CheckResult

DT = 0.02
THRUSTERS = tuple(f"T{i}" for i in range(1, 9))
STATUS = ("exact", "nearest")
PATH_POINTS = 400
RADIUS, PITCH, SPEED, CLIMB = 3.0, 0.05, 0.3, 4.0

_CORNERS = [(sx, sy, sz) for sx in (1, -1) for sy in (1, -1) for sz in (1, -1)]


def _site(name: str, corner: tuple[int, int, int]) -> str:
    x, y, z = (0.3 * c for c in corner)
    # Thrust axes tilted alike at every corner, so that the eight of them span all six degrees of freedom.
    axis = (corner[0], -corner[1], 0.6 * corner[2])
    return f'<site name="{name}" pos="{x} {y} {z}" zaxis="{axis[0]} {axis[1]} {axis[2]}" size="0.05 0.03"/>'


MJCF = f"""
<mujoco model="octa">
  <worldbody>
    <geom name="seabed" type="plane" size="6 6 0.1" pos="0 0 -3" rgba="0.5 0.45 0.35 1"/>
    <body name="octa" pos="0 0 0">
      <freejoint/>
      <geom name="hull" type="box" size="0.25 0.25 0.25" rgba="0.9 0.7 0.1 0.6" mass="50"/>
      <geom name="tube" type="capsule" size="0.06" fromto="-0.2 0 0.3 0.2 0 0.3" rgba="0.2 0.2 0.2 1" mass="2"/>
      {"".join(_site(n, c) for n, c in zip(THRUSTERS, _CORNERS, strict=True))}
    </body>
  </worldbody>
  <actuator>
    {"".join(f'<general name="{n}" site="{n}" gear="0 0 1 0 0 0" biastype="user"/>' for n in THRUSTERS)}
  </actuator>
</mujoco>
"""

_ON_HULL = "".join(_site(n, c) for n, c in zip(THRUSTERS[6:], _CORNERS[6:], strict=True))
_ON_POD = f"""
  <body name="pod" pos="0.1 -0.2 0.3" euler="20 30 40">
    {_site("T8", _CORNERS[7])}
    <body name="arm" pos="0 0.1 0" euler="0 50 0">
      <joint axis="0 1 0" ref="20"/>
      <geom size="0.01"/>
      {_site("T7", _CORNERS[6])}
    </body>
  </body>
"""
POD_MJCF = (
    MJCF.replace(_ON_HULL, _ON_POD)
    .replace('<body name="octa" pos="0 0 0">', '<body name="octa" pos="3 -1 -2" euler="10 20 30">')
    .replace('site="T3" gear="0 0 1', 'site="T3" gear="0 0 -1')
)
"""The same vehicle elsewhere: T8 in a pod, T7 on a hinged arm of the pod, and T3 turned about by its gear."""

HEADER = RunHeader(
    scenario="vehicle: octa  # as written\nduration: 3 s\n",
    resolved="vehicle: octa\nduration: 3.0\n",
    model="model/octa.xml",
    inputs={"model/octa.xml": MJCF.encode(), "model/meshes/b.obj": bytes(range(256)), "model/meshes/a.obj": b""},
    versions={"numpy": "2", "mujoco": "4"},
    seed=7,
)

END = RunEnd("completed", "", 160, 3.2, "", "PASS", (CheckResult("it", "PASS", 0.1, "<=", 1.0, 0.9, 2.0, "so"),))


def table() -> tuple[Channel, ...]:
    return channel_table(THRUSTERS, PATH_POINTS, STATUS)


def model() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(MJCF)


def pod_model() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(POD_MJCF)


def places_and_axes(compiled: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray]:
    """p_BT (m, 3) and the directions (m, 3) of positive force in body axes, by what MuJoCo computes of the sites."""
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    R_WB, p_WB = data.body("octa").xmat.reshape(3, 3), data.body("octa").xpos
    signs = np.array([compiled.actuator(name).gear[2] for name in THRUSTERS])
    places = np.array([data.site(name).xpos - p_WB for name in THRUSTERS])
    axes = np.array([data.site(name).xmat.reshape(3, 3)[:, 2] for name in THRUSTERS])
    return places @ R_WB, signs[:, None] * axes @ R_WB


def point(s: float) -> np.ndarray:
    angle = s / math.hypot(RADIUS, CLIMB / (2 * math.pi))
    return np.array([RADIUS * math.cos(angle), RADIUS * math.sin(angle), CLIMB * angle / (2 * math.pi)])


def append_tick(recorder: Recorder, k: int) -> None:
    """Append the row of tick k to every channel; k = 0 also those that are recorded on change."""
    t = k * DT
    rng = np.random.default_rng(k)
    m = len(THRUSTERS)
    if k == 0:
        recorder.append("actuation", t, rng.normal(size=6 * m), np.tile([-40.0, -2.0, 2.0, 50.0], m))
        path = np.array([point(s) for s in np.linspace(0, 2 * 3.2 * math.pi * RADIUS, PATH_POINTS)])
        recorder.append("path", t, path.ravel())
    s = SPEED * t
    p = point(s)
    half = 0.5 * s / RADIUS
    q = np.array([math.cos(half), 0.0, 0.0, math.sin(half)])
    offset = 2.0 * math.exp(-t / 8)
    force = 20 * np.sin(0.4 * t + np.arange(m))
    wrench = np.array([10 * math.cos(0.2 * t), 4 * math.sin(0.3 * t), 6.0, 0.4, -0.2, math.sin(t)])
    recorder.append("pose", t, p + offset * p / RADIUS, q)
    recorder.append("velocity", t, np.array([SPEED, 0.0, 0.05]), np.array([0.0, 0.0, SPEED / RADIUS]))
    recorder.append("target", t, s, 60 - s, p, q)
    recorder.append("path_error", t, -0.1 * offset, np.array([offset, 0.2 * offset]), 1.02 * offset, 0.1 * offset)
    recorder.append("reference", t, np.array([SPEED, 0.0, 0.05]), rng.normal(size=3), q)
    recorder.append("wrench", t, wrench, 0.99 * wrench, 0.1 * rng.normal(size=6))
    status = 1.0 if math.sin(0.7 * t) > 0.8 else 0.0
    recorder.append("allocation", t, 1e-4, float(force @ force), status, np.sign(np.round(force / 8)))
    recorder.append("thrusters", t, force, force / 50, 0.98 * force)
    recorder.append("power", t, np.abs(force) ** 1.5, 300 * t, 15.0, 1.0)
    water = np.array([0.1, 0.02 * math.sin(t), 0.0])
    recorder.append("water", t, water, 0.9 * water)


def fly(recorder: Recorder, ticks: int, first: int = 0) -> None:
    for k in range(first, first + ticks):
        append_tick(recorder, k)
        if k % 100 == 25:
            recorder.log(k * DT, "INFO", f"tick {k}: vehicle under way, 20 °C")
