"""Who flies where there is no machine code yet has other processes make it."""

from __future__ import annotations

import json
import os

import numpy as np
import pytest
from support.places import HELIX
from support.processes import printed_by

import cube_sim
from cube_sim.flight import Flight
from cube_sim.flight.compiled import first_time
from cube_sim.flight.compiled.callees import ANSWERING
from cube_sim.native.callee import Callee
from cube_sim.native.compiled import address_of, compiled

JOBS = first_time.LOOP, first_time.SEARCH, first_time.ATTITUDE, first_time.LAW, first_time.CONFIRMATION
SHORT = {"duration_s": 0.1, "checks": [{"kind": "allowed_forces"}]}


@pytest.fixture
def asked(monkeypatch):
    """What other processes are asked for, on a machine that has compiled nothing."""
    given = []
    monkeypatch.setattr(Callee, "on_disk", False)
    monkeypatch.setattr(first_time, "on_disk", lambda function: False)
    monkeypatch.setattr(first_time.apart, "begin", lambda *functions: given.append(functions))
    first_time.compile_beside.cache_clear()
    yield given
    first_time.compile_beside.cache_clear()


@pytest.mark.parametrize(
    "fly",
    [
        lambda folder: Flight(HELIX, SHORT),
        lambda folder: cube_sim.fly_many(HELIX, [SHORT, SHORT], threads=2),
        lambda folder: cube_sim.run(HELIX, SHORT, folder, record="none"),
    ],
    ids=["Flight", "fly_many", "run"],
)
@pytest.mark.flight
def test_whoever_flies_first_is_helped_once(fly, asked, tmp_path):
    fly(tmp_path / "run")
    assert asked == [JOBS]


def test_they_are_asked_for_what_is_not_there(asked, monkeypatch):
    """After an update that changed one of them, whoever flies next compiles none itself either."""
    monkeypatch.setattr(Callee, "on_disk", property(lambda callee: callee is not ANSWERING))
    monkeypatch.setattr(first_time, "on_disk", lambda function: True)
    assert first_time.compile_beside()
    assert asked == [(first_time.LAW, first_time.CONFIRMATION)]
    first_time.compile_beside.cache_clear()
    monkeypatch.setattr(Callee, "on_disk", True)
    assert not first_time.compile_beside()
    assert len(asked) == 1


HAVE = """
import gc, json, sys
from cube_sim.native.function import CompiledFunction
functions = [each for each in gc.get_objects() if type(each) is CompiledFunction]
print(json.dumps([f"{each!r} {form}" for each in functions for form in each.forms]))
print("numba" in sys.modules)
"""
FIRST = """
import sys
from cube_sim import run
run(sys.argv[1], {"duration_s": 1.0, "checks": [{"kind": "allowed_forces"}]}, sys.argv[2], record="none")
"""


@pytest.mark.flight
def test_what_the_other_processes_are_asked_for_is_all_that_a_flight_takes(tmp_path):
    """They say nothing whatever happens: here they would."""
    parts = [function.split(":") for function in JOBS]
    make = "\n".join(f"from {module} import {name}; {name}()" for module, name in parts)
    made, _ = printed_by(make + HAVE).splitlines()
    taken, compiler = printed_by(FIRST + HAVE, HELIX, tmp_path / "run").splitlines()
    assert compiler == "False"
    assert len(json.loads(taken)) > len(JOBS)
    assert set(json.loads(taken)) <= set(json.loads(made))


@compiled
def half(x):
    return 0.5 * x


def test_code_that_answers_something_else_than_its_callers_are_told_is_refused():
    assert address_of(half, 1.0, answers=np.float64) != 0
    with pytest.raises(TypeError, match="half answers float64, not None"):
        address_of(half, 1.0)


@pytest.mark.campaign
@pytest.mark.flight
@pytest.mark.skipif((os.cpu_count() or 1) < 2 or os.name != "posix", reason="other processes compile on two cores")
def test_who_flies_first_compiles_nothing(tmp_path, monkeypatch):
    """The compiler's memory would stay with it for the whole flight."""
    for name in ("NUMBA_CACHE_DIR", "CUBE_SIM_CACHE_DIR"):
        monkeypatch.setenv(name, str(tmp_path / "cache"))
    assert printed_by(FIRST + HAVE, HELIX, tmp_path / "run").splitlines()[-1] == "False"
