"""A file of the user's is flown as a program, and named by a scenario: what one compiled does not stop the other."""

import os
import subprocess
import sys

import pytest
from support.places import REPO

OWN = """\
from cube_sim.native.compiled import compiled


@compiled
def twice(x):
    return 2.0 * x
"""
AS_SCENARIOS_NAME_IT = """\
from pathlib import Path
from cube_sim.mission.own.code import _module_of_file
print(_module_of_file(Path("mine.py").resolve()).twice(1.0))
"""
AS_PROGRAMS_DO = "import mine; print(mine.twice(1.0))"


@pytest.mark.parametrize("turns", [(AS_SCENARIOS_NAME_IT, AS_PROGRAMS_DO), (AS_PROGRAMS_DO, AS_SCENARIOS_NAME_IT)])
def test_code_that_was_compiled_under_another_name_is_compiled_again(tmp_path, turns):
    (tmp_path / "mine.py").write_text(OWN)
    caches = {name: str(tmp_path / "cache") for name in ("NUMBA_CACHE_DIR", "CUBE_SIM_CACHE_DIR")}
    environment = {**os.environ, **caches, "PYTHONPATH": f"{REPO}{os.pathsep}{tmp_path}"}
    for program in (*turns, *turns):
        done = subprocess.run(
            [sys.executable, "-c", program], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stdout) == (0, "2.0\n"), done.stderr
