"""Every mistake in a model's water is refused when it is loaded, by the name of the element at fault."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from support.edited_cube import T1, edited, edited_text
from support.places import CUBE
from support.vehicles import vehicle
from support.water_bodies import Body

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.plugin.warnings import collect_warnings

LOPSIDED = np.eye(6) + np.eye(6, k=1)
INDEFINITE = np.diag([1.0, 1.0, 1.0, 1.0, 1.0, -0.1])
CURVE = [-1.0, -40.0, 0.0, 0.0, 1.0, 50.0]

MISTAKES = [
    ("hull:added_mass", LOPSIDED, "not symmetric: entry (1,2) is 1, (2,1) is 0"),
    ("hull:added_mass", INDEFINITE, "not positive semidefinite"),
    ("hull:added_mass", [1.0, 2.0, 3.0], "has 3 values; it takes 6 (a diagonal) or 36"),
    ("hull:added_mass", [np.nan] * 6, "not finite"),
    ("hull:volume", [-0.1], "is -0.1"),
    ("hull:volume", [0.1, 0.2], "has 2 values; it takes 1"),
    ("hull:volume", [np.inf], "not finite"),
    ("hull:volume", "abc", "is 'abc'; numbers are right"),
    ("hull:volume", [[0.1], [0.1, 0.2]], "numbers are right"),
    ("hull:centre_of_buoyancy", [0.0, 0.0], "has 2 values; it takes 3"),
    ("hull:linear_damping", [1.0, 1.0, 1.0, 1.0, 1.0, -1.0], "negative diagonal"),
    ("hull:quadratic_damping", [-1.0, 1.0, 1.0, 1.0, 1.0, 1.0], "negative diagonal"),
    ("hull:linear_damping", np.ones(7), "has 7 values"),
    ("hull:linear_damping", np.eye(6) - 1.1 * np.eye(6, k=3) - 1.1 * np.eye(6, k=-3), "feeds energy into some motion"),
    ("hull:linear_damping", np.eye(6) + 2.1 * np.eye(6, k=1), "feeds energy into some motion"),
    ("hull:quadratic_damping", np.eye(6) - 1.9 * np.eye(6, k=3), "motion x and about x together: entries (1,4) = -1.9"),
    ("hull:quadratic_damping", np.diag([0.0, 1, 1, 1, 1, 1]) + 0.01 * np.eye(6, k=5), "motion x and about z together"),
    ("water:density", [0.0], "density [kg/m^3] is positive"),
    ("water:density", [np.nan], "not finite"),
    ("hull:thruster_dead_zone", [0.4, -0.3], "out of order"),
    ("hull:thruster_dead_zone", [-0.4, 99.0], "out of order"),
    ("hull:thruster_dead_zone", [0.4], "has 1 value; it takes 2"),
    ("hull:thruster_dead_zone", [np.nan, 1.0], "not finite"),
    ("hull:thruster_pwm", [1100.0, 1500.0], "has 2 values; it takes 3"),
    ("hull:thruster_pwm", [1100.0, 1900.0, 1500.0], "[1100, 1900, 1500] us is out of order"),
    ("hull:thruster_pwm", [1500.0, 1500.0, 1900.0], "rest between the others"),
    ("hull:thruster_pwm", [-1.0, 0.0, 1.0], "positive pulse widths"),
    ("T5:thruster_pwm", [1100.0, np.nan, 1900.0], "not finite"),
    ("hull:thruster_voltage", [0.0], "is 0; the voltage of a characteristic [V] is positive"),
    ("T5:thruster_voltage", [12.0, 16.0], "has 2 values; it takes 1"),
    ("hull:thruster_power", [-1.0, 1.0], "takes power in both directions"),
    ("hull:thruster_pmw", [1100.0, 1500.0, 1900.0], "did you mean thruster_pwm?"),
    ("hull:thruster_characteristic", [*CURVE, 2.0], "has 7 values; it takes pairs"),
    ("hull:thruster_characteristic", [1.0, -40.0, 0.0, 0.0, -1.0, 50.0], "commands do not increase"),
    ("hull:thruster_characteristic", [-1.0, 40.0, 0.0, 0.0, 1.0, -50.0], "never decrease"),
    ("hull:thruster_characteristic", [-1.0, -40.0, 1.0, 50.0], "no pair has force 0"),
    ("hull:thruster_characteristic", [1100, -39.9, 1472, 0, 1528, 0, 1900, 51.4], "gives -39.9 N at command 0"),
    (
        "hull:thruster_characteristic",
        [0.0, -5.0, 0.2, 0.0, 0.3, 0.0, 1.0, 9.0],
        "gives -5 N at command 0, where the lag",
    ),
    ("hull:aded_mass", [1.0] * 6, "is no parameter of the water (did you mean added_mass?)"),
    ("hull:colour", [1.0], "the nearest volume, "),
    ("volume", [0.1], "is nobody's; write <hull>:volume"),
    ("T1:gain", [0.1], "is no parameter of the water"),
    ("hul:added_mass", [1.0] * 6, "no body 'hul'; the model has hull"),
    ("T9:thruster_dead_zone", [-1.0, 1.0], "no body or thruster 'T9'"),
    ("T1:thruster_dead_zone", [1.0, -1.0], "out of order"),
    ("T1:volume", [1.0], "no body 'T1'"),
]


@pytest.mark.parametrize(("element", "value", "reason"), MISTAKES, ids=[f"{e}-{r[:24]}" for e, _, r in MISTAKES])
def test_wrong_parameter(element, value, reason):
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(CUBE, {element: value})
    assert caught.value.element == element
    assert reason in str(caught.value)
    assert str(caught.value).startswith(str(CUBE))
    assert "\n" not in str(caught.value)


def with_options(**changes) -> mujoco.MjSpec:
    spec = mujoco.MjSpec.from_file(str(CUBE))
    for name, value in changes.items():
        setattr(spec.option, name, value)
    return spec


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"wind": [np.nan, 0.0, 0.0]}, "option: wind is nan 0 0; finite numbers are right"),
        ({"gravity": [0.0, 0.0, np.inf]}, "option: gravity is 0 0 inf"),
        ({"density": 1000.0}, "MuJoCo's own fluid model"),
        ({"viscosity": 0.001}, "MuJoCo's own fluid model"),
        (
            {"disableflags": int(mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER)},
            "skips the passive stage",
        ),
    ],
)
def test_wrong_option(changes, reason):
    with pytest.raises(ModelError, match=reason):
        cube_sim.load_model(with_options(**changes))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("disableflags", int(mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER)),
        ("density", 1000.0),
        ("viscosity", 0.001),
    ],
)
def test_a_wrong_option_set_after_loading_is_not_flown_without_a_word(name, value):
    """A hull whose water is skipped, or doubled, gets no force that looks like one; MuJoCo warns at the first step."""
    model = cube_sim.load_model(CUBE)
    data = mujoco.MjData(model)
    setattr(model.opt, name, value)
    with collect_warnings() as warnings:
        mujoco.mj_step(model, data)
    assert data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number > 0
    assert any("QACC" in text for text in warnings)
    setattr(model.opt, name, 0)
    mujoco.mj_resetData(model, data)
    mujoco.mj_step(model, data)
    assert data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number == 0


def test_no_water_at_all():
    with pytest.raises(ModelError, match="no hull to put into the water"):
        cube_sim.load_model(
            mujoco.MjSpec.from_string(
                "<mujoco><worldbody><body name='b'><freejoint/><geom size='.1'/></body></worldbody></mujoco>"
            )
        )


def test_hull_without_a_free_joint():
    with pytest.raises(ModelError, match="no free joint"):
        cube_sim.load_model(edited(('<freejoint name="hull"/>', '<joint name="hull" type="hinge"/>')))


def test_missing_volume():
    """A hull without one would sink without a word; a volume of zero says that it shall."""
    spec = mujoco.MjSpec.from_file(str(CUBE))
    spec.delete(next(n for n in spec.numerics if n.name == "hull:volume"))
    with pytest.raises(ModelError, match="hull:volume: is missing; 'hull' needs the volume it displaces"):
        cube_sim.load_model(spec)
    assert cube_sim.Vehicle.from_model(cube_sim.load_model(spec, {"hull:volume": 0.0})).displaced_mass == 0.0


def with_numerics(*names: str, values: str = "1") -> mujoco.MjSpec:
    more = "".join(f'<numeric name="{name}" data="{values}"/>' for name in names)
    return edited(("<custom>", f"<custom>{more}"))


@pytest.mark.parametrize("values", ["1 2 3", "nan"])
def test_other_peoples_numerics_are_left_alone(values):
    names = (
        "mjpc:agent_planner",
        "residual:speed",
        "a:b:c",
        "motor:current",
        "groundwater:level",
        "plain",
        "camera:gain:",
        "weather:current",
        "camera:damping",
        "plugin_added_mass",
        "hull_colour",
        "hullabaloo",
    )
    spec = with_numerics(*names, values=values)
    model = cube_sim.load_model(spec)
    np.testing.assert_array_equal(cube_sim.Vehicle.from_model(model).added_mass, vehicle("cube").added_mass)
    for name in names:
        np.testing.assert_array_equal(model.numeric(name).data, np.array(values.split(), dtype=float))


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("hul:aded_mass", "did you mean added_mass?"),
        ("anything:thruster_deadzone", "did you mean thruster_dead_zone?"),
        ("ship:volume", "no body 'ship'"),
        ("hull:buoyant", "is no parameter of the water; there are"),
        ("T8:thrust", "is no parameter of the water; there are"),
        ("water:densty", "is nothing that water has; there are water:density"),
        ("a/water:curent", "is nothing that water has; there are water:density"),
        ("water:temperature", "is nothing that water has"),
        ("Water:current", "is nothing that water has; there are water:density"),
        ("watr:current", "is nothing that water has"),
        ("a/Water:Density", "is nothing that water has"),
        ("water.current", "has no colon, so it is nobody's; write water:current"),
        ("hull.added_mass", "has no colon, so it is nobody's; write hull:added_mass"),
        ("hull_added_mass", "write hull:added_mass"),
        ("Hull-volume", "write hull:volume"),
        ("T1_thruster_dead_zone", "write T1:thruster_dead_zone"),
        ("hul:damping", "the nearest linear_damping, quadratic_damping, "),
        ("hull2:drag", "is no parameter of the water"),
    ],
)
def test_a_slip_of_the_pen_in_the_file_is_refused(name, reason):
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(with_numerics(name))
    assert caught.value.element == name
    assert reason in caught.value.reason


def with_text(name: str, data: str) -> mujoco.MjSpec:
    return edited(("<custom>", f'<custom><text name="{name}" data="{data}"/>'))


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("hull:forces", "is no force of a hull; write <hull>:force, with one of hull"),
        ("hull:Force", "is no force of a hull"),
        ("Hull:force", "is no force of a hull"),
        ("hull_force", "has no colon, so it is nobody's; write hull:force"),
        ("hull.force", "write hull:force"),
        ("ship:force", "no hull 'ship'; the model has hull"),
    ],
)
def test_a_text_that_was_meant_to_name_a_force_is_refused(name, reason):
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(with_text(name, "cube_sim.vehicle.infante:planar_lift"))
    assert caught.value.element == name
    assert reason in caught.value.reason


@pytest.mark.parametrize("name", ["plugin:force", "hull:colour", "author", "task:forces", "enforce"])
def test_other_peoples_texts_are_left_alone(name):
    model = cube_sim.load_model(with_text(name, "left alone"))
    assert bytes(model.text_data).startswith(b"left alone")


def test_missing_density():
    with pytest.raises(ModelError, match="water:density: is missing"):
        cube_sim.load_model(edited(('<numeric name="water:density" data="1000"/>', "")))


def test_missing_characteristic_names_the_thruster():
    spec = mujoco.MjSpec.from_file(str(CUBE))
    spec.delete(next(n for n in spec.numerics if n.name == "hull:thruster_dead_zone"))
    with pytest.raises(ModelError, match="thruster 'T1' needs it"):
        cube_sim.load_model(spec)


def test_thruster_that_is_no_site_actuator():
    with pytest.raises(ModelError, match=r"T1: .*site"):
        cube_sim.load_model(edited((T1, '<general name="T1" class="thruster" body="hull"')))


def test_thruster_without_a_lag():
    with pytest.raises(ModelError, match=r'T1: .*dyntype="filter"'):
        cube_sim.load_model(edited(('dyntype="filter" ', "")))


def test_tendon_armature_on_a_hull():
    inside = (
        '<site name="a"/><body><joint name="arm" axis="0 1 0"/><geom size="0.05" pos="0.3 0 0"/>'
        '<site name="b" pos="0.3 0 0"/></body>'
    )
    extra = '<tendon><spatial armature="1"><site site="a"/><site site="b"/></spatial></tendon>'
    with pytest.raises(ModelError, match="tendon"):
        Body().model(inside=inside, extra=extra)


@pytest.mark.parametrize("text", ["<mujoco><worldbody>", "", "<mujoco><nonsense/></mujoco>"])
def test_a_file_that_is_no_model(tmp_path, text):
    path = tmp_path / "broken.xml"
    path.write_text(text)
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("sensor", ['<gyro site="nope"/>', '<gyro name="turning" site="nope"/>'])
@pytest.mark.parametrize("in_memory", [True, False])
def test_a_reference_to_nothing(tmp_path, sensor, in_memory):
    """MuJoCo's copy of a spec drops such an element silently; loading must not."""
    path = tmp_path / "cube.xml"
    path.write_text(edited_text(('<gyro name="gyro"', f'{sensor}<gyro name="gyro"')))
    with pytest.raises(ModelError, match=r"turning|one of the sensors|nope"):
        cube_sim.load_model(mujoco.MjSpec.from_file(str(path)) if in_memory else path)


