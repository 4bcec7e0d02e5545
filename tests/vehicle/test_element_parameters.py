"""Mass, inertia and lags given as parameters are those of an MJCF that says them itself."""

import mujoco
import numpy as np
import pytest
from support.ballasted import MODEL as BALLASTED
from support.places import MODELS

from cube_sim.errors import ModelError
from cube_sim.vehicle.changing import set_parameters
from cube_sim.vehicle.loading import load_model
from cube_sim.vehicle.mjcf.elements import element_values

CUBE = (MODELS / "cube.xml").read_text()
INERTIAL = 'mass="125" diaginertia="5.2083333333333333 5.2083333333333333 5.2083333333333333"'
PLACE = 'pos="0 0 0" ' + INERTIAL


def edited(*changes):
    """The CUBE's MJCF with other words in it."""
    text = CUBE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return load_model(mujoco.MjSpec.from_string(text))


def flown(model):
    """Where it is after two seconds under two thrusters and its weight."""
    data = mujoco.MjData(model)
    data.ctrl[:2] = 0.4
    while data.time < 2.0:
        mujoco.mj_step(model, data)
    return np.concatenate([data.qpos, data.qvel, data.act])


@pytest.mark.parametrize(
    ("name", "values", "change"),
    [
        ("hull:mass", [140.0], ('mass="125"', 'mass="140"')),
        ("hull:centre_of_mass", [0.01, 0.0, -0.02], (PLACE, 'pos="0.01 0 -0.02" ' + INERTIAL)),
        ("hull:inertia", [4.0, 5.0, 6.0], (INERTIAL, 'mass="125" diaginertia="4 5 6"')),
        ("hull:inertia", [4.0, 5.0, 6.0, 0.1, 0.2, 0.3], (INERTIAL, 'mass="125" fullinertia="4 5 6 0.1 0.2 0.3"')),
        ("hull:thruster_lag", [0.3], ('dynprm="0.02"', 'dynprm="0.3"')),
    ],
)
def test_it_flies_as_if_the_file_said_so(name, values, change):
    given = load_model(MODELS / "cube.xml", {name: values})
    assert flown(given).tobytes() == flown(edited(change)).tobytes()
    assert flown(given).tobytes() != flown(load_model(MODELS / "cube.xml")).tobytes()
    turned_back = element_values(given, name)
    assert turned_back == pytest.approx(values if len(values) > 1 else values[0], rel=1e-12)


def test_one_thruster_has_a_lag_of_its_own():
    lags = load_model(MODELS / "cube.xml", {"T3:thruster_lag": [0.5], "hull:thruster_lag": [0.1]}).actuator_dynprm[:, 0]
    assert lags.tolist() == [0.1, 0.1, 0.5, *[0.1] * 5]


def test_an_inertia_given_to_an_inertia_about_its_own_axes_is_about_the_bodys():
    turned = edited((INERTIAL, 'mass="125" fullinertia="4 5 6 0.1 0.2 0.3"'))
    again = load_model(MODELS / "cube.xml", {"hull:inertia": element_values(turned, "hull:inertia")})
    assert flown(again) == pytest.approx(flown(turned), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "values", "why"),
    [
        ("hull:mass", [-1.0], "is -1; a mass"),
        ("hull:mass", [1.0, 2.0], "1 finite numbers are right"),
        ("hull:mass", [np.nan], "finite"),
        ("hul:mass", [100.0], "no body 'hul'; the model has hull"),
        ("T1:mass", [100.0], "no body 'T1'"),
        ("hull:inertia", [5.0, 5.0, 11.0], "principal moments 5 5 11"),
        ("hull:inertia", [5.0, 5.0, -1.0], "principal moments"),
        ("hull:inertia", [5.0, 5.0], "3 or 6 finite"),
        ("T9:thruster_lag", [0.1], "'T9' is no thruster"),
        ("T1:thruster_lag", [0.0], "is 0; a time constant"),
        ("hull:thruster_lags", [0.1], r"did you mean thruster_lag\?"),
    ],
)
def test_what_makes_no_sense_is_refused(name, values, why):
    with pytest.raises(ModelError, match=why):
        load_model(MODELS / "cube.xml", {name: values})


def test_what_geoms_say_is_refused():
    """MuJoCo would go on with the geoms' mass."""
    text = CUBE.replace(f"<inertial {PLACE}/>", "")
    assert text != CUBE
    with pytest.raises(ModelError, match="follows from the geoms"):
        load_model(mujoco.MjSpec.from_string(text), {"hull:mass": [100.0]})


def test_what_a_hull_carries_has_a_mass_as_well_at_load_and_later():
    spec = mujoco.MjSpec.from_string(BALLASTED)
    given, later = load_model(spec, {"battery:mass": [6.0]}), load_model(spec)
    assert flown(given).tobytes() != flown(later).tobytes()
    set_parameters(later, {"battery:mass": [6.0]})
    assert given.body("battery").mass == 6.0
    assert flown(given).tobytes() == flown(later).tobytes()
