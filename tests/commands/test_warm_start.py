"""What a flight of one command loads, once its machine code is there: the process is mostly imports."""

from __future__ import annotations

import subprocess
import sys

import pytest
from support.scenario_files import FLIGHT, write

from cube_sim import load_run
from cube_sim.native.heap import NEW_OBJECTS

HEAVY = ("numba", "scipy", "pandas", "rerun", "pyarrow", "matplotlib", "rich", "PIL", "unittest")
PROGRAM = f"""
import atexit, gc, sys
loaded = lambda: [name for name in {HEAVY!r} if name in sys.modules]
atexit.register(lambda: print(gc.get_threshold()[0], *loaded(), file=sys.stderr))
from cube_sim.commands.cli import main
main()
"""


@pytest.mark.flight
@pytest.mark.parametrize("record", ["full", "mcap", "none"])
def test_a_run_loads_neither_a_compiler_nor_what_another_process_loads_for_it(tmp_path, record):
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    command = [sys.executable, "-c", PROGRAM, "run", path, "--out", out, "--record", record, "--quiet"]
    for _ in range(2):  # the first may compile
        done = subprocess.run(command, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stderr
    assert done.stderr == f"{NEW_OBJECTS}\n"
    assert (out / "run.rrd").exists() == (record == "full")
    if record != "none":
        assert load_run(out).complete
