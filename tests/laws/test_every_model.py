"""What holds of every vehicle in models/: it loads, floats, flies, and says what all is called and where it is from.

That it flies as the analysis says, and as `cube-sim new` writes, is held in tests/test_missions.py and
tests/commands/test_new.py; that shipped scenarios fly, in tests/laws/test_every_scenario.py.
"""

from __future__ import annotations

import re
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from flights.trial import every_vehicle
from support.places import MODEL_FILES, SCENARIO_FILES, STEERED_BY_FINS, WRITTEN_MODEL_FILES

import cube_sim
from cube_sim.commands.analysis_report import report_on

pytestmark = pytest.mark.parametrize("path", MODEL_FILES, ids=lambda path: path.stem)

NUMBERED = "worldbody//body", "worldbody//joint", "worldbody//freejoint", "worldbody//geom", "worldbody//site"
COMPILED = mujoco.mjtObj.mjOBJ_ACTUATOR, mujoco.mjtObj.mjOBJ_SENSOR, mujoco.mjtObj.mjOBJ_NUMERIC


def test_every_element_has_a_name(path):
    model = cube_sim.load_model(path)
    for kind, count in zip(COMPILED, (model.nu, model.nsensor, model.nnumeric), strict=True):
        assert all(mujoco.mj_id2name(model, kind, i) for i in range(count)), kind
    tree = ElementTree.parse(path)
    elements = [element for kind in NUMBERED for element in tree.iterfind(f"./{kind}")]
    assert len(elements) > model.nu
    assert [ElementTree.tostring(element) for element in elements if not element.get("name")] == []


def test_its_head_says_which_vehicle_it_is_and_where_its_numbers_are_from(path):
    text = path.read_text()
    head = text[text.index("<!--") : text.index("-->")]
    assert text.index("-->") < text.index("<compiler")
    assert ElementTree.parse(path).getroot().get("model") == path.stem
    assert re.search(r"\bsources?\b|\bchoice\b", head, re.IGNORECASE)
    assert "SI units" in head or "Every other number, and its source, is" in head


def test_its_thrusters_are_those_of_one_hull_and_have_allowed_forces(path):
    model = cube_sim.load_model(path)
    vehicle = cube_sim.Vehicle.from_model(model)
    servos = int(np.sum(model.actuator_dyntype == mujoco.mjtDyn.mjDYN_USER))  # of fins
    servos += int(np.sum(model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT))  # of an arm
    assert len(vehicle.thrusters.names) == model.nu - servos == vehicle.actuation_matrix.shape[1]
    assert len(set(vehicle.thrusters.names)) == model.nu - servos
    assert np.isfinite(vehicle.actuation_matrix).all()
    assert np.all(np.diff(vehicle.thrusters.limits, axis=1) >= 0.0)
    assert np.all(vehicle.thrusters.limits[:, 0] < 0.0)
    assert np.all(vehicle.thrusters.limits[:, 3] > 0.0)


def test_its_inertia_is_that_of_a_body_in_water(path):
    vehicle = cube_sim.Vehicle.from_model(cube_sim.load_model(path))
    for matrix in (vehicle.mass_matrix, vehicle.added_mass):
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)
    assert np.linalg.eigvalsh(vehicle.mass_matrix).min() > 0.0
    assert np.linalg.eigvalsh(vehicle.added_mass).min() >= 0.0


def test_it_stays_as_it_floats_and_at_rest(path):
    """Level, but for the one that is lopsided on purpose: its righting moment points up 24 degrees aslant.

    And without the excess buoyancy of those that pitch as they rise.
    """
    neutral = {"hull:volume": 299.0 / (9.81 * 1030.0)} if path.stem.startswith("remus100") else {}
    model = cube_sim.load_model(path, neutral)
    vehicle = cube_sim.Vehicle.from_model(model)
    data = mujoco.MjData(model)
    lift = vehicle.dynamics.righting_moment / np.linalg.norm(vehicle.dynamics.righting_moment)
    aslant = float(np.arccos(min(1.0, lift[2])))
    assert np.degrees(aslant) == pytest.approx(24.2, abs=0.5) if path.stem == "rov6" else aslant < 1e-9
    if aslant > 0.0:
        axis = np.cross(lift, [0.0, 0.0, 1.0])
        mujoco.mju_axisAngle2Quat(data.qpos[3:7], axis / np.linalg.norm(axis), aslant)
    mujoco.mj_step(model, data, nstep=round(10.0 / model.opt.timestep))
    assert np.all(np.isfinite(data.qpos))
    tilt = np.arccos(np.clip(data.xmat[1].reshape(3, 3)[2] @ lift, -1.0, 1.0))
    gives_way = 1e-3 if model.nv > 6 else 0.0  # an arm does, to its own weight, and the hull follows
    assert tilt < (0.05 if aslant > 0.0 else 1e-6 + gives_way)  # what rises aslant is turned by the water a little
    sinking = (vehicle.mass - vehicle.displaced_mass) * 9.81
    slowed = vehicle.dynamics.linear_damping[2, 2] * abs(data.qvel[2])  # heave drag alone
    assert slowed <= abs(sinking) + 1e-9 + gives_way
    assert vehicle.centre_of_buoyancy[2] > vehicle.centre_of_mass[2]


def test_it_is_analysed_as_it_flies(path):
    """At the speed of its trials; REMUS 100 has more lift than its fins hold, which is said."""
    entry = every_vehicle()[path.stem]
    report = report_on(path, planar=entry.planar, speed_m_s=entry.speed_m_s)
    verdict = report.analysis.verdict
    assert verdict.follows == (path.stem != "remus100"), verdict.reason
    assert (report.fins is not None) == (path.stem in STEERED_BY_FINS)


def test_a_shipped_scenario_flies_it(path):
    """Or `cube-sim new` writes one that is flown."""
    flown = [each for each in SCENARIO_FILES if f"\nmodel: ../models/{path.name}\n" in each.read_text()]
    assert flown or path in WRITTEN_MODEL_FILES
