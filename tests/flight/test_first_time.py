"""Who flies where there is no machine code yet has another process make half of it."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from support.places import HELIX

import cube_sim
from cube_sim.flight import Flight
from cube_sim.flight.compiled import first_time
from cube_sim.native.compiled import address_of, compiled

SHORT = {"duration_s": 0.1, "checks": [{"kind": "allowed_forces"}]}


@pytest.fixture
def asked(monkeypatch):
    """What another process is asked for, on a machine that has compiled nothing."""
    given = []
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
    assert asked == [(first_time.SEARCH, first_time.LAW)]


@pytest.mark.flight
def test_what_the_other_process_is_asked_for_is_there():
    """It says nothing whatever happens: here it would."""
    parts = [function.split(":") for function in (first_time.SEARCH, first_time.LAW)]
    program = "\n".join(f"from {module} import {name}; assert {name}() != 0" for module, name in parts)
    subprocess.run([sys.executable, "-c", program], check=True, timeout=300)


@compiled
def half(x):
    return 0.5 * x


def test_code_that_answers_something_else_than_its_callers_are_told_is_refused():
    assert address_of(half, 1.0, answers=np.float64) != 0
    with pytest.raises(TypeError, match="half answers float64, not None"):
        address_of(half, 1.0)
