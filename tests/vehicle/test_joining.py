"""Several MJCF files in one model: what comes along under its prefix, what is there once, what does not go together."""

import warnings

import mujoco
import numpy as np
import pytest
from support.places import MODELS

from cube_sim.errors import ModelError
from cube_sim.vehicle.changing import set_parameters
from cube_sim.vehicle.joining import ModelPart, compiled_together, vehicle_in
from cube_sim.vehicle.loading import load_model
from cube_sim.vehicle.plugin import layout, packing
from cube_sim.vehicle.vehicle import Vehicle, hull_names

CUBE = (MODELS / "cube.xml").read_text()
ROCK = CUBE.replace("<worldbody>", '<worldbody><geom name="rock" type="box" size="1 1 1" pos="20 0 -8"/>')


def write(folder, name, text):
    path = folder / name
    path.write_text(text)
    return str(path)


def test_each_brings_its_water_thrusters_and_parameters_and_the_world_is_there_once(tmp_path):
    file = write(tmp_path, "rock.xml", ROCK)
    parts = ModelPart(file, "a/"), ModelPart(file, "b/", {"hull:volume": [0.126]}, again=True)
    model = compiled_together(parts).model
    assert hull_names(model) == ("a/hull", "b/hull")
    assert [model.geom(i).name for i in range(model.ngeom)] == ["a/rock", "a/hull", "b/hull"]
    alone = Vehicle.from_model(load_model(file))
    for prefix, volume in (("a/", 0.125), ("b/", 0.126)):
        there = Vehicle.from_model(model, f"{prefix}hull")
        assert there.displaced_mass == pytest.approx(1000.0 * volume)
        assert there.thrusters.names == tuple(f"{prefix}T{i}" for i in range(1, 9))
        assert np.array_equal(there.added_mass, alone.added_mass)
        assert np.allclose(there.actuation_matrix, alone.actuation_matrix, atol=1e-15)
        short = vehicle_in(model, alone, prefix)
        assert short.thrusters.names == alone.thrusters.names
        assert short.thrusters.in_model == there.thrusters.names
        assert short.dof_address == there.dof_address


def test_each_floats_as_it_does_alone_to_the_bit(tmp_path):
    file = write(tmp_path, "cube.xml", CUBE)
    alone, both = load_model(file), compiled_together((ModelPart(file, "a/"), ModelPart(file, "b/", again=True))).model
    one, two = mujoco.MjData(alone), mujoco.MjData(both)
    two.qpos[7:10] = 10.0, 0.0, 0.0
    for data in (one, two):
        data.qvel[:6] = 0.3, -0.2, 0.1, 0.2, 0.5, -0.4
        data.ctrl[:8] = 0.4
    mujoco.mj_step(alone, one, nstep=300)
    mujoco.mj_step(both, two, nstep=300)
    assert np.array_equal(one.qpos[:7], two.qpos[:7])
    assert np.array_equal(one.qvel[:6], two.qvel[:6])


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('gravity="0 0 -9.81"', 'gravity="0 0 -3.7"', "gravity is 0 0 -3.7, that of the vehicles before it 0 0 -9.81"),
        ('name="water:density" data="1000"', 'name="water:density" data="1025"', "there is only one water"),
    ],
)
def test_other_worlds_do_not_go_together(tmp_path, before, after, said):
    assert before in CUBE
    files = write(tmp_path, "cube.xml", CUBE), write(tmp_path, "other.xml", CUBE.replace(before, after))
    with pytest.raises(ModelError, match=said):
        compiled_together((ModelPart(files[0], "a/"), ModelPart(files[1], "b/")))


NPS = str(MODELS / "nps_auv2.xml")


