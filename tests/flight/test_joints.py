"""Joints of what a hull carries, as they are recorded: commanded or not, both loops the same, in fleets too."""

from __future__ import annotations

import json

import mujoco
import numpy as np
import pytest
from support.ballasted import ballasted
from support.both_loops import assert_same_flight
from support.hanging import hanging

import cube_sim
from cube_sim.flight import Flight
from cube_sim.vehicle.carried_joints import carried_joints


@pytest.mark.parametrize("changes", [{}, {"navigation": {}}, {"current_m_s": [0.1, 0.1, 0.0]}])
def test_both_loops_record_the_same(changes, tmp_path, monkeypatch):
    assert assert_same_flight(hanging(tmp_path, **changes), {}, monkeypatch) > 0.9


def test_what_nobody_commands_is_recorded_as_it_moves(tmp_path):
    flight = Flight(hanging(tmp_path))
    flight.fly_to_its_end()
    position, velocity = flight.signals["joints.position"], flight.signals["joints.velocity"]
    (channel,) = (channel for channel in flight.mission.channels if channel.name == "joints")
    names, units = zip(*((field.columns, field.units) for field in channel.fields), strict=True)
    assert names[0] == ("swing", "socket/w", "socket/x", "socket/y", "socket/z", "slide")
    assert names[1] == ("swing", "socket/x", "socket/y", "socket/z", "slide")
    assert units == (("rad", "1", "1", "1", "1", "m"), ("rad/s", "rad/s", "rad/s", "rad/s", "m/s"))
    t = position[:, 0]
    assert np.array_equal(t, flight.signals["pose.position"][:, 0])
    assert np.ptp(position[:, 1]) > 0.01
    # The velocities are those of the positions: the middle of two rows against their difference.
    swing, slide = (np.diff(position[:, i]) / np.diff(t) for i in (1, 6))
    assert swing == pytest.approx((velocity[1:, 1] + velocity[:-1, 1]) / 2, abs=0.02 * np.abs(velocity[:, 1]).max())
    assert slide == pytest.approx((velocity[1:, 5] + velocity[:-1, 5]) / 2, abs=0.02 * np.abs(velocity[:, 5]).max())
    assert np.linalg.norm(position[:, 2:6], axis=1) == pytest.approx(1.0, abs=1e-9)
    turned = 2.0 * np.linalg.norm(np.diff(position[:, 3:6], axis=0), axis=1) / np.diff(t)
    rate = np.linalg.norm((velocity[1:, 2:5] + velocity[:-1, 2:5]) / 2, axis=1)
    assert turned == pytest.approx(rate, abs=0.05 * rate.max())


def test_a_joint_that_is_told_where_to_stand_is_recorded_there(tmp_path):
    flight = Flight(ballasted(tmp_path, duration_s=6, events=[]))
    flight.fly_to_its_end()
    reached, position = flight.signals["setpoints.reached"], flight.signals["joints.position"]
    assert position.shape[1] == 2
    assert position[:, 1].tobytes() == reached[:, 2].tobytes()  # of tank and battery


def test_a_hull_that_carries_nothing_has_no_such_channel():
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body name='hull'><freejoint/><geom size='1'/><body><geom size='1'/></body></body>"
        "<body name='crane'><joint name='turns'/><geom size='1'/></body></worldbody></mujoco>"
    )
    assert carried_joints(model, 1) is None
    found = carried_joints(model, model.body("crane").id, "cr")
    assert found is not None
    assert found.positions == (("turns", "rad"),)


def test_a_flight_ends_by_where_a_joint_stands(tmp_path):
    told = {"battery": {"times_s": [0, 2], "values": [0.0, 0.05]}}
    stop = [{"kind": "signal", "signal": "joints.position", "component": 0, "above": 0.015, "verdict": "pass"}]
    flight = Flight(ballasted(tmp_path, stop=stop, events=[], setpoints=told))
    flight.fly_to_its_end()
    assert flight.ended is not None
    position = flight.signals["joints.position"][:, 1]
    assert position[-1] > 0.015 >= position[:-1].max()


def test_a_vehicle_among_others_has_its_own(tmp_path):
    own = hanging(tmp_path)
    together = {key: own.pop(key) for key in ("schema_version", "name", "model", "duration_s", "surface_m")}
    own.pop("checks")
    other = {**own, "initial": {"position_m": [0, 5, -5]}}
    other["path"] = {**own["path"], "start_m": [0, 5, -5], "end_m": [20, 5, -5]}
    fleet = {**together, "vehicles": {"one": own, "other": other}}
    fleet["checks"] = [{"kind": "signal", "signal": "one/joints.velocity", "statistic": "max_abs", "at_most": 100}]
    (tmp_path / "pair.yaml").write_text(json.dumps(fleet))
    run = cube_sim.run(tmp_path / "pair.yaml", record="none", out=tmp_path / "run")
    alone = Flight(hanging(tmp_path))
    alone.fly_to_its_end()
    for field in ("position", "velocity"):
        assert run.signals[f"one/joints.{field}"].tobytes() == alone.signals[f"joints.{field}"].tobytes()
    assert not np.array_equal(run.signals["other/joints.position"][:, 0], run.signals["other/joints.position"][:, 1])
