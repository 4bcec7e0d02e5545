"""Compiling in other processes: they leave their code behind, and their failure costs nothing."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

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
def test_what_cannot_be_called_is_waited_for_once(function):
    apart.begin(function)
    apart.finish(function)
    apart.finish(function)


MANY = """
import os, pathlib, time
def call(name, seconds):
    time.sleep(seconds)
    pathlib.Path(name).write_text(f"{os.getpid()} {time.monotonic()}")
def long(): call("long", 1.5)
def dies(): os._exit(1)
def first(): call("first", 0.1)
def last(): call("last", 0.1)
"""
SHARE = """
from cube_sim.native import apart
functions = {functions}
apart.begin(*functions)
for function in functions:
    apart.finish(function)
"""


def shared(folder, functions) -> None:
    (folder / "many_apart.py").write_text(MANY)
    program = SHARE.format(functions=[f"many_apart:{name}" for name in functions])
    subprocess.run([sys.executable, "-c", program], cwd=folder, check=True, timeout=60)


def test_who_is_done_takes_the_next(tmp_path):
    shared(tmp_path, ("long", "first", "last"))
    told = {name: (tmp_path / name).read_text().split()[0] for name in ("long", "first", "last")}
    assert told["first"] == told["last"] != told["long"]


def test_one_that_dies_leaves_the_rest_to_the_other(tmp_path):
    shared(tmp_path, ("dies", "first", "last"))
    assert (tmp_path / "first").exists()
    assert (tmp_path / "last").exists()


PARENT = """
import os, sys, time
from cube_sim.native import apart
apart.begin("sleeps_apart:call")
(process,) = apart._running["sleeps_apart:call"].processes
while not os.path.exists("begun"):
    time.sleep(0.01)
print(process.pid, flush=True)
{then}
"""
SLEEPS = """
import pathlib, time
def call():
    pathlib.Path("begun").touch()
    time.sleep({seconds})
    pathlib.Path("done").touch()
"""


def parent(folder, seconds: float, then: str) -> subprocess.Popen[str]:
    (folder / "sleeps_apart.py").write_text(SLEEPS.format(seconds=seconds))
    return subprocess.Popen(
        [sys.executable, "-c", PARENT.format(then=then)], cwd=folder, stdout=subprocess.PIPE, text=True
    )


def lives(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2][0]
    except FileNotFoundError:
        return False
    return state != "Z"  # where nobody collects what is left of orphans


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="tells who lives by Linux's /proc")
def test_it_ends_with_a_parent_that_is_killed(tmp_path):
    with parent(tmp_path, 120.0, "time.sleep(120.0)") as process:
        assert process.stdout is not None
        child = int(process.stdout.readline())
        assert lives(child)
        process.kill()
    until = time.monotonic() + 30.0
    while lives(child) and time.monotonic() < until:
        time.sleep(0.05)
    assert not lives(child)
    assert not (tmp_path / "done").exists()


def test_it_goes_on_after_a_parent_that_has_come_to_its_end(tmp_path):
    with parent(tmp_path, 2.0, "") as process:
        assert process.wait(60) == 0
    assert not (tmp_path / "done").exists()
    until = time.monotonic() + 30.0
    while not (tmp_path / "done").exists() and time.monotonic() < until:
        time.sleep(0.05)
    assert (tmp_path / "done").exists()
