"""A point or a path above where the water carries the hull: it stays below, keeps all else, and comes back smoothly."""

import re

import numpy as np
import pytest
from support.both_loops import assert_same_flight, flown
from support.places import MODELS

import cube_sim
from cube_sim.commands.validating import validated
from cube_sim.flight.shortfall import Afloat
from cube_sim.mission import prepare
from cube_sim.mission.first_warnings import first_warnings
from cube_sim.scenario import load_mapping
from cube_sim.spatial import quaternion_from_euler
from cube_sim.vehicle.floating import Buoyancy

CHECKS = [{"kind": "allowed_forces"}]
THROUGH = [[0, 0, -1], [5, 0, 0.3], [9, 0, 0.3], [14, 0, -1.5], [22, 0, -1.5]]


def at(name, path, **given):
    model = str(MODELS / f"{name}.xml")
    said = {"schema_version": 1, "name": "held", "model": model, "seed": 1, "duration_s": 60, "path": path}
    there = {"initial": {"position_m": [0, 0, -1]}, "guidance": {"speed_m_s": 0.3}, "checks": CHECKS}
    return {**said, **there, **given}


def point(z):
    return {"type": "point", "position_m": [0.5, 0, z], "heading_deg": 0}


@pytest.mark.flight
@pytest.mark.parametrize(
    ("z", "extra"),
    [
        pytest.param(z, extra, marks=[] if bool(extra) == (z == 0.0) and z != 0.3 else pytest.mark.campaign)
        for z in (0.0, 0.3, 2.0)
        for extra in ({}, {"hull:volume": 1.01})
    ],
)
@pytest.mark.parametrize("name", ["cube", "cube_as_built", "bluerov2_heavy", "bluerov2_vectored", "rov6"])
def test_a_point_in_the_air_is_held_from_below_with_force_to_spare(name, z, extra):
    given = at(name, point(z), current_m_s=[0.1, 0.05, 0.0])
    vehicle = prepare(load_mapping(given)).vehicle
    given["parameters"] = {each: [factor * vehicle.displaced_mass / 1000.0] for each, factor in extra.items()}
    run = cube_sim.fly(given)
    place, forces = run.signals["pose.position"], run.signals["thrusters.force"]
    late = place[:, 0] > 35.0
    assert np.abs(place[late, 1] - 0.5).max() < 0.02
    assert np.abs(place[late, 2]).max() < 0.02
    assert np.ptp(place[late, 3]) < 0.03
    assert place[late, 3].max() < 0.0
    assert run.signals["path_error.attitude"][late, 1].max() < 0.1
    share = np.abs(forces[:, 1:]) / np.abs(vehicle.thrusters.limits[:, [0, 3]]).min(axis=1)
    assert share[forces[:, 0] > 35.0].max() < 0.95
    said = " ".join(line.text for line in run.log if line.t == 0.0)
    highest = float(re.search(r"it is asked no higher than z = (-?[\d.]+) m", said)[1])
    assert place[late, 3].mean() == pytest.approx(highest, abs=0.02)


@pytest.mark.flight
def test_on_a_weak_battery_it_is_held_lower_by_either_loop(monkeypatch):
    """At some ten volts in place of sixteen there is less than half of the lift, and less to spare."""
    battery = {"open_circuit_V": [10.0, 10.5], "resistance_ohm": 0.02, "capacity_Wh": 20.0}
    heights = []
    for extra in ({}, {"battery": battery}):
        one, _ = flown(at("cube", point(2.0), **extra), {}, True, monkeypatch)
        rows, signals = one.signals["pose.position"], one.signals
        late = rows[:, 0] > 40.0
        heights.append(rows[late, 3].mean())
        assert np.ptp(rows[late, 3]) < 0.03
        assert signals["path_error.attitude"][late, 1].max() < 0.1
        controller = one.mission.controller
        ratio = one.mission.supply.force_ratio
        assert heights[-1] == pytest.approx(controller.ceiling.highest(ratio * controller.most_up), abs=0.02)
    assert heights[1] < heights[0] - 0.02
    assert_same_flight(at("cube", point(2.0), battery=battery, duration_s=12), {}, monkeypatch)


