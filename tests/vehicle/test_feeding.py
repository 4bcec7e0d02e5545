"""Numbers of the water that feed energy into a motion along three and more axes are found, and told in one line."""

import mujoco
import numpy as np
import pytest
from support.places import CUBE, MODEL_FILES, MODELS

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.feeding import feeding_words
from cube_sim.vehicle.remarks import cautions
from cube_sim.vehicle.vehicle import hull_names

DIAGONAL = np.array([30.0, 80.0, 90.0, 1.0, 3.0, 4.0])


def coupled(share, axes):
    """Every two of some axes coupled by a share of what their diagonals bear: pairs of it take energy out up to 1."""
    matrix = np.diag(DIAGONAL)
    for i in axes:
        for j in axes:
            if i != j:
                matrix[i, j] = -share * DIAGONAL[i] ** (1 / 3) * DIAGONAL[j] ** (2 / 3)
    return matrix


def read(parameters):
    model = cube_sim.load_model(CUBE, parameters)
    return model, cube_sim.Vehicle.from_model(model)


@pytest.mark.parametrize("axes", [(0, 1, 2), (0, 2, 4), (1, 3, 5), (0, 1, 2, 3)])
@pytest.mark.parametrize("times", [0.9, 1.1])
def test_three_axes_together_are_told_from_the_bound_on(axes, times):
    """With n axes at speeds that damp alike the power is n - n (n - 1) c: c beyond 1 / (n - 1) feeds; pairs allow 1."""
    bound = 1.0 / (len(axes) - 1)
    matrix = coupled(times * bound, axes)
    model, vehicle = read({"hull:quadratic_damping": matrix.ravel()})
    words = feeding_words(vehicle.linear_damping, vehicle.quadratic_damping, None)
    assert bool(words) == (times > 1.0)
    assert [text for text in cautions(model, vehicle) if "feeds energy" in text] == ([words] if words else [])
    if words:
        assert "\n" not in words
        velocity = np.array([float(each) for each in words.partition("velocity ")[2].split(" m/s")[0].split()])
        assert -velocity @ matrix @ (np.abs(velocity) * velocity) > 0.0


def test_the_water_told_of_does_speed_a_hull_up():
    """Let go in still water at that motion, its energy grows, or it is fed at least more than drag takes at first."""
    matrix = coupled(0.9, (0, 1, 2))
    model, vehicle = read({"hull:quadratic_damping": matrix.ravel(), "hull:linear_damping": np.zeros(6)})
    speeds = DIAGONAL[:3] ** (-1 / 3)
    data = mujoco.MjData(model)
    data.qvel[:3] = speeds / np.linalg.norm(speeds)
    before = 0.5 * data.qvel @ (vehicle.mass_matrix + vehicle.added_mass) @ data.qvel
    mujoco.mj_step(model, data, nstep=50)
    after = 0.5 * data.qvel @ (vehicle.mass_matrix + vehicle.added_mass) @ data.qvel
    assert after > 1.001 * before


@pytest.mark.parametrize("seed", range(5))
def test_what_takes_energy_whatever_the_motion_is_not_told(seed):
    """By Young's inequality each entry takes no more than 1/3 and 2/3 of itself of two diagonals."""
    rng = np.random.default_rng(seed)
    matrix = rng.uniform(-1.0, 1.0, (6, 6))
    for i in range(6):
        others = sum(abs(matrix[i, j]) / 3.0 + 2.0 * abs(matrix[j, i]) / 3.0 for j in range(6) if j != i)
        matrix[i, i] = others + 0.01
    assert feeding_words(np.zeros((6, 6)), matrix, None) == ""


def test_a_pair_is_refused_as_ever():
    with pytest.raises(ModelError, match="feeds energy into motion x and y together"):
        read({"hull:quadratic_damping": coupled(1.1, (0, 1)).ravel()})


def test_a_lift_of_the_wrong_sign_is_told():
    """REMUS 100's side force of sway, Y_uv = -28.6 kg/m, with another sign and unit: flow across throws it on."""
    model = cube_sim.load_model(MODELS / "remus100.xml")
    rows = model.numeric("hull:velocity_products").data.reshape(-1, 4).copy()
    side = (rows[:, :3] == [2, 1, 2]).all(axis=1)
    assert side.sum() == 1
    rows[side, 3] = 900.0
    other = cube_sim.load_model(MODELS / "remus100.xml", {"hull:velocity_products": rows.ravel()})
    words = [each for each in cautions(other, cube_sim.Vehicle.from_model(other)) if "feed energy" in each]
    assert len(words) == 1
    assert words[0].startswith("its velocity_products and damping feed energy into some motions")


@pytest.mark.parametrize("path", MODEL_FILES, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("ignore")
def test_no_shipped_vehicle_is_told_of(path):
    model = cube_sim.load_model(path)
    for name in hull_names(model):
        vehicle = cube_sim.Vehicle.from_model(model, name)
        assert feeding_words(vehicle.linear_damping, vehicle.quadratic_damping, vehicle.lift) == ""
