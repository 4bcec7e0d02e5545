"""A simulation that has failed says by which of its numbers."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.places import CUBE

import cube_sim
from cube_sim.mission.divergence import divergence

AT_START = " before anything has moved (see to the current, the initial state and the model)"


@pytest.fixture
def state():
    model = cube_sim.load_model(CUBE)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    data.time = 1.0
    return model, data


def test_a_vehicle_at_rest_has_not_failed(state):
    assert divergence(*state) is None


@pytest.mark.parametrize(
    ("where", "value", "reason"),
    [
        (("qpos", 2), -3e7, "the position of 'hull' is -3e+07 in SI units, beyond 1e+06"),
        (("qpos", 4), np.nan, "the position of 'hull' is not a number"),
        (("qvel", 0), 2e6, "the velocity of 'hull' is 2e+06 in SI units, beyond 1e+06"),
        (("qacc", 5), np.inf, "the acceleration of 'hull' is not a number"),
    ],
)  # fmt: skip
def test_the_number_that_is_out_of_bounds_is_named(state, where, value, reason):
    model, data = state
    getattr(data, where[0])[where[1]] = value
    assert divergence(model, data) == reason
    data.time = 0.0
    assert divergence(model, data) == reason + AT_START


def test_the_first_cause_is_named_and_of_it_the_worst_number(state):
    model, data = state
    data.qvel[:2], data.qacc[3] = [2e6, np.nan], 1e12
    assert divergence(model, data) == "the velocity of 'hull' is not a number"


def test_the_body_at_fault_is_named():
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body name='hull'><freejoint/><geom size='1'/>"
        "<body name='arm' pos='2 0 0'><joint axis='0 1 0'/><geom size='0.1'/></body></body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    data.time, data.qpos[7] = 1.0, 5e6
    assert divergence(model, data) == "the position of 'arm' is 5e+06 in SI units, beyond 1e+06"
