"""Hulls to draw and the pictures themselves: geometry counted, files repeatable, colours where they must be."""

from itertools import product

import numpy as np
import pytest
from PIL import Image
from support.layouts import jack

from cube_sim.actuation import survivability
from cube_sim.actuation.plots.convex_shape import convex_shape
from cube_sim.actuation.plots.picture import save_picture
from cube_sim.errors import ActuationError

JACK = jack()
LIMITS = [-40, -2, 2, 40]


def test_a_box_has_twelve_edges_and_its_flat_images_fewer():
    box = np.array(list(product([-1.0, 1.0], repeat=3)))
    inside = np.vstack([box, np.zeros(3), [0.5, 0.2, 0.1]])
    solid = convex_shape(inside)
    assert solid.dimension == 3
    assert len(solid.edges) == 12
    assert {round(float(np.linalg.norm(b - a)), 9) for a, b in solid.edges} == {2.0}
    rng = np.random.default_rng(0)
    plane = convex_shape(inside @ rng.normal(size=(3, 2)) @ rng.normal(size=(2, 3)))
    assert plane.dimension == 2
    assert len(plane.faces) == 1
    assert len(plane.edges) == len(plane.faces[0]) == 6
    line = convex_shape(inside[:, :1] * [[1.0, 2.0, 3.0]])
    assert line.dimension == 1
    assert np.allclose(np.sort(line.edges[0][:, 0]), [-1, 1])
    assert convex_shape(np.zeros((4, 3))).dimension == 0


def colour_share(image, colour):
    """Share of pixels near an RGB colour."""
    return float(np.mean(np.max(np.abs(np.asarray(image, dtype=float) - colour), axis=2) < 12))


@pytest.mark.flight
@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_the_same_numbers_give_the_same_file(tmp_path, suffix):
    table = survivability(JACK, LIMITS, most=2)
    files = [tmp_path / f"{i}{suffix}" for i in range(2)]
    for file in files:
        save_picture(file, JACK, LIMITS, table, title="Jack")
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.flight
def test_picture_shows_intact_and_damaged_sets_and_marks_what_cannot_follow(tmp_path):
    file = tmp_path / "jack.png"
    names = ["T1", "T2", "T3", "T4"]
    save_picture(file, JACK, LIMITS, survivability(JACK, LIMITS, most=3, lost=["T2"]), names=names)
    image = Image.open(file).convert("RGB")
    assert colour_share(image, [0x4A, 0x6F, 0xA5]) > 0.001
    assert colour_share(image, [0xD9, 0x82, 0x2B]) > 0.001
    assert colour_share(image, [0xC0, 0x39, 0x2B]) > 2e-5
    save_picture(file, JACK, LIMITS, survivability(JACK, LIMITS, most=1))
    assert colour_share(Image.open(file).convert("RGB"), [0xC0, 0x39, 0x2B]) == 0


@pytest.mark.flight
def test_a_lost_torque_is_still_a_point_in_the_picture(tmp_path):
    # T1 and T3 lost: no torque comes without force, and the set of torques is the origin alone.
    file, table = tmp_path / "jack.png", survivability(JACK, LIMITS, most=0, lost=["T1", "T3"])
    save_picture(file, JACK, LIMITS, table, names=["T1", "T2", "T3", "T4"])
    image = Image.open(file).convert("RGB")
    width, height = image.size
    torques = image.crop((int(0.38 * width), int(0.3 * height), int(0.64 * width), int(0.7 * height)))
    assert colour_share(torques, [0xD9, 0x82, 0x2B]) > 1e-4


def test_unwritable_pictures_are_refused(tmp_path):
    table = survivability(JACK, LIMITS, most=1)
    with pytest.raises(ActuationError, match=r"one of \.png"):
        save_picture(tmp_path / "a.bmp", JACK, LIMITS, table)
    with pytest.raises(ActuationError, match="there is no folder"):
        save_picture(tmp_path / "none" / "a.png", JACK, LIMITS, table)
    with pytest.raises(ActuationError, match="3 names for 4 thrusters"):
        save_picture(tmp_path / "a.png", JACK, LIMITS, survivability(JACK, LIMITS, most=1, lost=["T2"]))
