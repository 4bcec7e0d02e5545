"""A hull out of the water is said: when it comes out, once each time, and how high and how long in the end."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.flights import FORCES_ONLY
from support.places import CUBE, HELIX

import cube_sim
from cube_sim.mission.surface_watch import SurfaceWatch, path_above_surface
from cube_sim.spatial import quaternion_from_euler

TICK_S = 0.02
SURFACE = {"water:surface": [0.0]}


class Said:
    """A log that keeps what it is told."""

    def __init__(self):
        self.lines = []

    def log(self, t, level, text):
        self.lines.append((round(t, 6), level, text))

    @property
    def warnings(self):
        return [(t, text) for t, level, text in self.lines if level == "WARNING"]


class Flight:
    """A hull put by hand at one height after the other."""

    def __init__(self, model):
        self.model, self.data, self.said = model, mujoco.MjData(model), Said()
        self.watch = SurfaceWatch(self.said, model, cube_sim.Vehicle.from_model(model))
        self.ticks = 0

    def stay(self, z, seconds=TICK_S, attitude_deg=(0.0, 0.0, 0.0)):
        self.data.qpos[:7] = [0.0, 0.0, z, *quaternion_from_euler(*np.radians(attitude_deg))]
        mujoco.mj_forward(self.model, self.data)
        for _ in range(round(seconds / TICK_S)):
            self.watch.note(self.ticks * TICK_S, self.data)
            self.ticks += 1

    @property
    def top(self):
        """Height of the highest point of its geoms over the origin, as MuJoCo's rays see it from above [m]."""
        grid = [(x, y) for x in np.linspace(-1, 1, 201) for y in np.linspace(-1, 1, 201)]
        geom = np.zeros(1, np.int32)
        origin = self.data.qpos[:3]
        hits = [
            mujoco.mj_ray(self.model, self.data, origin + np.array([x, y, 10.0]), [0.0, 0.0, -1.0], None, 1, -1, geom)
            for x, y in grid
        ]
        return max(10.0 - hit for hit in hits if hit >= 0.0)


@pytest.fixture
def flight():
    return Flight(cube_sim.load_model(CUBE, SURFACE))


def test_endless_water_is_never_left():
    flight = Flight(cube_sim.load_model(CUBE))
    flight.stay(33.0, 2.0)
    flight.watch.finish(2.0)
    assert flight.said.lines == []


def test_a_hull_under_water_is_passed_over(flight):
    flight.stay(-5.0, 10.0)
    flight.watch.finish(10.0)
    assert flight.said.lines == []


@pytest.mark.parametrize("attitude_deg", [(0, 0, 0), (0, 45, 0), (30, -20, 70)])
def test_its_top_counts_in_the_attitude_that_it_has(flight, attitude_deg):
    flight.stay(-5.0, attitude_deg=attitude_deg)
    top = flight.top
    # Boxes around geoms reach above them when tilted, by less than their size.
    flight.stay(-1.5 * top - 0.01, attitude_deg=attitude_deg)
    assert flight.said.warnings == []
    flight.stay(-top + 0.02, attitude_deg=attitude_deg)
    assert len(flight.said.warnings) == 1


def test_a_hull_that_stays_out_is_said_once_and_summed_up(flight):
    flight.stay(-5.0, 1.0)
    flight.stay(3.0, 2.0)
    flight.stay(33.0, 2.0)
    flight.watch.finish(5.0)
    (out_at, out), (end_at, end) = flight.said.warnings
    assert (out_at, end_at) == (1.0, 5.0)
    assert "comes out of the water" in out
    assert "its origin at 3.00 m" in out
    assert "the surface at 0.00 m" in out
    assert "once, for 3.98 s in all" in end
    assert "its top at z = 33." in end


def test_each_emergence_is_said_and_a_bobbing_hull_emerges_once(flight):
    flight.stay(-5.0, 1.0)
    for _ in range(20):
        flight.stay(1.0, 0.1)
        flight.stay(-5.0, 0.5)
    flight.stay(-5.0, 2.0)
    flight.stay(1.0, 0.1)
    flight.watch.finish(15.1)
    assert [t for t, text in flight.said.warnings if "comes out" in text] == [1.0, 15.0]
    assert [text for _, level, text in flight.said.lines if level == "INFO"] == ["the hull is under water again"]
    assert "came out of the water 2 times" in flight.said.warnings[-1][1]


def test_a_mast_belongs_to_the_hull_and_the_scenery_does_not():
    spec = mujoco.MjSpec.from_file(str(CUBE))
    mast, quay = [0, 0, 0, 0, 0, 3], mujoco.mjtGeom.mjGEOM_BOX
    spec.body("hull").add_geom(type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=mast, size=[0.02, 0, 0], mass=0)
    spec.worldbody.add_geom(type=quay, size=[1, 1, 1], pos=[50, 0, 2])
    mast = Flight(cube_sim.load_model(spec, SURFACE))
    mast.stay(-3.2)
    assert mast.said.warnings == []
    mast.stay(-2.9)
    assert len(mast.said.warnings) == 1


def test_a_path_is_judged_by_its_highest_point():
    points = np.array([[0.0, 0.0, -5.0], [1.0, 0.0, 0.4], [2.0, 0.0, -1.0]])
    assert path_above_surface(points - [0.0, 0.0, 0.4], 0.0, 0.0) is None
    assert path_above_surface(points, 0.4, 0.0) is None
    assert "rises to z = 0.40 m, the surface is at 0.00 m" in path_above_surface(points, 0.0, 0.0)
    assert "rises to z = 0.40 m" in path_above_surface(points, 0.0, 0.25)
    near = path_above_surface(points, 0.6, 0.25)
    assert near.startswith("the path comes within 0.20 m of the surface, and the hull's top is 0.25 m above its origin")
    assert path_above_surface(points, 0.65, 0.25) is None


@pytest.mark.flight
def test_a_path_through_the_air_is_flown_with_warnings(tmp_path):
    above = {"path.centre_m": [0, 0, 5], "initial.position_m": [7, -3, 5], "duration_s": 1.0, "checks": FORCES_ONLY}
    run = cube_sim.run(HELIX, above, tmp_path / "out")
    assert run.verdict == "PASS"
    assert [(line.t, line.level, line.text.split(",")[0]) for line in run.log] == [
        (0.0, "WARNING", "the path comes out of the water"),
        (0.0, "WARNING", "the hull comes out of the water: its top is at z = 5.25 m"),
        (1.0, "WARNING", "the demanded wrench was out of reach"),
        (1.0, "WARNING", "the hull came out of the water once"),
    ]


@pytest.mark.flight
def test_endless_water_carries_a_path_through_the_air(tmp_path):
    above = {"path.centre_m": [0, 0, 5], "initial.position_m": [3, 0, 5], "duration_s": 1.0, "checks": FORCES_ONLY}
    run = cube_sim.run(HELIX, {**above, "surface_m": None}, tmp_path / "out")
    assert [line.text for line in run.log if line.level == "WARNING"] == []
    assert run.signals["pose.position"][-1, 3] > 4.9
