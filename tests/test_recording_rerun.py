from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np
import pytest
from helix_run import DT, HEADER, MJCF, THRUSTERS, append_tick, fly, model, table

from cube_sim.errors import RecordingError
from cube_sim.recording.block import Block, LogLine, split_blocks
from cube_sim.recording.export import rrd_from_mcap
from cube_sim.recording.geometry import thruster_mounts, vehicle_name, vehicle_shapes, world_shapes
from cube_sim.recording.recorder import Recorder

TICKS = 160


def rerun(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run the viewer's command line, which reads an .rrd without this program's help."""
    (folder,) = find_spec("rerun_cli").submodule_search_locations
    binary = Path(folder) / ("rerun.exe" if sys.platform == "win32" else "rerun")
    return subprocess.run([binary, *map(str, arguments)], capture_output=True, text=True, timeout=120)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Recorder:
    directory = tmp_path_factory.mktemp("run")
    with Recorder(directory, HEADER, table(), model()) as recorder:
        fly(recorder, TICKS)
    return recorder


@pytest.fixture(scope="module")
def printed(run) -> str:
    return rerun("rrd", "print", "-vvv", "--full-metadata", run.rrd).stdout


def test_the_view_made_from_the_record_is_that_of_the_live_run(run, tmp_path):
    again = tmp_path / "again.rrd"
    rrd_from_mcap(run.mcap, again)
    compared = rerun("rrd", "compare", "--unordered", run.rrd, again)
    assert compared.returncode == 0, compared.stdout + compared.stderr


def test_the_comparison_sees_a_different_run(run, tmp_path):
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        fly(recorder, TICKS - 1)
    assert rerun("rrd", "compare", "--unordered", run.rrd, recorder.rrd).returncode != 0