@pytest.mark.flight
@pytest.mark.parametrize("name", ["cube", "bluerov2_heavy", "rov6"])
def test_a_path_through_the_air_is_left_below_and_taken_up_again(name):
    path = {"type": "polyline", "points_m": THROUGH, "corner_radius_m": 2.0}
    run = cube_sim.fly(at(name, path, duration_s=100.0))
    place = run.signals["pose.position"]
    target, velocity = run.signals["target.position"], run.signals["velocity.linear"]
    assert place[:, 3].max() < 0.0
    off = np.linalg.norm(place[:, 1:] - target[:, 1:], axis=1)
    assert off[target[:, 3] < -0.6][-500:].max() < 0.02
    assert np.abs(place[:, 2]).max() < 0.05
    assert np.abs(velocity[:, 1:]).max() < 0.6  # no leap on the way down: nothing has wound up
    assert run.verdict == "PASS"


@pytest.mark.parametrize("name", ["cube", "bluerov2_heavy", "remus100", "torpedo"])
def test_what_is_missing_is_said_before_it_flies(name):
    line = {"type": "line", "start_m": [0, 0, -0.02], "end_m": [200, 0, -0.02]}
    given = at(name, line, guidance={"speed_m_s": 1.2, "stop_at_end": False})
    mission = prepare(load_mapping(given))
    near = next(text for text in first_warnings(mission) if "of the surface" in text)
    carried = Buoyancy.of(mission.model, mission.vehicle)
    lacking = carried.weight - carried.carried(0.02, np.array([0.0, 0.0, 1.0]))
    told = r"at z = -0.02 m ([\d.e+]+) N of its weight are not carried, of which its thrusters lift ([\d.]+)"
    found = re.search(told, near)
    assert float(found[1]) == pytest.approx(lacking, rel=0.02)
    assert float(found[2]) <= float(found[1])
    assert re.search(r"(floats|is awash) with its origin 0\.\d\d m below it", near)
    deep = {**line, "start_m": [0, 0, -5], "end_m": [200, 0, -5]}
    assert not any("of the surface" in text for text in first_warnings(prepare(load_mapping({**given, "path": deep}))))


def test_validate_notes_it(tmp_path):
    file = tmp_path / "held.yaml"
    cube = MODELS / "cube.xml"
    file.write_text(
        f"schema_version: 1\nname: held\nmodel: {cube}\nseed: 1\nduration_s: 5\n"
        "path: {type: point, position_m: [0, 0, 0.1], heading_deg: 0}\n"
        "guidance: {speed_m_s: 0.3}\nchecks: [{kind: allowed_forces}]\n"
    )
    warned = []
    validated(file, None, warned)
    assert len([text for text in warned if "it is asked no higher than z = -0.2" in text]) == 1


def test_words_for_lift_that_is_missing():
    body = np.full((1, 3), 0.5), np.eye(3)[None], np.zeros((1, 3)), np.array([100.0])
    sphere = Afloat(Buoyancy(*body, 100.0), 1.0)
    level, over = (quaternion_from_euler(*angles) for angles in ([0.0, 0.0, 0.0], [2.0, 1.0, 0.3]))
    assert sphere.out_of_water(0.0, level) == ""
    half = "50 N of lift missing because the hull is 50 % out of the water"
    assert sphere.out_of_water(1.0, level) == half
    assert sphere.out_of_water(1.0, over) == half
    floating = Afloat(Buoyancy(*body, 40.0), 1.0)
    assert floating.out_of_water(1.0, level) == ""
    two = [np.concatenate([each, each]) for each in body]
    two[2][1] = 0.0, 0.0, -3.0  # a link that hangs below stays under water
    with_a_link = Afloat(Buoyancy(*two, 200.0), 1.0)
    assert with_a_link.out_of_water(1.0, level) == "50 N of lift missing because the hull is 25 % out of the water"
    assert sphere.out_of_water(9.0, level).startswith("100 N of lift missing because the hull is 100 %")


@pytest.mark.flight
def test_who_lifts_it_out_of_the_water_is_told_why_the_thrusters_do_not_suffice():
    given = at("cube", point(-1.0), duration_s=20.0)

    flight = cube_sim.Flight(given)
    for _ in range(900):
        flight.step(wrench=[0.0, 0.0, 400.0, 0.0, 0.0, 0.0])
    flight.fly_to_its_end()
    said = [line.text for line in flight.log if "of lift missing because the hull is" in line.text]
    assert len(said) == 1
