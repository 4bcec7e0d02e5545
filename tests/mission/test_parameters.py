"""Numbers of the model that a scenario replaces: flown, and known unless the controller has a model of its own."""

import numpy as np
import pytest
from support.places import HELIX

from cube_sim.errors import ScenarioError
from cube_sim.mission import prepare
from cube_sim.mission.hull import believed_hull, flown_hull
from cube_sim.scenario import load

ADDED = [90.0, 100.0, 110.0, 1.3, 1.4, 1.5]
CHANGED = {"parameters.hull:added_mass": ADDED, "parameters.water:density": [1025.0]}


def test_they_take_the_place_of_the_models_and_leave_the_rest():
    nominal, flown = flown_hull(load(HELIX)).vehicle, flown_hull(load(HELIX, CHANGED)).vehicle
    np.testing.assert_array_equal(flown.added_mass, np.diag(ADDED))
    assert flown.displaced_mass == pytest.approx(1.025 * nominal.displaced_mass)
    np.testing.assert_array_equal(flown.quadratic_damping, nominal.quadratic_damping)
    np.testing.assert_array_equal(flown.thrusters.limits, nominal.thrusters.limits)  # the helix sets a dead zone


def test_the_controller_knows_them_unless_it_has_a_model_of_its_own():
    loaded = load(HELIX, CHANGED)
    np.testing.assert_array_equal(believed_hull(loaded, flown_hull(loaded)).vehicle.added_mass, np.diag(ADDED))
    apart = load(HELIX, {**CHANGED, "knowledge.model": "../models/cube.xml"})
    flown = flown_hull(apart)
    np.testing.assert_array_equal(flown.vehicle.added_mass, np.diag(ADDED))
    np.testing.assert_array_equal(believed_hull(apart, flown).vehicle.added_mass[:3, :3], 79.8 * np.eye(3))


def test_a_resolved_scenario_keeps_them(tmp_path):
    loaded = load(HELIX, CHANGED)
    again = tmp_path / "again.yaml"
    again.write_text(loaded.resolved_yaml())
    assert load(again).scenario == loaded.scenario


@pytest.mark.parametrize(
    ("name", "values", "said"),
    [
        ("hull:aded_mass", ADDED, "did you mean added_mass?"),
        ("hul:added_mass", ADDED, "no body 'hul'"),
        ("hull:added_mass", [1.0, 2.0], "hull:added_mass"),
        ("hull:added_mass", 3.0, "must be a list"),
        ("hull:added_mass", ["much"], "must be a number"),
    ],
)
def test_what_the_model_cannot_have_is_one_line(name, values, said):
    with pytest.raises(ScenarioError) as refused:
        prepare(load(HELIX, {f"parameters.{name}": values}))
    assert len(refused.value.mistakes) == 1
    assert said in refused.value.mistakes[0]
    assert "parameters" in refused.value.mistakes[0]
