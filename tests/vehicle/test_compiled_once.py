"""A model that is compiled once and whose copies get other numbers is, to the bit, one compiled with them."""

import warnings
from itertools import product

import mujoco
import numpy as np
import pytest
from support.places import CUBE, MODEL_FILES, MODELS

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.compiled_once import CompiledOnce
from cube_sim.vehicle.joining import ModelPart, compiled_together, joined_parameters
from cube_sim.vehicle.mjcf.elements import ELEMENT_PARAMETERS, element_values
from cube_sim.vehicle.unlikely.words import unlikely_words
from cube_sim.vehicle.vehicle import hull_names

OF_PICTURES = {"stat.extent", "stat.meansize"}
COUNTED = ("velocity_products", "fin_products")
"""Rows that begin with whole numbers; their last is the coefficient."""


def numbers(model):
    """All arrays and numbers of a model, by name, as bytes."""
    found = {}
    for prefix, part in (("", model), ("opt.", model.opt), ("stat.", model.stat)):
        for name in dir(part):
            value = getattr(part, name) if not name.startswith("_") else None
            if isinstance(value, np.ndarray | int | float) and f"{prefix}{name}" not in OF_PICTURES:
                found[f"{prefix}{name}"] = np.asarray(value).tobytes()
    return found


def settable(model):
    """Every parameter of a model -> its values (n,)."""
    named = {each.name: each.data.copy() for each in map(model.numeric, range(model.nnumeric - 1)) if ":" in each.name}
    for owner, part in product(hull_names(model), ELEMENT_PARAMETERS):
        values = element_values(model, f"{owner}:{part}")
        named[f"{owner}:{part}"] = values[:1] if part == "thruster_lag" else values
    return named


def scaled(name, values, factor):
    given = values.copy()
    if name.endswith("thruster_characteristic"):
        given[1::2] *= factor
    elif name.endswith(COUNTED):
        rows = given.reshape(-1, 4 if name.endswith(COUNTED[0]) else 3)
        rows[:, -1] *= factor
    else:
        given *= factor
    return given.tolist()


def compiled(path, parameters):
    """A model; None where there is none with such numbers."""
    try:
        return cube_sim.load_model(path, parameters)
    except ModelError:
        return None


