"""Events that befall sensors: what they make of readings, what they leave alone, and what the filter makes of them."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.places import SCENARIOS
from support.scenario_files import MINIMAL, mistakes, write

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.flight import Flight
from cube_sim.mission import prepare
from cube_sim.scenario import load

NAVIGATED = SCENARIOS / "cube_navigated.yaml"
CHECKS = [{"kind": "allowed_forces"}]
# A sensor's noise is small beside its faults, its bias none, so that a fault can be told from it.
EXACT = {
    "navigation.dvl": {"noise_m_s": 1e-4, "bias_m_s": 0.0, "scale_error": 0.0},
    "navigation.depth": {"noise_m": 1e-4, "bias_m": 0.0},
    "navigation.heading": {"noise_deg": 0.01, "bias_deg": 0.0},
}
DEPTH = {"navigation.depth": {"noise_m": 0.01, "bias_m": 0.0}}


def event(sensor, state, at_s=3.0, **others):
    return {"kind": "sensor", "sensor": sensor, "state": state, "at_s": at_s, **others}


def flown(*events, duration_s=8.0, **settings):
    settings = {"checks": CHECKS, "duration_s": duration_s, "events": list(events), **settings}
    flight = Flight(NAVIGATED, settings)
    flight.fly_to_its_end()
    return flight


def times(flight, sensor):
    """When the readings were taken [s]."""
    return flight.signals[f"sensor_{sensor}.taken_at"][:, 1]


def readings(flight, sensor, quantity, from_s=0.0, to_s=np.inf):
    taken = times(flight, sensor)
    return flight.signals[f"sensor_{sensor}.{quantity}"][(taken >= from_s) & (taken < to_s), 1:]


@pytest.fixture(scope="module")
def healthy():
    return flown()


@pytest.mark.flight
def test_a_lost_sensor_is_silent_until_its_time_is_over_and_draws_its_numbers_all_the_same(healthy):
    """The flights differ then, so it is the noise that is compared: what was read less the truth."""
    flight = flown(event("depth", "lost", for_s=2.0))
    taken = times(flight, "depth")
    assert not ((taken >= 3.0) & (taken < 5.0)).any()
    assert (taken[taken < 3.0] == times(healthy, "depth")[times(healthy, "depth") < 3.0]).all()

    def noise(one):
        depth = readings(one, "depth", "depth", 5.0)[:, 0]
        pose = one.signals["pose.position"]
        return depth + np.interp(times(one, "depth")[times(one, "depth") >= 5.0], pose[:, 0], pose[:, 3])

    assert noise(flight) == pytest.approx(noise(healthy), abs=1e-12)
    assert [(line.t, line.level, line.text) for line in flight.log if "depth:" in line.text] == [
        (3.0, "WARNING", "depth: lost, for 2 s"),
        (5.0, "INFO", "depth: no longer lost"),
    ]


@pytest.mark.flight
def test_other_sensors_read_the_same_numbers(healthy):
    """Until the first fix the flight is the same whatever fixes come later."""
    flight = flown(event("position", "lost", at_s=0.0), duration_s=0.4)
    for sensor, quantity in (("dvl", "velocity"), ("depth", "depth"), ("heading", "heading")):
        n = len(readings(flight, sensor, quantity))
        assert readings(flight, sensor, quantity).tobytes() == readings(healthy, sensor, quantity)[:n].tobytes()


@pytest.mark.flight
@pytest.mark.parametrize(
    ("condition", "lost"),
    [
        ({"tilt_above_deg": 12.0}, lambda tilt, depth: tilt > radians(12.0)),
        ({"deeper_than_m": 8.05}, lambda tilt, depth: depth > 8.05),
        ({"shallower_than_m": 7.95}, lambda tilt, depth: depth < 7.95),
    ],
)
def test_a_sensor_is_lost_while_a_condition_holds(condition, lost):
    settings = {"initial.attitude_deg": [25.0, 0.0, 90.0], "initial.position_m": [3.0, 0.0, -8.2]}
    flight = flown(event("dvl", "lost", at_s=0.0, **condition), duration_s=12.0, **settings)
    q, z = flight.signals["pose.quaternion"], flight.signals["pose.position"][:, 3]
    tilt = np.arccos(1.0 - 2.0 * (q[:, 2] ** 2 + q[:, 3] ** 2))
    silent = lost(tilt, -z)
    ticks = np.round(times(flight, "dvl") / 0.02).astype(int)
    due = np.arange(0, 590, 10)
    assert set(ticks[ticks < 590].tolist()) == {tick for tick in due.tolist() if not silent[tick]}
    assert 0 < silent[due].sum() < len(due)


@pytest.mark.flight
def test_zeros_are_read_and_rejected():
    flight = flown(event("dvl", "zeros", for_s=1.0))
    assert not readings(flight, "dvl", "velocity", 3.0, 4.0).any()
    assert readings(flight, "dvl", "velocity", 4.0).any(axis=1).all()
    outcomes = readings(flight, "dvl", "outcome", 3.0, 3.6)[:, 0]
    assert (outcomes == 1).all()  # the gate has none of three, and then it doubts itself as of any other outlier


@pytest.mark.flight
def test_a_frozen_sensor_repeats_its_last_reading():
    flight = flown(
        event("heading", "frozen"), event("heading", "recovered", at_s=6.0), event("imu", "frozen", at_s=7.0)
    )
    last = readings(flight, "heading", "heading", 2.0, 3.0)[-1]
    assert (readings(flight, "heading", "heading", 3.0, 6.0) == last).all()
    assert len(np.unique(readings(flight, "heading", "heading", 6.0))) > 10
    rates = flight.signals["sensor_imu.rates"]
    assert (rates[rates[:, 0] >= 7.0, 1:] == rates[rates[:, 0] < 7.0, 1:][-1]).all()


@pytest.mark.flight
def test_outliers_have_the_share_and_the_size_that_are_asked_for_and_are_rejected():
    flight = flown(event("depth", "outliers", at_s=0.0, share=0.2, size=3.0), duration_s=60.0, **DEPTH)
    pose = flight.signals["pose.position"]
    off = readings(flight, "depth", "depth")[:, 0] + np.interp(times(flight, "depth"), pose[:, 0], pose[:, 3])
    outlier, outcome = np.abs(off) > 0.06, readings(flight, "depth", "outcome")[:, 0]
    n = len(off)
    assert abs(outlier.sum() - 0.2 * n) < 3.5 * np.sqrt(0.16 * n)
    assert np.std(off[outlier]) == pytest.approx(3.0, rel=0.2)
    far = np.abs(off) > 0.5
    assert (outcome[far] == 1).mean() > 0.9
    assert np.abs(flight.signals["navigation_error.position"][250:, 3]).max() < 0.05


@pytest.mark.flight
def test_a_late_sensor_reads_what_was():
    """It stamps its readings as ever."""
    flight = flown(
        event("depth", "late", delay_s=1.0), duration_s=10.0, **EXACT, **{"navigation.initial.position_m": 1e-3}
    )
    pose, taken = flight.signals["pose.position"], times(flight, "depth")
    depth = readings(flight, "depth", "depth")[:, 0]
    then = np.where(taken >= 3.0, taken - 1.0, taken)
    assert depth == pytest.approx(-np.interp(then, pose[:, 0], pose[:, 3]), abs=6e-4)
    assert np.abs(np.interp(then, pose[:, 0], pose[:, 3]) - np.interp(taken, pose[:, 0], pose[:, 3])).max() > 1e-2


@pytest.mark.flight
def test_a_disturbed_compass_turns_the_estimate_and_is_told():
    flight = flown(event("heading", "biased", offset=[20.0]), duration_s=12.0, **EXACT)
    error = flight.signals["navigation_error.attitude"]
    assert np.abs(error[(error[:, 0] > 1.0) & (error[:, 0] < 3.0), 3]).max() < radians(2.0)
    assert error[-1, 3] == pytest.approx(radians(20.0), abs=radians(4.0))
    assert any("heading contradicts the estimate" in line.text for line in flight.log)


@pytest.mark.flight
def test_faults_of_one_sensor_add_up_and_end_each_for_itself():
    events = [
        event("depth", "biased", offset=[1.0], for_s=1.0),
        event("depth", "biased", at_s=3.5, offset=[2.0]),
        event("depth", "lost", at_s=4.5, for_s=0.5),
    ]
    flight = flown(*events, duration_s=6.0, **EXACT)
    pose, taken = flight.signals["pose.position"], times(flight, "depth")
    off = readings(flight, "depth", "depth")[:, 0] + np.interp(taken, pose[:, 0], pose[:, 3])
    expected = np.where(taken >= 3.5, 2.0, np.where(taken >= 3.0, 1.0, 0.0))
    assert off == pytest.approx(expected, abs=6e-4)
    assert not ((taken >= 4.5) & (taken < 5.0)).any()


@pytest.mark.flight
@pytest.mark.parametrize("sensor", ["dvl", "depth", "heading", "position"])
def test_both_loops_see_the_same_faults(sensor, monkeypatch):
    size = {"dvl": 3, "position": 3}.get(sensor, 1)
    events = [
        event(sensor, "outliers", at_s=1.0, share=0.3, size=2.0, for_s=2.0),
        event(sensor, "late", at_s=1.5, delay_s=0.7),
        event(sensor, "frozen", at_s=3.0, for_s=1.0),
        event(sensor, "lost", at_s=4.0, tilt_above_deg=5.0, for_s=1.0),
        event(sensor, "biased", at_s=4.5, offset=[0.5] * size),
        event(sensor, "recovered", at_s=6.0),
        event(sensor, "zeros", at_s=7.0),
        event("imu", "biased", at_s=7.5, offset=[0.2, 0, 0, 0, 0, 0.05]),
    ]
    settings = {"events": events, "duration_s": 9.0, "checks": CHECKS, "navigation.position.rate_hz": 5.0}
    assert assert_same_flight(NAVIGATED, settings, monkeypatch) > 0.3


@pytest.mark.flight
def test_a_snapshot_takes_faults_along():
    settings = {
        "checks": CHECKS,
        "duration_s": 8.0,
        "events": [event("heading", "biased", at_s=1.0, offset=[20.0], for_s=4.0)],
    }
    flight = Flight(NAVIGATED, settings)
    flight.fly(100)
    snapshot = flight.snapshot()
    flight.fly_to_its_end()
    signals = {name: rows[rows[:, 0] > 2.5].tobytes() for name, rows in flight.signals.items()}
    other = Flight(NAVIGATED, settings)
    other.restore(snapshot)
    other.fly_to_its_end()
    assert signals == {name: rows[rows[:, 0] > 2.5].tobytes() for name, rows in other.signals.items()}
    flight.reset()
    flight.fly_to_its_end()
    assert signals == {name: rows[rows[:, 0] > 2.5].tobytes() for name, rows in flight.signals.items()}


@pytest.mark.parametrize(
    ("sensor", "state", "others", "expected"),
    [
        ("sonar", "lost", {}, "0.sensor: no sensor 'sonar'; there are imu, dvl, depth, heading, position"),
        ("imu", "lost", {}, "0.state: the inertial unit cannot be lost"),
        ("dvl", "biased", {"offset": [1.0]}, "0.offset: 1 number for readings of 3"),
    ],
)
def test_what_these_sensors_cannot_have_is_refused(sensor, state, others, expected):
    with pytest.raises(ScenarioError, match=expected):
        prepare(load(NAVIGATED, {"events": [event(sensor, state, **others)]}))


def test_without_navigation_there_is_nothing_to_fail(tmp_path):
    with pytest.raises(ScenarioError, match="the scenario has no navigation block"):
        cube_sim.run(SCENARIOS / "cube_hover.yaml", {"events": [event("dvl", "lost")]}, out=tmp_path / "run")


@pytest.mark.parametrize(
    ("fault", "expected"),
    [
        ("state: outliers, share: 0.1", "events.0.state: size and state outliers go together"),
        ("state: lost, offset: [1]", "events.0.offset: offset and state biased go together"),
        ("state: lost, deeper_than_m: 3, shallower_than_m: 5", "events.0.shallower_than_m: deeper than 3 m or less"),
        ("state: zeros, tilt_above_deg: 3", "events.0.tilt_above_deg: says while what a sensor is lost"),
        ("state: recovered, for_s: 3", "events.0.for_s: a sensor that is recovered stays so"),
    ],
)
def test_what_is_no_fault_is_refused_in_place(fault, expected, tmp_path):
    (found,) = mistakes(write(tmp_path, MINIMAL + f"events: [{{kind: sensor, at_s: 1, sensor: dvl, {fault}}}]\n"))
    assert expected in found
