"""Commands, forces and pulses of all thrusters at once: one row, many rows, and what is no row."""

import numpy as np
import pytest
from support.places import CUBE

import cube_sim

THRUSTERS = cube_sim.Vehicle.from_model(cube_sim.load_model(CUBE)).thrusters
FUNCTIONS = {
    "command": np.linspace(-30.0, 40.0, 24).reshape(3, 8),
    "force": np.linspace(-1.0, 1.0, 24).reshape(3, 8),
    "pwm": np.linspace(-30.0, 40.0, 24).reshape(3, 8),
    "pwm_of_command": np.linspace(-1.0, 1.0, 24).reshape(3, 8),
    "command_of_pwm": np.linspace(1100.0, 1900.0, 24).reshape(3, 8),
    "force_of_pwm": np.linspace(1100.0, 1900.0, 24).reshape(3, 8),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_many_rows_are_answered_as_one_by_one(name):
    function, rows = getattr(THRUSTERS, name), FUNCTIONS[name]
    answers = function(rows[None])
    assert answers.shape == (1, 3, 8)
    np.testing.assert_array_equal(answers[0], [function(row) for row in rows])
    assert function(np.empty((0, 8))).shape == (0, 8)


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize(
    ("given", "said"),
    [
        ([1.0], r"has shape \(1,\); the vehicle has 8 thrusters"),
        (1.0, r"has shape \(\); the vehicle has 8 thrusters"),
        (np.zeros((8, 2)), r"has shape \(8, 2\)"),
        ([0.0, 0.0, np.nan, 0.0, 0.0, 0.0, 0.0, 0.0], "is not a number for T3"),
        (["a"] * 8, "numbers are right"),
    ],
)
def test_what_is_no_row_is_one_clear_error(name, given, said):
    with pytest.raises(ValueError, match=said):
        getattr(THRUSTERS, name)(given)
