"""The test that a drafted vehicle comes with, to be extended by its owner."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cube_sim.vehicle_draft.hull import HullDraft
from cube_sim.vehicle_draft.thruster_places import ThrusterPlace

_HEAD = '''"""What {name} must be and do; the scenarios beside it are tests as well."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

import cube_sim

MODEL = Path(__file__).parents[1] / "models" / "{name}.xml"
MASS_KG = {mass!r}
LIFT_LESS_WEIGHT_N = {lift!r}
# Places [m], from the centre of buoyancy, and axes of the thrusters, x forward, y left, z up.
THRUSTERS = {{
{rows}
}}
'''
_BODY = """

@pytest.fixture
def model():
    return cube_sim.load_model(MODEL)


def test_mass_and_lift(model):
    vehicle = cube_sim.Vehicle.from_model(model)
    assert model.body("hull").mass[0] == pytest.approx(MASS_KG, rel=1e-4)
    lift = (vehicle.displaced_mass - MASS_KG) * -model.opt.gravity[2]
    assert lift == pytest.approx(LIFT_LESS_WEIGHT_N, abs=1e-3 * MASS_KG)


def test_every_thruster_pushes_where_and_as_it_is_mounted(model):
    vehicle = cube_sim.Vehicle.from_model(model)
    assert vehicle.thrusters.names == tuple(THRUSTERS)
    for column, (place, axis) in zip(vehicle.actuation_matrix.T, THRUSTERS.values(), strict=True):
        axis = np.array(axis) / np.linalg.norm(axis)
        np.testing.assert_allclose(column, [*axis, *np.cross(place, axis)], atol=1e-4)


def test_released_at_rest_it_moves_as_lift_and_weight_say(model):
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    way = np.sign(LIFT_LESS_WEIGHT_N) if abs(LIFT_LESS_WEIGHT_N) > 0.02 * MASS_KG * 9.81 else 0.0
    mujoco.mj_step(model, data, nstep=100)
    assert np.isfinite(data.qpos).all()
    if way:
        assert np.sign(data.qvel[2]) == way
    else:
        assert abs(data.qvel[2]) < 0.2
"""


def own_tests(name: str, hull: HullDraft, places: Sequence[ThrusterPlace], lift: float) -> str:
    """A file of tests for pytest.

    Args:
        name: of the model.
        hull: its numbers.
        places: of its thrusters.
        lift: less weight [N].
    """
    rows = "\n".join(f'    "{p.name}": ({_row(p.place)}, {_row(p.axis)}),' for p in places)
    return _HEAD.format(name=name, mass=float(f"{hull.mass:.6g}"), lift=float(f"{lift:.6g}"), rows=rows) + _BODY


def _row(values: np.ndarray) -> str:
    return "(" + ", ".join(f"{0.0 if abs(x) < 1e-12 else x:.6g}" for x in values) + ")"
