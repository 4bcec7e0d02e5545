"""`cube-sim analyze --set`: what a vehicle could do with other values than its file's."""

import json

import mujoco
import numpy as np
import pytest
from support.places import CUBE
from typer.testing import CliRunner

import cube_sim
from cube_sim.commands.cli import app
from cube_sim.errors import ModelError
from cube_sim.scenario.document import parse_value
from cube_sim.vehicle.mjcf.what_if import parameters_of, read_setting, set_sites


def matrix_with(*settings):
    spec = mujoco.MjSpec.from_file(str(CUBE))
    others = set_sites(spec, [read_setting(text, parse_value) for text in settings])
    model = cube_sim.load_model(spec, parameters_of(others, {"hull:mass": np.array([125.0])}))
    return cube_sim.Vehicle.from_model(model)


def test_all_thrusters_lower_by_the_lever_arms_of_their_forces():
    """Moved by d, a force f has the moment d x f more."""
    before, after = matrix_with(), matrix_with("site:T*.pos+=[0, 0, -0.05]")
    forces = before.actuation_matrix[:3]
    np.testing.assert_allclose(after.actuation_matrix[:3], forces, atol=1e-15)
    more = np.cross([0.0, 0.0, -0.05], forces.T).T
    np.testing.assert_allclose(after.actuation_matrix[3:], before.actuation_matrix[3:] + more, atol=1e-15)


def test_sites_are_placed_scaled_and_turned_one_by_one():
    A = matrix_with("site:T1.pos=[0.1,0.2,0.3]", "site:T1.zaxis=[0,0,2]", "site:T[12].pos*=2").actuation_matrix
    np.testing.assert_allclose(A[:, 0], [0, 0, 1, *np.cross([0.2, 0.4, 0.6], [0, 0, 1])], atol=1e-15)
    np.testing.assert_array_equal(A[:, 2:], matrix_with().actuation_matrix[:, 2:])


def test_parameters_are_set_and_scaled():
    assert matrix_with("hull:mass*=1.2").mass == pytest.approx(150.0)
    assert matrix_with("hull:mass=130", "hull:mass+=5").mass == pytest.approx(135.0)


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("site:T9.pos=[0,0,0]", "no site 'T9'; the model has 9, the nearest T"),
        ("site:T1.size=[1]", "a site has pos and zaxis"),
        ("site:T1.pos+=[0,1]", "has 2 numbers for 3"),
        ("site:T1.pos=[0,1]", "a place has 3"),
        ("site:T1.zaxis=[0,0,0]", "not all 0"),
        ("hull:mass", "write KEY=VALUE"),
        ("hull:mass=heavy", "is no number"),
        ("hull:mass=.nan", "finite"),
        ("hull:mas=3", "did you mean"),
    ],
)
def test_what_cannot_be_is_one_line(setting, said):
    with pytest.raises(ModelError) as error:
        matrix_with(setting)
    assert said in str(error.value)


def test_both_are_printed_beside_each_other():
    told = CliRunner().invoke(app, ["analyze", str(CUBE), "--set", "site:T*.pos+=[0,0,-0.05]"])
    assert told.exit_code == 0
    assert "as it is" in told.stdout
    assert "torques divided by, m" in told.stdout
    asked = ["analyze", str(CUBE), "--set", "site:T*.pos+=[0,0,-0.05]", "--json"]
    both = json.loads(CliRunner().invoke(app, asked).stdout)
    assert both["set"] == ["site:T*.pos+=[0,0,-0.05]"]
    assert both["as_it_is"]["actuation_matrix"] != both["actuation_matrix"]
    refused = CliRunner().invoke(app, ["analyze", str(CUBE), "--set", "site:X*.pos+=1"])
    assert refused.exit_code == 2
    assert "no site 'X*'" in refused.stderr


def test_an_error_names_the_file_that_was_given_and_remarks_are_beside_each_other(tmp_path):
    file = tmp_path / "mine.xml"
    file.write_text(CUBE.read_text().replace('<mujoco model="cube">', '<mujoco model="another">'))
    refused = CliRunner().invoke(app, ["analyze", str(file), "--set", "hull:mass=-1"])
    assert refused.exit_code == 2
    assert f"{file}: hull:mass: " in refused.stderr.replace("\n", "")
    assert "another" not in refused.stderr
    told = CliRunner().invoke(app, ["analyze", str(file), "--set", "hull:mass*=1.04"]).stdout
    assert "as it is: weighs 1226 N, displaces 1226 N of water: neutral" in told
    assert "then: weighs 1275 N, displaces 1226 N of water: sinks with 49" in told
