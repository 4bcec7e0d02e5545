"""Other parameters for a compiled model: as if it had been loaded with them."""

import copy
import warnings

import mujoco
import numpy as np
import pytest
from support.places import CUBE, MODEL_FILES, MODELS

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.faults import set_efficiency
from cube_sim.vehicle.plugin import packing
from cube_sim.vehicle.vehicle import hull_names

ARRAYS = (
    "body_mass", "body_ipos", "body_inertia", "body_subtreemass", "body_invweight0", "dof_invweight0", "dof_M0",
    "actuator_dynprm", "actuator_ctrlrange", "numeric_data",
)  # fmt: skip
CURVE = np.round(np.column_stack([np.linspace(-0.9, 0.9, 23), np.linspace(-30.0, 30.0, 23)]), 6).ravel()


def moved(model):
    data = mujoco.MjData(model)
    data.qvel[:] = 0.4, -0.2, 0.1, 0.3, 0.5, -0.2
    data.ctrl[:] = np.linspace(-0.8, 0.8, model.nu)
    mujoco.mj_step(model, data, nstep=200)
    return np.concatenate([data.qpos, data.qvel])


@pytest.mark.parametrize(
    "given",
    [
        {"hull:mass": 150.0},
        {"hull:centre_of_mass": [0.01, -0.02, -0.03]},
        {"hull:inertia": [6.0, 7.0, 8.0]},
        {"hull:inertia": [6.0, 7.0, 8.0, 0.5, -0.3, 0.2]},
        {"hull:thruster_lag": 0.1},
        {"T3:thruster_lag": 0.07},
        {"hull:added_mass": [60, 70, 80, 1, 2, 3]},
        {"hull:quadratic_damping": [100, 200, 300, 1, 2, 3], "hull:linear_damping": [1, 2, 3, 4, 5, 6]},
        {"hull:volume": 0.13, "hull:centre_of_buoyancy": [0, 0.01, 0.03], "water:density": 1025.0},
        {"hull:thruster_characteristic": CURVE, "hull:thruster_dead_zone": [-1.0, 2.0]},
    ],
)
def test_a_changed_model_is_one_loaded_so(given):
    changed = cube_sim.load_model(CUBE)
    before = moved(changed)
    cube_sim.set_parameters(changed, given)
    loaded = cube_sim.load_model(CUBE, given)
    packing.packed_parameters(changed)[5] = packing.packed_parameters(loaded)[5]
    for name in ARRAYS:
        np.testing.assert_allclose(getattr(changed, name), getattr(loaded, name), rtol=1e-12, atol=1e-15, err_msg=name)
    after = moved(changed)
    np.testing.assert_allclose(after, moved(loaded), rtol=1e-10, atol=1e-12)
    assert np.abs(after - before).max() > 1e-6


def test_what_load_model_was_given_can_be_changed_and_the_surface_moved():
    model = cube_sim.load_model(CUBE, {"water:surface": 0.0, "T2:thruster_power": [1.0, 2.0]})
    cube_sim.set_parameters(model, {"water:surface": 3.0, "T2:thruster_power": [3.0, 4.0]})
    again = cube_sim.load_model(CUBE, {"water:surface": 3.0, "T2:thruster_power": [3.0, 4.0]})
    np.testing.assert_array_equal(packing.packed_parameters(model), packing.packed_parameters(again))
    assert cube_sim.Vehicle.from_model(model).thrusters.power_coefficients[1].tolist() == [3.0, 4.0]