@pytest.mark.parametrize("path", MODEL_FILES, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("ignore")
def test_every_parameter_of_every_model_is_to_the_bit_as_compiled(path):
    nominal = settable(cube_sim.load_model(path))
    set_in_place = refused = 0
    for name, values in nominal.items():
        first, wanted = ({name: scaled(name, values, factor)} for factor in (0.93, 1.1))
        right = compiled(path, wanted)
        if compiled(path, first) is None:
            first = {name: values.tolist()}
        model = CompiledOnce.of(path, first).with_parameters(wanted)
        if right is None:
            assert model is None, name
            refused += 1
        elif model is not None:
            there, differs = numbers(right), numbers(model)
            assert [each for each in there if differs[each] != there[each]] == [], name
            set_in_place += 1
    assert set_in_place >= 0.8 * (len(nominal) - refused)
    assert set_in_place >= 10


@pytest.mark.parametrize("path", MODEL_FILES, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("ignore")
def test_all_parameters_at_once_are_as_compiled_whatever_it_was_compiled_with(path):
    nominal = {name: values for name, values in settable(cube_sim.load_model(path)).items() if values.any()}
    rng, kept = np.random.default_rng(7), {}
    for name, values in nominal.items():  # one after the other, so that what cannot go together is left out
        given = {name: scaled(name, values, float(rng.uniform(0.97, 1.03)))}
        if compiled(path, kept | given) is not None:
            kept |= given
    once, compared = CompiledOnce.of(path, kept), 0
    for factor in (0.995, 1.003, 1.01):
        other = {name: scaled(name, np.array(given), factor) for name, given in kept.items()}
        model, right = once.with_parameters(other), compiled(path, other)
        if right is not None and model is not None:
            there, here = numbers(right), numbers(model)
            assert [each for each in there if here[each] != there[each]] == []
            compared += 1
    assert len(kept) >= 10
    assert compared >= 1


@pytest.mark.parametrize(
    ("path", "first", "then"),
    [
        (CUBE, {"hull:volume": [0.13]}, {"hull:mass": [130.0]}),  # another parameter
        (CUBE, {"hull:added_mass": [60.0] * 6}, {"hull:added_mass": np.diag([60.0] * 6).ravel().tolist()}),
        (CUBE, {"hull:mass": [130.0]}, {"hull:mass": [-1.0]}),  # refused
        (CUBE, {"hull:thruster_dead_zone": [-1.0, 1.0]}, {"hull:thruster_dead_zone": [1.0, 2.0]}),
        (MODELS / "rov6.xml", {"hull:inertia": [0.3, 0.3, 0.3]}, {"hull:inertia": [0.3, 0.35, 0.32]}),  # whose axes?
    ],
)
@pytest.mark.filterwarnings("ignore")
def test_where_more_than_numbers_would_change_the_file_is_to_be_compiled(path, first, then):
    assert CompiledOnce.of(path, first).with_parameters(then) is None


def test_a_copy_is_told_of_by_its_own_numbers():
    area = "rudder:fin_area"
    once = CompiledOnce.of(MODELS / "remus100.xml", {area: [0.007]})
    model = once.with_parameters({area: [7.0]})
    assert model is not None
    assert unlikely_words(once.model) == []
    assert [said.startswith("fin 'rudder' has an area of 7 m^2") for said in unlikely_words(model)] == [True]


def test_a_range_that_would_cut_off_the_curve_is_found_by_compiling():
    """The CUBE's file holds commands between -1 and 1: a curve that runs further is refused at load."""
    curve = settable(cube_sim.load_model(CUBE))["hull:thruster_characteristic"]
    wider = curve.copy()
    wider[0::2] *= 1.2
    once = CompiledOnce.of(CUBE, {"hull:thruster_characteristic": curve.tolist()})
    assert once.with_parameters({"hull:thruster_characteristic": wider.tolist()}) is None
    with pytest.raises(ModelError, match="cuts off its curve"):
        cube_sim.load_model(CUBE, {"hull:thruster_characteristic": wider})


def test_what_it_was_compiled_with_is_nobodys_to_step():
    once = CompiledOnce.of(CUBE, {"hull:mass": [130.0]})
    before = numbers(once.model)
    for mass in (130.0, 140.0):
        model = once.with_parameters({"hull:mass": [mass]})
        model.opt.wind[:] = 0.3
        model.body_mass[:] = 1.0
        mujoco.mj_step(model, mujoco.MjData(model))
    assert numbers(once.model) == before


@pytest.mark.parametrize("order", [1, -1])
def test_a_thruster_s_own_lag_comes_after_its_hulls_however_they_are_given(order):
    given = dict([("hull:thruster_lag", [0.2]), ("T3:thruster_lag", [0.1])][::order])
    model = cube_sim.load_model(CUBE)
    cube_sim.set_parameters(model, given)
    assert model.actuator("T3").dynprm[0] == 0.1
    assert model.actuator("T4").dynprm[0] == 0.2


def test_an_arm_on_the_hull_and_means_that_the_file_says_itself():
    text = CUBE.read_text().replace("<worldbody>", '<statistic meanmass="3"/><worldbody>', 1)
    spec = mujoco.MjSpec.from_string(text)
    arm = spec.body("hull").add_body(name="arm", pos=[0.2, 0.0, 0.0])
    arm.add_joint(name="elbow", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 1, 0])
    arm.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.05, 0, 0], mass=2.0)
    once = CompiledOnce.of(spec, {"hull:mass": [130.0]})
    model, right = once.with_parameters({"hull:mass": [150.0]}), cube_sim.load_model(spec, {"hull:mass": [150.0]})
    assert numbers(model) == numbers(right)
    assert model.stat.meanmass == 3.0
    assert model.stat.meaninertia != once.model.stat.meaninertia


@pytest.mark.filterwarnings("ignore")
def test_of_several_files_in_one_model_too(tmp_path):
    """Mass and volume of one, curve and dead zone of the other, a race that counts the actuators of its own file."""
    files = str(CUBE), str(MODELS / "nps_auv2.xml"), str(CUBE)
    curve = settable(cube_sim.load_model(CUBE))["hull:thruster_characteristic"]

    def parts(factor):
        given = (
            {"hull:mass": [130.0 * factor], "hull:volume": [0.13 * factor]},
            {"rudder:fin_area": [0.25 * factor]},
            {
                "hull:thruster_characteristic": scaled("hull:thruster_characteristic", curve, factor),
                "hull:thruster_dead_zone": [-factor, factor],
            },
        )
        prefixes, again = ("a/", "b/", "c/"), (False, False, True)
        return [ModelPart(*each) for each in zip(files, prefixes, given, again, strict=True)]

    once = compiled_together(parts(1.0), 2)
    model, right = once.with_parameters(joined_parameters(parts(0.97))), compiled_together(parts(0.97), 2).model
    there, here = numbers(right), numbers(model)
    assert [each for each in there if here[each] != there[each]] == []
    assert numbers(once.model) != there


def test_mujoco_says_nothing_of_a_copy():
    once = CompiledOnce.of(CUBE, {"hull:mass": [130.0]})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert once.with_parameters({"hull:mass": [140.0]}) is not None
