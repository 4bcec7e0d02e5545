"""Compiling in another process: it leaves its code behind, and its failure costs nothing."""

from __future__ import annotations

import subprocess
import sys

import pytest

from cube_sim.native import apart

FOLDERS = "NUMBA_CACHE_DIR", "CUBE_SIM_CACHE_DIR"
CALL = """
import os
from cube_sim.native import apart
from cube_sim.native.compiled import on_disk
from cube_sim.allocation.asked_forces import asked_forces
print(on_disk(asked_forces))
apart.begin("asked_apart:call")
apart.finish("asked_apart:call")
print(on_disk(asked_forces))
"""
ASKED = """
import numpy as np
from cube_sim.allocation.asked_forces import asked_forces
def call():
    asked_forces(np.zeros(1), np.ones(1), np.ones(1, np.bool_), np.zeros((1, 4)), 1.0)
"""


def test_its_code_is_on_disk_when_it_has_come_to_its_end(tmp_path, monkeypatch):
    for name in FOLDERS:
        monkeypatch.setenv(name, str(tmp_path / "cache"))
    (tmp_path / "asked_apart.py").write_text(ASKED)
    done = subprocess.run([sys.executable, "-c", CALL], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.stderr == ""
    assert done.stdout.split() == ["False", "True"]


@pytest.mark.parametrize("function", ["no_such_module:call", "cube_sim.native.apart:no_such_function"])
def test_what_cannot_be_called_is_waited_for_and_forgotten(function):
    apart.begin(function)
    apart.finish(function)
    apart.finish(function)
    assert apart._running == {}
