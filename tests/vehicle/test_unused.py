"""Thrusters that are none, and numbers of thrusters that nothing reads, are named."""

import warnings

import mujoco
import pytest
from support.places import CUBE, REPO

import cube_sim


def cube():
    return mujoco.MjSpec.from_file(str(CUBE))


def test_an_actuator_beside_a_characteristic_that_is_no_thruster_is_named():
    spec = cube()
    spec.actuators[2].biastype = mujoco.mjtBias.mjBIAS_NONE
    with pytest.warns(UserWarning, match="actuator 'T3' pushes 'hull' and is no thruster"):
        cube_sim.load_model(spec)


def test_a_characteristic_that_nothing_reads_is_named():
    spec = cube()
    for actuator in list(spec.actuators):
        spec.delete(actuator)
    with pytest.warns(UserWarning, match="hull:thruster_characteristic holds for no thruster of 'hull': it has none"):
        cube_sim.load_model(spec)
    spec = cube()
    for i in range(1, 9):
        spec.add_numeric(name=f"T{i}:thruster_voltage", size=1, data=[12.0])
    with pytest.warns(UserWarning, match="hull:thruster_voltage holds for no thruster of 'hull': each has its own"):
        cube_sim.load_model(spec)


def test_parameters_given_at_load_may_be_of_a_hull_and_of_its_thrusters():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cube_sim.load_model(
            CUBE, {f"{owner}:thruster_dead_zone": [-1.0, 1.0] for owner in ("hull", *(f"T{i}" for i in range(1, 9)))}
        )


@pytest.mark.parametrize("file", sorted((REPO / "models").glob("*.xml")), ids=lambda file: file.stem)
def test_no_model_that_is_shipped_has_any(file):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cube_sim.load_model(file)
