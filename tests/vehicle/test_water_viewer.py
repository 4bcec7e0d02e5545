"""The water in MuJoCo's own window.

It needs a display: `xvfb-run -a pytest tests/vehicle/test_water_viewer.py` makes one.
"""

from __future__ import annotations

import os
import subprocess
import sys

import mujoco
import numpy as np
import pytest
from support.places import CUBE

import cube_sim

pytestmark = pytest.mark.flight

PROGRAM = """
import sys, threading
import mujoco, mujoco.viewer
import cube_sim

model = cube_sim.load_model(sys.argv[1])
data = mujoco.MjData(model)
data.ctrl[:] = 0.4
before = set(threading.enumerate())
with mujoco.viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False) as viewer:
    for step in range(100):
        with viewer.lock():
            mujoco.mj_step(model, data)
        if step % 20 == 0:
            viewer.sync()
    assert viewer.is_running()
for thread in set(threading.enumerate()) - before:
    thread.join(30.0)  # else the interpreter may take GLFW down while the window is still being drawn
print(data.qpos.tobytes().hex())
"""


@pytest.mark.skipif(
    sys.platform != "linux" or not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")),
    reason="MuJoCo's viewer opens a window: no display on Linux (other systems start it differently)",
)
def test_passive_viewer_shows_the_very_motion(tmp_path):
    """Stepped while the viewer draws, the hull moves bit for bit as it does alone."""
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(CUBE)], capture_output=True, text=True, cwd=tmp_path, timeout=120
    )
    assert run.returncode == 0, run.stderr
    model = cube_sim.load_model(CUBE)
    data = mujoco.MjData(model)
    data.ctrl[:] = 0.4
    mujoco.mj_step(model, data, nstep=100)
    assert np.array_equal(np.frombuffer(bytes.fromhex(run.stdout.split()[-1])), data.qpos)
    assert abs(data.qvel[5]) > 0.1
