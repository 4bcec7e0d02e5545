"""Every mistake in the water of a link is refused when the model is loaded, by the name of the element at fault."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

import cube_sim
from cube_sim.commands.analysis_report import report_on
from cube_sim.errors import ModelError

TEXT = """<mujoco><compiler fusestatic="false"/><custom>
  <numeric name="water:density" data="1000"/><numeric name="hull:volume" data="0.01"/>
  <numeric name="fore:volume" data="0.001"/><numeric name="fore:added_mass" data="0 1 1 0 0.01 0.01"/></custom>
  <worldbody><body name="hull"><freejoint/><geom size="0.1" mass="10"/>
    <body name="fore" pos="0.2 0 0"><joint name="elbow" axis="0 1 0"/><geom size="0.03" mass="1"/>
      <body name="hand" pos="0.2 0 0"><geom size="0.02" mass="0.1"/></body></body></body>
    <body name="post"><geom size="0.1"/></body></worldbody></mujoco>"""
LINK = "a link takes volume, centre_of_buoyancy, added_mass, linear_damping, quadratic_damping, surface_half_axes"

MISTAKES = [
    ("fore:added_mass", np.eye(6) + np.eye(6, k=1), "not symmetric: entry (1,2) is 1, (2,1) is 0"),
    ("fore:added_mass", [1.0, 1.0, 1.0, 1.0, 1.0, -0.1], "not positive semidefinite"),
    ("fore:added_mass", [1.0, 2.0], "has 2 values; it takes 6"),
    ("fore:volume", [-0.1], "is -0.1"),
    ("fore:volume", [np.nan], "not finite"),
    ("fore:centre_of_buoyancy", [0.0], "has 1 value; it takes 3"),
    ("fore:linear_damping", [-1.0, 1.0, 1.0, 1.0, 1.0, 1.0], "negative diagonal"),
    ("fore:quadratic_damping", np.eye(6) - 1.9 * np.eye(6, k=3), "feeds energy into motion"),
    ("fore:surface_half_axes", [0.1, 0.1, 0.0], "half-axes [m] are positive"),
    ("fore:velocity_products", [2.0, 1.0, 2.0, -3.0], f"is for a hull, and 'fore' is a link of 'hull'; {LINK}"),
    ("fore:cross_flow_drag", [1.0, 1.0], f"is for a hull, and 'fore' is a link of 'hull'; {LINK}"),
    ("fore:thruster_dead_zone", [-1.0, 1.0], f"is for a hull or a thruster, and 'fore' is a link of 'hull'; {LINK}"),
    ("fore:aded_mass", [1.0] * 6, "did you mean added_mass?"),
    ("for:added_mass", [1.0] * 6, "no body 'for'; the model has hull, fore, hand, post"),
    ("elbow:added_mass", [1.0] * 6, "no body 'elbow'"),
    ("post:volume", [0.1], "only a free body of the world, and what it carries, is in the water"),
    ("hand:added_mass", [1.0] * 6, "is missing; 'hand' needs the volume it displaces"),
]


def loaded(text: str = TEXT, parameters=None) -> mujoco.MjModel:
    return cube_sim.load_model(mujoco.MjSpec.from_string(text), parameters)


@pytest.mark.parametrize(("name", "value", "reason"), MISTAKES, ids=[f"{n}-{r[:20]}" for n, _, r in MISTAKES])
def test_a_wrong_parameter(name, value, reason):
    loaded()
    with pytest.raises(ModelError) as caught:
        loaded(parameters={name: value})
    assert reason in str(caught.value)
    assert caught.value.element in (name, "post", "hand:volume")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('<numeric name="hull:volume" data="0.01"/>', "", "fore: has water parameters but no free joint, and 'hull'"),
        ('<body name="hull">', "<body>", "the free body that carries it has no name"),
        ("<freejoint/>", "", "only a free body of the world, and what it carries"),
        ("<freejoint/>", "<joint/>", "only a free body of the world, and what it carries"),
        ('"0 1 1 0 0.01 0.01"/>', '"0 1 1 0 0.01 0.01"/><numeric name="fore.volume" data="1"/>', "has no colon"),
    ],
)
def test_a_wrong_file(old, new, reason):
    assert old in TEXT
    text = TEXT.replace(old, new)
    if "freejoint" in old or "no name" in reason:
        text = text.replace('<numeric name="hull:volume" data="0.01"/>', "")
    with pytest.raises(ModelError, match=reason):
        loaded(text)


def test_a_link_that_mujoco_would_make_a_part_of_its_carrier():
    text = TEXT.replace('fusestatic="false"', 'fusestatic="true"')
    loaded(text)
    with pytest.raises(ModelError, match='hand: has water, and fusestatic="true"'):
        loaded(text, {"hand:volume": 1e-4})
    loaded(parameters={"hand:volume": 1e-4})


PUSHED = """<mujoco><compiler fusestatic="false"/><custom>
  <numeric name="water:density" data="1000"/><numeric name="hull:volume" data="0.01"/>
  <numeric name="hull:thruster_characteristic" data="-1 -9 0 0 1 9"/>
  <numeric name="hull:thruster_dead_zone" data="0 0"/></custom>
  <worldbody><body name="hull"><freejoint/><geom size="0.1" mass="10"/>
    <body name="arm" pos="0.2 0 0">{joint}<geom size="0.03" mass="1"/>
      <body name="hand" pos="0.2 0 0"><geom size="0.02" mass="0.1"/><site name="G" zaxis="1 0 0"/></body></body>
    </body></worldbody>
  <actuator><general name="G" site="G" dyntype="filter" dynprm="0.02" gainprm="0" biastype="user"
    gear="0 0 1 0 0 0"/></actuator>
</mujoco>"""


def test_a_thruster_that_a_joint_moves_is_flown_by_mujoco_alone(tmp_path):
    path = tmp_path / "a.xml"
    path.write_text(PUSHED.format(joint='<joint name="elbow" axis="0 1 0"/>'))
    model = cube_sim.load_model(path)
    data = mujoco.MjData(model)
    data.ctrl[0] = 1.0
    mujoco.mj_step(model, data, nstep=50)
    assert data.qvel[0] > 0.01
    with pytest.raises(ModelError) as caught:
        cube_sim.Vehicle.from_model(model)
    assert caught.value.element == "G"
    assert "is a thruster on 'hand', which joint 'elbow' moves against 'hull'; a site on 'hull'" in caught.value.reason
    with pytest.raises(ModelError) as caught:
        report_on(path)
    line, column = (int(each) for each in caught.value.place.removeprefix(f"{path}:").split(":"))
    assert path.read_text().splitlines()[line - 1][column - 1 :].startswith('<general name="G"')


def test_a_thruster_on_what_is_fixed_to_the_hull_is_one_of_it():
    model = loaded(PUSHED.format(joint=""))
    assert cube_sim.Vehicle.from_model(model).actuation_matrix[:, 0] == pytest.approx([1, 0, 0, 0, 0, 0])
