"""Set-points of a scenario: what actuators are told, both loops the same, what the controller reckons with."""

from __future__ import annotations

import json

import numpy as np
import pytest
from support.ballasted import ballasted
from support.both_loops import assert_same_flight

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.flight import Flight
from cube_sim.mission.prepare import prepare
from cube_sim.scenario.loading import load_mapping

NOTHING = {"setpoints": {}, "events": [], "checks": [{"kind": "allowed_forces"}]}


@pytest.mark.parametrize(
    "changes",
    [{}, {"current_m_s": [0.0, 0.1, 0.0], "surface_m": 0.0}, {"navigation": {}}, {"physics": {"integrator": "Euler"}}],
    ids=["still", "current", "navigation", "Euler"],
)
def test_both_loops_fly_the_same(changes, tmp_path, monkeypatch):
    assert assert_same_flight(ballasted(tmp_path, **changes), {}, monkeypatch) > 0.9


def test_what_is_told_and_what_it_comes_to(tmp_path):
    flight = Flight(ballasted(tmp_path))
    flight.fly_to_its_end()
    rows = flight.signals["setpoints.wanted"]
    t, (tank, battery, bladder) = rows[:, 0], rows[:, 1:].T
    assert tank == pytest.approx(np.interp(t, [3, 6], [5e-4, 1e-3]), abs=1e-15)
    assert bladder == pytest.approx(np.interp(t, [4.99, 6.99], [0.0, 4e-4]), abs=1e-15)
    assert battery == pytest.approx(np.where(t < 5 - 1e-9, 0.02, np.where(t < 8 - 1e-9, -0.02, 0.1)), abs=0)
    reached = flight.signals["setpoints.reached"][:, 1:]
    assert reached[0] == pytest.approx([5e-4, 0.02, 0.0], abs=1e-12)  # it begins where it is told to be
    assert reached[-1] == pytest.approx([1e-3, 0.1, 4e-4], abs=2e-3)
    pumped = np.diff(reached[:, 0]) / np.diff(t)
    assert pumped.max() <= 1e-4 + 1e-12
    told = [(line.t, line.level, line.text) for line in flight.log if "bladder" in line.text]
    assert told[0][2] == "the pump 'bladder' moves 0.05 l/s: told to have 0.4 l at 6.99 s it has 0.1 l then"
    assert told[1:] == [(5.0, "INFO", "bladder: to 0.0004 within 2 s")]


def test_a_snapshot_flies_on_the_same(tmp_path):
    one = Flight(ballasted(tmp_path))
    one.fly(240)
    kept = one.snapshot()
    one.fly(120)
    first = one.signals["setpoints.reached"][-120:].tobytes()
    one.restore(kept)
    one.fly(120)
    assert one.signals["setpoints.reached"][-120:].tobytes() == first


def test_the_controller_reckons_with_ballast_and_masses_as_they_are_at_the_start(tmp_path):
    """Told of them it has nothing to learn; the same flight without set-points finds a disturbance in none either."""
    held = {
        "tank": {"times_s": [0], "values": [1e-3]},
        "bladder": {"times_s": [0], "values": [6e-4]},
        "battery": {"times_s": [0], "values": [0.05]},
    }
    flights = []
    for changes in ({**NOTHING, "setpoints": held}, NOTHING):
        flight = Flight(ballasted(tmp_path, **changes, guidance={"speed_m_s": 0.05}))
        flight.fly_to_its_end()
        flights.append(flight)
    lift = (6e-4 - 1e-3) * 1000.0 * 9.81
    learned = flights[0].signals["wrench.disturbance"][-1, 1:]
    assert abs(learned[2]) < 0.02 * abs(lift)
    asked = [flight.signals["wrench.allocated"][-1, 1:] for flight in flights]
    assert asked[0][2] - asked[1][2] == pytest.approx(-lift, rel=0.05)
    moment = 9.81 * (4.0 * 0.05 - 1e-3 * 1000 * 0.2 - 6e-4 * 1000 * 0.1)  # nose down, of battery, tank and bladder
    assert asked[0][4] - asked[1][4] == pytest.approx(-moment, abs=0.05 * 9.81 * 4.0 * 0.05)


