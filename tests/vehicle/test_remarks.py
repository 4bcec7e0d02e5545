"""Words on a vehicle left to itself: what it weighs, how it lies, whether its drag fits the time step."""

import mujoco
import pytest
from support.catalogue.vehicles import catalogue
from support.command_line import call
from support.edited_cube import T1, edited_text
from support.flights import FORCES_ONLY
from support.places import CUBE, HELIX, MODEL_FILES, REPO

import cube_sim
from cube_sim.vehicle.remarks import cautions, remarks


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
        ({"hull:mass": 3.0}, "m above the surface"),
        ({"hull:centre_of_buoyancy": [0, 0, 0]}, "nothing rights it"),
        ({"hull:centre_of_buoyancy": [0.02, 0, 0.02]}, "rests tilted by 45 deg; level it has to be held with 24.5 N m"),
        ({"hull:centre_of_buoyancy": [0, 0, -0.02]}, "its centre of mass lies above its centre of buoyancy"),
        ({"hull:linear_damping": [4e4] + [5.0] * 5}, "is stiff for the time step of 0.01 s: 2 of 2.785"),
    ],
)
def test_what_is_worth_a_word(parameters, words):
    assert words in said(parameters)


def test_what_is_as_usual_is_not():
    assert said({}).count(";") == 0


def test_a_force_of_ones_own_is_named():
    assert "hull:force is not looked at here" in said({}, {"hull": still})


def cautioned(spec, parameters=None):
    model = cube_sim.load_model(spec, parameters)
    return cautions(model, cube_sim.Vehicle.from_model(model))


def test_shipped_vehicles_are_cautioned_of_nothing():
    for path in MODEL_FILES:
        assert cautioned(path) == [], path.stem


def test_a_weight_that_no_thruster_holds_is_cautioned_of():
    (said,) = cautioned(CUBE, {"hull:mass": 200.0})
    assert said == "sinks with 736 N, and its thrusters give 412 N at most, whichever way it points"
    assert cautioned(CUBE, {"hull:mass": 130.0}) == []


@pytest.mark.parametrize(
    ("centre", "told"),
    [
        ([0.02, 0.0, 0.02], []),
        ([0.3, 0.0, 0.02], ["left to itself it rests tilted by 86 deg; level it has to be held with 368 N m, and its"]),
        ([0.0, 0.0, -2.0], ["its centre of mass lies above its centre of buoyancy: left to itself it turns over"]),
    ],
)
def test_a_hull_that_its_thrusters_do_not_hold_upright_is_cautioned_of(centre, told):
    found = cautioned(CUBE, {"hull:centre_of_buoyancy": centre})
    assert [text[: len(start)] for text, start in zip(found, told, strict=True)] == told


def test_no_vehicle_of_the_catalogue_is_called_aslant():
    for entry in catalogue().values():
        if not entry.lost:
            found = cautioned(mujoco.MjSpec.from_string(entry.make()))
            assert not [text for text in found if "tilted" in text or "turns over" in text], entry.name


def test_a_tilt_that_no_thruster_holds_is_told_with_what_they_can():
    tilted = {"hull:centre_of_buoyancy": [0.2, 0, 0.02]}
    assert "level it has to be held with 245 N m, and its thrusters give" in said(tilted)
    assert "and its thrusters" not in said({"hull:centre_of_buoyancy": [0.02, 0, 0.02]})


@pytest.mark.filterwarnings("ignore:fin 'rudder' has an area")
@pytest.mark.parametrize(
    ("parameters", "what"),
    [
        ({"rudder:fin_area": 6e3}, "the lift of its fins"),
        ({"hull:cross_flow_drag": [1e5, 1.0]}, "the lift and drag of its strips and velocity products"),
    ],
)
def test_lift_that_is_too_steep_for_the_time_step_is_cautioned_of(parameters, what):
    model = REPO / "models" / "nps_auv2.xml"
    assert cautioned(model) == []
    said = cautioned(model, parameters)
    assert any(each.startswith(f"{what} at 1 m/s or rad/s is stiff for the time step") for each in said)


def test_stiff_drag_and_a_thruster_that_is_none_are_cautioned_of():
    assert "is stiff for the time step" in cautioned(CUBE, {"hull:linear_damping": [4e4] + [5.0] * 5})[0]
    spec = mujoco.MjSpec.from_file(str(CUBE))
    spec.actuators[2].biastype = mujoco.mjtBias.mjBIAS_NONE
    with pytest.warns(UserWarning, match="T3"):
        (said,) = cautioned(spec)
    assert said.startswith("actuator 'T3' pushes 'hull' and is no thruster")


@pytest.mark.flight
@pytest.mark.filterwarnings("ignore:actuator 'T3'")
def test_cautions_stand_in_the_log_of_a_run_and_before_it(tmp_path, monkeypatch, capsys):
    (tmp_path / "cube.xml").write_text(edited_text((T1.replace("T1", "T3"), '<general name="T3" site="T3"')))
    settings = {"model": str(tmp_path / "cube.xml"), "duration_s": 0.1, "checks": FORCES_ONLY}
    run = cube_sim.run(HELIX, settings, tmp_path / "out")
    told = "actuator 'T3' pushes 'hull' and is no thruster"
    assert [line.text.startswith(told) for line in run.log if line.level == "WARNING"].count(True) == 1
    code, _, stderr = call(monkeypatch, capsys, "validate", HELIX, "--set", f"model={tmp_path / 'cube.xml'}")
    assert code == 0
    assert f"NOTE {HELIX}: {told}" in stderr
