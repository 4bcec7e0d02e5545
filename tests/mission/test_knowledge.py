"""A controller whose knowledge of its vehicle is wrong: what it believes, and that it copes."""

import numpy as np
import pytest
from support.places import HELIX, SCENARIOS
from support.vehicles import vehicle

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.mission import prepare
from cube_sim.mission.hull import believed_hull, flown_hull
from cube_sim.mission.knowledge import believed_dynamics, believed_planar_model, unlikely_factor_words
from cube_sim.mission.planar_identification import identify_planar_model
from cube_sim.scenario import load
from cube_sim.scenario.knowledge_block import KnowledgeBlock

INFANTE = SCENARIOS / "infante_circle.yaml"
WRONG = [
    {"knowledge.mass": 1.3},
    {"knowledge.added_mass": 0.5},
    {"knowledge.drag": 1.3},
    {"knowledge.thrust": 0.8},
    {"model": "../models/cube_as_built.xml", "knowledge.model": "../models/cube.xml"},
]


SETTLED = [
    {"kind": "signal", "signal": "path_error.cross_track", "statistic": "rms", "from_s": 40, "at_most": 0.01},
]


def rms_on_the_helix(changes, directory) -> float:
    """Cross-track RMS [m] in a current, from 40 s on."""
    return cube_sim.run(HELIX, {"duration_s": 55, "checks": SETTLED, **changes}, out=directory).checks[0].value


@pytest.mark.flight
@pytest.mark.parametrize("wrong", WRONG, ids=lambda wrong: "+".join(wrong))
def test_the_helix_is_followed_in_a_current_with_wrong_knowledge(wrong, tmp_path):
    """Wrong by more than a careful engineer would be."""
    assert rms_on_the_helix(wrong, tmp_path) < 0.003


@pytest.mark.flight
def test_it_is_the_estimates_that_make_up_for_wrong_knowledge(tmp_path):
    blind = {"control.disturbance_time_s": None, "control.current_time_s": None}
    assert rms_on_the_helix({**WRONG[0], **blind}, tmp_path) > 0.015


def test_each_factor_scales_what_it_names_and_nothing_else():
    dynamics = flown_hull(load(HELIX)).vehicle.dynamics
    believed = believed_dynamics(dynamics, KnowledgeBlock(mass=1.1, added_mass=0.5, drag=1.5))
    np.testing.assert_allclose(believed.mass_matrix, 1.1 * dynamics.mass_matrix)
    np.testing.assert_allclose(believed.added_mass, 0.5 * dynamics.added_mass)
    np.testing.assert_allclose(believed.linear_damping, 1.5 * dynamics.linear_damping)
    np.testing.assert_allclose(believed.quadratic_damping, 1.5 * dynamics.quadratic_damping)
    assert believed.displaced_mass == pytest.approx(1.1 * dynamics.displaced_mass)  # still trimmed
    np.testing.assert_array_equal(believed.centre_of_buoyancy, dynamics.centre_of_buoyancy)


def test_thrust_scales_the_matrix_the_allocator_uses_and_the_recording_shows():
    mission = prepare(load(HELIX, {"knowledge.thrust": 0.8}))
    np.testing.assert_allclose(mission.allocator.A, 0.8 * mission.vehicle.actuation_matrix)


def test_another_model_can_be_believed():
    loaded = load(HELIX, {"model": "../models/cube_as_built.xml", "knowledge.model": "../models/cube.xml"})
    flown = flown_hull(loaded)
    believed = believed_hull(loaded, flown)
    assert not np.allclose(believed.vehicle.actuation_matrix, flown.vehicle.actuation_matrix)
    ideal = vehicle("cube")
    np.testing.assert_array_equal(believed.vehicle.actuation_matrix, ideal.actuation_matrix)


def test_a_believed_model_with_other_thrusters_is_refused():
    with pytest.raises(ScenarioError, match=r"knowledge\.model.*has the thrusters T1, T2, T3, T4;"):
        prepare(load(HELIX, {"knowledge.model": "../models/jack.xml"}))


def test_a_missing_believed_model_is_refused():
    with pytest.raises(ScenarioError, match=r"knowledge\.model: no such file"):
        load(HELIX, {"knowledge.model": "nowhere.xml"})


def test_the_planar_model_of_true_knowledge_is_the_true_one():
    hull = flown_hull(load(INFANTE))
    true = identify_planar_model(*hull)
    np.testing.assert_allclose(believed_planar_model(true, hull.vehicle, KnowledgeBlock()), true, atol=1e-9)


def test_the_planar_model_mixes_its_coefficients_by_their_cause():
    """INFANTE (theory: m_u = m - Xudot, m_ur = m - Yur): rigid mass 2234.5, surge added mass 141.9."""
    hull = flown_hull(load(INFANTE))
    true = identify_planar_model(*hull)
    heavier = believed_planar_model(true, hull.vehicle, KnowledgeBlock(mass=1.1))
    assert heavier.m_u - true.m_u == pytest.approx(223.45)
    assert heavier.m_ur - true.m_ur == pytest.approx(223.45)
    assert heavier.D_uu == pytest.approx(true.D_uu)
    slicker = believed_planar_model(true, hull.vehicle, KnowledgeBlock(drag=0.5))
    assert slicker.D_uu == pytest.approx(0.5 * true.D_uu)
    assert slicker.m_u == pytest.approx(true.m_u)


@pytest.mark.parametrize(
    ("factors", "told"),
    [
        ({}, []),
        ({"mass": 1.3, "drag": 0.0, "thrust": 0.7, "added_mass": 5.0}, []),
        (
            {"mass": 18.5},
            ["knowledge.mass is a factor on what the model has, and the controller believes 18.5 times that"],
        ),
    ],
)
def test_a_number_in_place_of_a_factor_is_told(factors, told):
    assert unlikely_factor_words(KnowledgeBlock(**factors)) == told
