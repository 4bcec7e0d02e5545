"""MuJoCo's clock while compiled code flies, and afterwards."""

from __future__ import annotations

import ctypes

import mujoco
import pytest
from support.places import CUBE
from support.plain_callbacks import _LIBRARY

import cube_sim
from cube_sim.vehicle.plugin import clock

STEP = mujoco.mjtTimer.mjTIMER_STEP


def held() -> int | None:
    return ctypes.c_void_p.in_dll(_LIBRARY, "mjcb_time").value


@pytest.fixture
def cube():
    model = cube_sim.load_model(CUBE)
    return model, mujoco.MjData(model)


def spent(cube) -> float:
    before = cube[1].timer[STEP].duration
    mujoco.mj_step(*cube, nstep=20)
    return cube[1].timer[STEP].duration - before


def test_it_stands_still_and_goes_on(cube):
    before = held()
    assert spent(cube) > 0.0
    with clock.held_still():
        assert spent(cube) == 0.0
        with clock.held_still():
            assert spent(cube) == 0.0
        assert spent(cube) == 0.0
    assert held() == before
    assert spent(cube) > 0.0


def test_it_goes_on_after_an_error(cube):
    before = held()
    with pytest.raises(ZeroDivisionError), clock.held_still():
        raise ZeroDivisionError
    assert held() == before


def test_a_clock_set_meanwhile_stays(cube):
    theirs = ctypes.CFUNCTYPE(ctypes.c_double)(lambda: 0.0)
    address = ctypes.cast(theirs, ctypes.c_void_p)
    place, before = ctypes.c_void_p.in_dll(_LIBRARY, "mjcb_time"), held()
    try:
        with clock.held_still():
            place.value = address.value
        assert held() == address.value
    finally:
        place.value = before


def test_whoever_has_none_gets_none(cube):
    place, before = ctypes.c_void_p.in_dll(_LIBRARY, "mjcb_time"), held()
    try:
        place.value = None
        with clock.held_still():
            mujoco.mj_step(*cube)
        assert held() is None
    finally:
        place.value = before