@pytest.mark.parametrize("other", ["cube", "nps_auv2", "infante"])
@pytest.mark.parametrize("comes", ["first", "second"])
def test_a_force_counts_the_actuators_of_its_own_file(other, comes):
    """The race of NPS AUV II reads its propeller and its stern planes by their numbers in its file."""
    files = (NPS, str(MODELS / f"{other}.xml"))
    parts = [ModelPart(file, prefix) for file, prefix in zip(files, ("a/", "b/"), strict=True)]
    alone, both = load_model(NPS), compiled_together(parts if comes == "first" else parts[::-1]).model
    both.opt.timestep, both.opt.integrator = alone.opt.timestep, alone.opt.integrator
    one, two = mujoco.MjData(alone), mujoco.MjData(both)
    there = Vehicle.from_model(both, "a/hull")
    far = Vehicle.from_model(both, "b/hull").qpos_address
    two.qpos[far : far + 3] = 40.0, 0.0, 0.0
    own = [i for i in range(both.nu) if both.actuator(i).name.startswith("a/")]
    qpos, dof = slice(there.qpos_address, there.qpos_address + 7), slice(there.dof_address, there.dof_address + 6)
    one.qpos[:7] = two.qpos[qpos] = 0.0, 0.0, -20.0, 1.0, 0.0, 0.0, 0.0
    one.qvel[:6] = two.qvel[dof] = 1.5, -0.1, 0.2, 0.03, 0.02, -0.04
    one.ctrl[:] = two.ctrl[own] = 0.6, 0.1, -0.2, 0.15
    two.ctrl[[i for i in range(both.nu) if i not in own]] = 0.25  # its own commands are none of the race's
    mujoco.mj_step(alone, one, nstep=300)
    mujoco.mj_step(both, two, nstep=300)
    assert np.array_equal(one.qpos, two.qpos[qpos])
    assert np.array_equal(one.qvel, two.qvel[dof])
    race = alone.numeric(alone.nnumeric - 1).data.copy()
    alone.numeric(alone.nnumeric - 1).data[layout.HEADER_SIZE + layout.FORCE] = -1.0
    without = mujoco.MjData(alone)
    without.qvel[:6], without.ctrl[:] = (1.5, -0.1, 0.2, 0.03, 0.02, -0.04), (0.6, 0.1, -0.2, 0.15)
    mujoco.mj_step(alone, without, nstep=300)
    alone.numeric(alone.nnumeric - 1).data[:] = race
    assert np.abs(without.qvel[:6] - one.qvel[:6]).max() > 1e-3  # the race does something in this flight


def keeps(time, position, rotation, velocity, through_water, command, activation, state=(0.0, 0.0)):
    """Of the lengths of what it sees, and of its state."""
    pull = 10.0 * len(command) + len(activation) + activation[-1]
    return (pull, command[0], state[0], 0.0, 0.0, 0.0), (command[1] - state[0], activation[1] - state[1])


def test_two_forces_that_keep_states_see_each_their_own_and_no_states(tmp_path):
    """Files of 8 actuators; the states that both keep come behind all of them."""
    text = f'<text name="hull:force" data="{__name__}:keeps"/></custom>'
    file = write(tmp_path, "keeps.xml", CUBE.replace("</custom>", text))
    alone, both = load_model(file), compiled_together((ModelPart(file, "a/"), ModelPart(file, "b/", again=True))).model
    one, two = mujoco.MjData(alone), mujoco.MjData(both)
    two.qpos[7:10] = 10.0, 0.0, 0.0
    one.ctrl[:8] = two.ctrl[8:16] = 0.1, -0.3, 0.2, 0.4, 0.0, -0.1, 0.3, 0.2
    two.ctrl[:8] = -0.5
    for model, data in ((alone, one), (both, two)):
        mujoco.mj_step(model, data, nstep=200)
    assert np.abs(one.qpos[:3] - two.qpos[7:10] + [10.0, 0.0, 0.0]).max() < 1e-12
    assert np.abs(one.qvel[:6] - two.qvel[6:12]).max() < 1e-12
    assert np.array_equal(one.act[8:], two.act[-2:])
    assert np.abs(one.act[8:]).min() > 0.01
    parameters = {"b/hull:volume": [0.126]}
    set_parameters(both, parameters)
    assert packing.force_records(packing.packed_parameters(both))[1][5:] == (8, 8, 8, 8)


def test_files_of_other_steps_are_joined_without_a_word_of_mujoco(tmp_path, capfd):
    other = CUBE.replace('timestep="0.01"', 'timestep="0.005"')
    assert other != CUBE
    parts = ModelPart(write(tmp_path, "a.xml", CUBE), "a/"), ModelPart(write(tmp_path, "b.xml", other), "b/")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        compiled_together(parts)
    assert "conflict" not in "".join(capfd.readouterr())