def test_health_stays_and_a_copy_has_its_own():
    model = cube_sim.load_model(CUBE)
    set_efficiency(model, "T4", 0.25)
    other = copy.copy(model)
    cube_sim.set_parameters(other, {"hull:quadratic_damping": [500.0] * 6})
    assert cube_sim.Vehicle.from_model(model).quadratic_damping[0, 0] == 131.25
    assert cube_sim.Vehicle.from_model(other).quadratic_damping[0, 0] == 500.0
    whole = copy.copy(other)
    set_efficiency(whole, "T4", 1.0)
    assert not np.array_equal(moved(other), moved(whole))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"hull:aded_mass": [1.0] * 6}, "did you mean added_mass"),
        ({"hull:added_mass": [1.0] * 36}, "has 36 values, the model has room for 6"),
        ({"T1:thruster_power": [1.0, 1.0]}, "the model has room for none"),
        ({"hull:added_mass": [-1.0] * 6}, "positive semidefinite"),
        ({"hull:mass": -1.0}, "a mass .* is positive"),
        ({"wing:mass": 1.0}, "is no body"),
        ({"hull:thruster_lag": 1e-3}, "unstable"),
        ({"hull:mass": "heavy"}, "numbers are right"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_changes(given, said):
    model = cube_sim.load_model(CUBE)
    before = model.numeric_data.copy(), model.body_mass.copy(), model.actuator_dynprm.copy()
    with pytest.raises(ModelError, match=said):
        cube_sim.set_parameters(model, {"hull:volume": 0.2, **given})
    for now, then in zip((model.numeric_data, model.body_mass, model.actuator_dynprm), before, strict=True):
        np.testing.assert_array_equal(now, then)


def test_a_diagonal_has_room_where_a_whole_matrix_is():
    """REMUS 100 has matrices of 36 values; as `load_model` does, it takes the six of a diagonal too."""
    given = {"hull:quadratic_damping": [2.0, 90.0, 90.0, 0.1, 50.0, 50.0]}
    changed = cube_sim.load_model(MODELS / "remus100.xml")
    cube_sim.set_parameters(changed, given)
    for matrix, values in given.items():
        np.testing.assert_array_equal(changed.numeric(matrix).data.reshape(6, 6), np.diag(values))
    loaded = packing.packed_parameters(cube_sim.load_model(MODELS / "remus100.xml", given))
    np.testing.assert_array_equal(packing.packed_parameters(changed), loaded)


@pytest.mark.parametrize("name", ["quadratic_damping", "added_mass", "centre_of_buoyancy", "linear_damping"])
def test_a_number_written_where_nothing_reads_it_is_told_with_the_setter(name):
    model = cube_sim.load_model(MODELS / "bluerov2_heavy.xml")
    model.numeric(f"hull:{name}").data[:] += 0.5
    with pytest.warns(
        UserWarning, match=rf"hull:{name} was changed .* cube_sim.set_parameters\(model, {{'hull:{name}'"
    ):
        cube_sim.Vehicle.from_model(model)


@pytest.mark.parametrize("path", MODEL_FILES, ids=lambda path: path.stem)
def test_what_was_loaded_or_set_is_read(path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model = cube_sim.load_model(path)
        cube_sim.Vehicle.from_model(model)
        name = f"{hull_names(model)[0]}:quadratic_damping"
        cube_sim.set_parameters(model, {name: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]})
        cube_sim.Vehicle.from_model(model)


@pytest.mark.parametrize("given", [[1.0], "hull:volume", 3])
def test_parameters_without_names_are_refused(given):
    model = cube_sim.load_model(CUBE)
    for asked in (lambda: cube_sim.set_parameters(model, given), lambda: cube_sim.load_model(CUBE, given)):
        with pytest.raises(TypeError, match="a mapping from names is right, as in"):
            asked()


def test_names_that_are_no_text_and_several_models_are_refused():
    model = cube_sim.load_model(CUBE)
    with pytest.raises(TypeError, match=r"names of parameters are text, .* not 3"):
        cube_sim.set_parameters(model, {3: 4.0})
    with pytest.raises(TypeError, match=r"one mujoco.MjModel is right, not a list: of several, one after the other"):
        cube_sim.set_parameters([model, model], {"hull:volume": 0.13})


def test_what_the_model_was_compiled_without_is_named():
    model = cube_sim.load_model(MODELS / "remus100_propeller.xml")
    with pytest.raises(ModelError, match=r"^hull:coriolis_of_added_mass: takes other terms .* give it to load_model"):
        cube_sim.set_parameters(model, {"hull:coriolis_of_added_mass": 1})
