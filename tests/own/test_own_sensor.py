"""A sensor of the user's own: as good as cube_sim's own of the same law, saved with the flight, refused in one line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.command_line import call
from support.navigation_motion import AIDS, DT, GRAVITY, IMU, INITIAL, expected, truths, tumbling, weaving
from support.own_code import scenario_with
from support.places import CUBE

import cube_sim
from cube_sim.navigation.heading import LEAST_LEVEL_PART
from cube_sim.navigation.navigator import Navigator
from cube_sim.navigation.own_aid import OwnAid
from cube_sim.recording.reading import read_recording

DVL, DEPTH, HEADING, FIX = AIDS

BEACON = """\
import numpy as np

PLACE = np.array([10.0, 3.0, -5.0])


def beacon(farthest=100.0):
    def reading(motion):
        distance = np.linalg.norm(motion.position - PLACE)
        return distance if distance < farthest else None

    return reading
"""


def own(aid, reading, **changes) -> OwnAid:
    """A sensor of the same name, so of the same random numbers."""
    bias = aid.constants[0] if len(aid.constants) else 0.0
    return OwnAid(aid.name, aid.sampling, aid.components, aid.noise, bias, aid.name == "heading", reading, **changes)


def compass(motion):
    x, y, _ = motion.rotation[:, 0]
    return np.array([np.arctan2(y, x)]) if np.hypot(x, y) >= LEAST_LEVEL_PART else None


OWN_DEPTH = own(DEPTH, lambda motion: -motion.position[2:])
OWN_HEADING = own(HEADING, compass)
OWN_FIX = own(FIX, lambda motion: motion.position.copy())


def flown(aids, motions, seed=3):
    """States and covariances of a navigator after each tick."""
    navigator = Navigator(IMU, aids, INITIAL, motions[0], seed, GRAVITY, DT)
    states = []
    for true in motions:
        navigator.update(true)
        states.append((navigator.filter.x.copy(), navigator.filter.P.copy()))
    assert not any(aid.failures for aid in aids if isinstance(aid, OwnAid))
    return states


@pytest.mark.parametrize("motion", [weaving, tumbling])
def test_the_same_law_in_python_gives_the_same_estimate(motion):
    motions = truths(motion, 6.0)
    aids = (DVL, DEPTH, replace(HEADING, sampling=replace(HEADING.sampling, rate_hz=5.0)), FIX)
    in_python = (DVL, OWN_DEPTH, replace(OWN_HEADING, sampling=aids[2].sampling), OWN_FIX)
    for (x, P), (other_x, other_P) in zip(flown(aids, motions), flown(in_python, motions), strict=True):
        # differences of a compass's law are exact to 1e-8 near the level
        np.testing.assert_allclose(other_x, x, atol=1e-6)
        np.testing.assert_allclose(other_P, P, atol=1e-7)


@pytest.mark.parametrize("aid", AIDS, ids=lambda aid: aid.name)
def test_differences_are_the_derivative(aid):
    """Also with respect to the rates, which the DVL's lever arm sees."""
    motion = weaving(1.3)
    constants = np.zeros(len(aid.constants))
    ours = expected(aid, motion, constants)
    assert ours is not None
    twin = own(aid, lambda moved: expected(aid, moved, constants).value)
    H = twin.differences(motion)
    assert H is not None
    np.testing.assert_allclose(H[:, :9], ours.H_motion[:, :9], atol=1e-7)
    np.testing.assert_allclose(-H[:, 9:], ours.H_motion[:, 9:], atol=1e-7)


def test_a_jacobian_of_ones_own_is_used():
    asked = []

    def jacobian(motion):
        asked.append(motion)
        H = np.zeros((1, 12))
        H[0, 2] = -1.0
        return H

    motions = truths(weaving, 2.0)
    fast = own(DEPTH, OWN_DEPTH.reading, jacobian=jacobian)
    x, _ = flown((DVL, fast), motions)[-1]
    np.testing.assert_allclose(x, flown((DVL, DEPTH), motions)[-1][0], atol=1e-12)
    assert asked


def test_where_there_is_nothing_to_read_there_is_no_reading():
    motions = truths(weaving, 2.0)
    silent = own(DEPTH, lambda motion: None)
    navigator = Navigator(IMU, (DVL, silent), INITIAL, motions[0], 3, GRAVITY, DT)
    assert {int(reading["aid"]) for true in motions for reading in navigator.update(true)} == {0}


def navigated(path, **options):
    sensor = {"name": "beacon", "python": "own.py:beacon", "unit": "m", "noise": 0.05, "rate_hz": 5.0, "bias": 0.1}
    return cube_sim.Flight(path, {"navigation": {"own": [{**sensor, "options": options}]}, "duration_s": 4.0})


def to_the_end(flight):
    while not flight.over:
        flight.step()
    return flight.signals


