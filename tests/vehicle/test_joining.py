"""Several MJCF files in one model: what comes along under its prefix, what is there once, what does not go together."""

import warnings

import mujoco
import numpy as np
import pytest
from support.places import MODELS

from cube_sim.errors import ModelError
from cube_sim.vehicle.joining import ModelPart, joined_model, vehicle_in
from cube_sim.vehicle.loading import load_model
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
    model = joined_model(parts)
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
    alone, both = load_model(file), joined_model((ModelPart(file, "a/"), ModelPart(file, "b/", again=True)))
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
        joined_model((ModelPart(files[0], "a/"), ModelPart(files[1], "b/")))


def test_a_force_that_counts_actuators_has_its_vehicle_come_first():
    """The race of NPS AUV II reads its propeller and its stern planes by their numbers in its file."""
    nps, cube = (str(MODELS / f"{name}.xml") for name in ("nps_auv2", "cube"))
    model = joined_model((ModelPart(nps, "a/"), ModelPart(cube, "b/")))
    assert [model.actuator(i).name for i in (0, 2)] == ["a/propeller", "a/stern_planes"]
    said = "b/hull:force: reads commands and activations by their number, .*: put its vehicle first"
    with pytest.raises(ModelError, match=said):
        joined_model((ModelPart(cube, "a/"), ModelPart(nps, "b/")))
    joined_model((ModelPart(cube, "a/"), ModelPart(str(MODELS / "infante.xml"), "b/")))  # reads none


def test_files_of_other_steps_are_joined_without_a_word_of_mujoco(tmp_path, capfd):
    other = CUBE.replace('timestep="0.01"', 'timestep="0.005"')
    assert other != CUBE
    parts = ModelPart(write(tmp_path, "a.xml", CUBE), "a/"), ModelPart(write(tmp_path, "b.xml", other), "b/")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        joined_model(parts)
    assert "conflict" not in "".join(capfd.readouterr())
