"""Thruster curves read all at once are the characteristics, one by one."""

from __future__ import annotations

import numpy as np
import pytest
from support.places import MODELS
from support.vehicles import vehicle

from cube_sim.vehicle import faults
from cube_sim.vehicle.loading import load_model
from cube_sim.vehicle.power_supply import PowerSupply
from cube_sim.vehicle.vehicle import Vehicle

NAMES = ["cube", "cube_as_built", "bluerov2_heavy", "jack", "infante", "torpedo"]


@pytest.mark.parametrize("name", NAMES)
def test_forces_and_commands_are_those_of_each_characteristic(name):
    thrusters, rng = vehicle(name).thrusters, np.random.default_rng(1)
    limits = thrusters.limits
    for k in range(300):
        asked = rng.uniform(1.2 * limits[:, 0], 1.2 * limits[:, 3])
        if k % 3 == 0:  # at the edges and inside the dead zone
            asked = rng.choice(np.column_stack([limits, 0.5 * limits, np.zeros(len(limits))]), axis=1)
        commands = thrusters.command(asked)
        each = [c.command(F) for c, F in zip(thrusters.characteristics, asked.tolist(), strict=True)]
        np.testing.assert_allclose(commands, each, rtol=0.0, atol=1e-14)
        forces = thrusters.force(commands)
        each = [float(c.force(x)) for c, x in zip(thrusters.characteristics, commands, strict=True)]
        np.testing.assert_allclose(forces, each, rtol=1e-13, atol=1e-12)


def test_numbers_for_another_number_of_thrusters_are_refused():
    thrusters = vehicle("cube").thrusters
    for wrong in ([1.0], np.zeros((8, 2)), 0.0):
        with pytest.raises(ValueError, match="the vehicle has 8 thrusters"):
            thrusters.command(wrong)
        with pytest.raises(ValueError, match="the vehicle has 8 thrusters"):
            thrusters.force(wrong)


def test_a_damaged_propeller_draws_what_a_whole_one_would():
    model = load_model(MODELS / "cube.xml")
    thrusters = Vehicle.from_model(model).thrusters
    supply, rng = PowerSupply(model, thrusters), np.random.default_rng(2)
    faults.set_efficiency(model, "T2", 0.5)
    faults.set_efficiency(model, "T3", 0.0)
    faults.set_stuck(model, "T4", 7.0)

    class Data:
        time = 0.0
        actuator_force = rng.normal(size=8) * 20.0

    supply.update(Data)
    healthy = Data.actuator_force / np.array([1.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    healthy[2] = 0.0
    np.testing.assert_allclose(supply.power, thrusters.power(healthy), rtol=1e-13)