@pytest.mark.flight
def test_a_flight_with_one_is_saved_and_goes_on_to_the_bit(tmp_path):
    path = scenario_with(tmp_path, BEACON)
    flight = navigated(path)
    while flight.time_s < 2.0:
        flight.step()
    middle = flight.snapshot()
    signals = to_the_end(flight)
    readings = signals["sensor_beacon.reading"]
    assert len(readings) == 20
    true = np.linalg.norm(signals["pose.position"][:, 1:] - [10.0, 3.0, -5.0], axis=1)
    taken = np.interp(readings[:, 0], signals["pose.position"][:, 0], true)
    assert np.abs(readings[:, 1] - taken).max() < 0.6
    other = navigated(path)
    other.restore(middle)
    assert to_the_end(other)["navigation.position"].tobytes() == signals["navigation.position"][100:].tobytes()


@pytest.mark.flight
def test_the_record_holds_its_code_and_its_readings_and_flies_again(tmp_path, monkeypatch, capsys):
    block = "{own: [{name: beacon, python: 'own.py:beacon', unit: m, noise: 0.05, rate_hz: 5}]}"
    path = scenario_with(tmp_path, BEACON, navigation=block)
    code, _, err = call(monkeypatch, capsys, "run", path, "--out", tmp_path / "out", "--quiet")
    assert (code, err) == (0, "")
    recording = read_recording(tmp_path / "out" / "run.mcap")
    assert recording.signals["sensor_beacon.reading"].shape == (3, 2)
    assert [code.key for code in recording.header.code] == ["navigation.own.0"]
    assert recording.header.code[0].source == BEACON
    resolved = tmp_path / "out" / "resolved.yaml"
    code, _, err = call(monkeypatch, capsys, "run", resolved, "--out", tmp_path / "again", "--quiet")
    assert (code, err) == (0, "")
    again = read_recording(tmp_path / "again" / "run.mcap").signals
    assert again["navigation.position"].tobytes() == recording.signals["navigation.position"].tobytes()


@pytest.mark.flight
def test_an_error_on_the_way_ends_the_run_with_its_line(tmp_path):
    text = BEACON.replace("return distance if", "return 1.0 / 0.0 if motion.position[0] > 0.05 else distance if")
    flight = navigated(scenario_with(tmp_path, text))
    to_the_end(flight)
    assert flight.ended == "navigation.own.0: own.py:9: ZeroDivisionError: float division by zero"
    assert 0.0 < flight.time_s < 4.0


@pytest.mark.flight
def test_of_two_errors_at_once_none_is_left_for_the_next_flight(tmp_path):
    source = "def make(): return lambda motion: motion.position[2] if motion.position[0] < 0.05 else motion.depth"
    sensor = {"python": "own.py:make", "unit": "m", "noise": 0.05, "rate_hz": 5.0}
    sensors = [{**sensor, "name": "one"}, {**sensor, "name": "other"}]
    flight = cube_sim.Flight(scenario_with(tmp_path, source), {"navigation": {"own": sensors}, "duration_s": 4.0})
    to_the_end(flight)
    assert flight.ended == "navigation.own.0: own.py:1: AttributeError: 'Motion' object has no attribute 'depth'"
    failed_s = flight.time_s
    flight.reset()
    to_the_end(flight)
    assert flight.time_s == failed_s > 0.0


@pytest.mark.parametrize(
    ("source", "sensor", "key", "told"),
    [
        ("def make(): return 3", "", "own.0.python", "makes a int; it takes a function, or an object with reading"),
        ("def make(): return lambda m: [1, 2]", "", "own.0.python", "answers a reading of shape (2,); it takes 1 numb"),
        ("def make(): return lambda m: m.depth", "", "own.0.python", "own.py:1: AttributeError: 'Motion' object has"),
        ("def make(): return lambda m: float('nan')", "", "own.0.python", "every number must be finite"),
        ("def make(a): return lambda m: 1", "", "own.0.python", "missing a required argument: 'a'"),
        ("def make(): return lambda m: 1", "name: depth, ", "own.0.name", "there is a sensor depth already"),
        ("def make(): return lambda m: 1", "rate_hz: 80, ", "own.0.rate_hz", "at most one reading per control period"),
        ("def make(): return lambda m: 1", "noise: 0, ", "own.0.noise", "at least 1e-06"),
    ],
)
def test_what_is_no_sensor_is_one_line(source, sensor, key, told, tmp_path, monkeypatch, capsys):
    usual = {"name": "mine", "noise": "0.1", "rate_hz": "5"}
    usual.update(part.split(": ") for part in sensor.split(", ") if part)
    block = ", ".join(f"{name}: {value}" for name, value in usual.items())
    path = scenario_with(tmp_path, source, navigation=f"{{own: [{{{block}, python: 'own.py:make'}}]}}")
    code, out, err = call(monkeypatch, capsys, "run", path, "--out", tmp_path / "out", "--quiet")
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert f": navigation.{key}: " in err
    assert told in err
    assert not (tmp_path / "out").exists()


def test_one_sensor_that_sees_the_position_is_enough(tmp_path):
    path = scenario_with(tmp_path, "def make(): return lambda motion: motion.position.copy()")
    assert str(CUBE) in path.read_text()
    fix = {"name": "fix", "python": "own.py:make", "components": 3, "noise": 0.1}
    block = {"dvl": None, "depth": None, "heading": None, "own": [fix]}
    assert cube_sim.Flight(path, {"navigation": block}).step().estimate is not None
