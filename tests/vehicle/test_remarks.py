"""Words on a vehicle left to itself: what it weighs, how it lies, whether its drag fits the time step."""

import pytest
from support.places import CUBE

import cube_sim
from cube_sim.vehicle.remarks import remarks


def said(parameters, forces=None):
    model = cube_sim.load_model(CUBE, parameters, forces)
    return "; ".join(remarks(model, cube_sim.Vehicle.from_model(model)))


def still(time, position, rotation, velocity, through_water):
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({}, "weighs 1226 N, displaces 1226 N of water: neutral"),
        ({"hull:mass": 130.0}, "sinks with 49 N"),
        ({"hull:mass": 62.5}, "rises with 613 N; floats with its origin 0.02 m below the surface"),
        ({"hull:centre_of_buoyancy": [0, 0, 0]}, "nothing rights it"),
        ({"hull:centre_of_buoyancy": [0.02, 0, 0.02]}, "rests tilted by 45 deg; level it has to be held with 24.5 N m"),
        ({"hull:linear_damping": [4e4] + [5.0] * 5}, "is stiff for the time step of 0.01 s: 2 of 2.785"),
    ],
)
def test_what_is_worth_a_word(parameters, words):
    assert words in said(parameters)


def test_what_is_as_usual_is_not():
    assert said({}).count(";") == 0


def test_a_force_of_ones_own_is_named():
    assert "hull:force is not looked at here" in said({}, {"hull": still})
