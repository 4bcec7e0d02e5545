"""The factors of the inertia with added mass, which the callback writes where MuJoCo's own would lie."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.places import CUBE, MODELS

import cube_sim
from cube_sim.vehicle.plugin import layout, packing


def turned(model: mujoco.MjModel, rng: np.random.Generator) -> mujoco.MjData:
    data = mujoco.MjData(model)
    q = rng.normal(size=4)
    data.qpos[3:7] = q / np.linalg.norm(q)
    data.qvel[:] = rng.normal(size=model.nv)
    mujoco.mj_forward(model, data)
    return data


@pytest.mark.parametrize("path", sorted(MODELS.glob("*.xml")), ids=lambda path: path.stem)
def test_factors_are_those_of_mujoco_to_the_bit(path):
    model = cube_sim.load_model(path)
    rng = np.random.default_rng(11)
    for _ in range(20):
        data = turned(model, rng)
        ours = data.qLD.tobytes(), data.qLDiagInv.tobytes()
        assert np.count_nonzero(data.qLD) > 6
        mujoco.mj_factorM(model, data)
        assert (data.qLD.tobytes(), data.qLDiagInv.tobytes()) == ours


def test_mujoco_warns_of_an_inertia_that_is_none():
    model = cube_sim.load_model(CUBE)
    packed = packing.packed_parameters(model)
    hull = int(packed[layout.HULLS])
    packed[hull + layout.ADDED_MASS] = -1000.0  # more than the hull has
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.warning[mujoco.mjtWarning.mjWARN_INERTIA].number == 1