@pytest.mark.parametrize(
    ("thing", "reason"),
    [
        (None, "loaded from an MJCF file or an MjSpec, not from None"),
        (b"cube.xml", "not from b'cube.xml'"),
        (mujoco.MjModel.from_xml_string("<mujoco/>"), "not from an MjModel, which is compiled already"),
    ],
)
def test_what_is_no_model(thing, reason):
    with pytest.raises(ModelError, match=reason):
        cube_sim.load_model(thing)


def test_mujocos_warnings_are_pythons(tmp_path, monkeypatch):
    """And leave no log in the working directory; a handler that was there before stays."""
    monkeypatch.chdir(tmp_path)
    Path("cube.xml").write_text(edited_text(("<custom>", '<custom><numeric name="own" data="nan"/>')))
    with collect_warnings() as mine:
        with pytest.warns(UserWarning, match="MuJoCo: XML contains a 'NaN'"):
            cube_sim.load_model("cube.xml")
        mujoco.MjSpec.from_file("cube.xml")
    assert len(mine) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["cube.xml"]


def test_no_such_file():
    with pytest.raises(ModelError, match="no such model file"):
        cube_sim.load_model("nowhere/at_all.xml")


def test_the_packed_numeric_is_ours():
    with pytest.raises(ModelError, match="written by load_model"):
        cube_sim.load_model(edited(("<custom>", '<custom><numeric name="cube_sim:packed" data="1"/>')))


def test_vehicle_needs_water_and_the_right_name():
    dry = mujoco.MjModel.from_xml_path(str(CUBE))
    with pytest.raises(ModelError, match="no water"):
        cube_sim.Vehicle.from_model(dry)
    with pytest.raises(ModelError, match="ship: is no hull; the model has hull"):
        cube_sim.Vehicle.from_model(cube_sim.load_model(CUBE), "ship")