def test_the_vehicle_is_read_where_it_stands(tmp_path):
    vehicle = prepare(load_mapping(ballasted(tmp_path))).vehicle
    tank, x = 0.5, 0.02
    assert vehicle.mass == pytest.approx(54.0 + tank)
    assert vehicle.centre_of_mass == pytest.approx(np.array([4 * x - 0.2 * tank, 0.0, -0.03 * 50]) / (54.0 + tank))
    assert vehicle.displaced_mass == 54.0
    about_y = 9.0 + 50 * 0.03**2 + 0.01 + 4 * x**2 + tank * 0.2**2
    assert vehicle.mass_matrix[4, 4] == pytest.approx(about_y)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"setpoints": {"nobody": {"times_s": [0], "values": [0]}}}, "no actuator 'nobody' that takes set-points"),
        ({"setpoints": {"slide": {"times_s": [0], "values": [0]}}}, "the joint 'slide' is moved by battery"),
        (
            {"events": [{"kind": "setpoint", "at_s": 1, "actuator": "tank", "value": v} for v in (0, 1e-3)]},
            "scenario.json:64:15: events.1.at_s: 'tank' is told another value at 1 s, by event 0",
        ),
        ({"setpoints": {"port": {"times_s": [0], "values": [0]}}}, "'port' is a thruster"),
        ({"setpoints": {"tank": {"times_s": [0], "values": [-1e-4]}}}, "tank follows 0 to 0.002 m^3, not -0.0001"),
        ({"setpoints": {"battery": {"times_s": [0], "values": [0.4]}}}, "battery follows -0.3 to 0.3 m, not 0.4"),
        ({"setpoints": {"tank": {"times_s": [1, 0], "values": [0, 0]}}}, "times must increase"),
        ({"setpoints": {"tank": {"times_s": [0, 1], "values": [0]}}}, "1 value for 2 times"),
        ({"setpoints": {"tank": {"times_s": [], "values": []}}}, "at least one time"),
        ({"events": [{"kind": "setpoint", "at_s": 1, "actuator": "stern", "value": 0}]}, "'stern' is a thruster"),
        ({"events": [{"kind": "setpoint", "at_s": 1, "actuator": "tank", "value": 3}]}, "tank follows"),
        ({"events": [{"kind": "setpoint", "at_s": 99, "actuator": "tank", "value": 0}]}, "before the end of the run"),
    ],
)
def test_one_line_says_what_is_wrong(changes, words, tmp_path):
    with pytest.raises(ScenarioError) as told:
        Flight(ballasted(tmp_path, **changes))
    assert words in str(told.value)
    assert "\n" not in str(told.value).strip()


def test_a_vehicle_among_others_has_its_own(tmp_path):
    own = ballasted(tmp_path)
    together = {key: own.pop(key) for key in ("schema_version", "name", "model", "duration_s", "surface_m")}
    own.pop("checks")
    other = {**own, "initial": {"position_m": [0, 5, -5]}, "path": {**own["path"], "start_m": [0, 5, -5]}}
    other["path"] = {**other["path"], "end_m": [20, 5, -5]}
    other["setpoints"] = {"tank": {"times_s": [0], "values": [2e-3]}}
    fleet = {**together, "vehicles": {"one": own, "other": other}}
    fleet["checks"] = [{"kind": "signal", "signal": "one/setpoints.reached", "statistic": "max", "at_most": 1}]
    (tmp_path / "pair.yaml").write_text(json.dumps(fleet))
    flight = cube_sim.run(tmp_path / "pair.yaml", record="none", out=tmp_path / "run").signals
    alone = Flight(ballasted(tmp_path))
    alone.fly_to_its_end()
    both = flight["one/setpoints.wanted"], alone.signals["setpoints.wanted"]
    assert both[0].tobytes() == both[1].tobytes()
    assert flight["other/setpoints.wanted"][0, 1:] == pytest.approx([2e-3, 0.0, 0.0])
    assert flight["other/setpoints.reached"][0, 1] == 2e-3
