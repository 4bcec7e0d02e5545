"""Flights on an estimate that sensors lie to: every one is flown to its end, on an estimate that stays bounded."""

from __future__ import annotations

import numpy as np
import pytest
from support.places import SCENARIOS

from cube_sim.flight import Flight
from cube_sim.navigation.gate import FASTEST

pytestmark = pytest.mark.flight

VEHICLES = {
    "cube.xml": SCENARIOS.parent / "models" / "cube.xml",
    "bluerov2_heavy.xml": SCENARIOS.parent / "models" / "bluerov2_heavy.xml",
}
MILD = {
    "half the headings anywhere": {"sensor": "heading", "state": "outliers", "share": 0.5, "size": 60},
    "no heading to be trusted": {"sensor": "heading", "state": "outliers", "share": 1, "size": 90},
    "velocities anywhere": {"sensor": "dvl", "state": "outliers", "share": 1, "size": 100},
}
HARD = {
    "depth zeros": {"sensor": "depth", "state": "zeros"},
    "depth off by 10 m": {"sensor": "depth", "state": "biased", "offset": [10]},
    "depths anywhere": {"sensor": "depth", "state": "outliers", "share": 1, "size": 100},
    "velocity off by 3 m/s": {"sensor": "dvl", "state": "biased", "offset": [3, 0, 0]},
    "free fall": {"sensor": "imu", "state": "zeros"},
    "free fall for 2 s": {"sensor": "imu", "state": "zeros", "for_s": 2},
    "the inertial unit stands": {"sensor": "imu", "state": "frozen"},
    "the inertial unit is off": {"sensor": "imu", "state": "biased", "offset": [10, 10, 10, 1, 1, 1]},
    "the inertial unit is mad": {"sensor": "imu", "state": "biased", "offset": [1e4, 0, 0, 1, 1, 1]},
}


def flown(model, fault):
    event = {"kind": "sensor", "at_s": 5, **fault}
    checks = [{"kind": "allowed_forces"}]
    changes = {"model": str(VEHICLES[model]), "duration_s": 15, "checks": checks, "events": [event]}
    flight = Flight(SCENARIOS / "cube_navigated.yaml", changes)
    flight.fly_to_its_end()
    assert flight.signals["pose.position"][-1, 0] == pytest.approx(15.0, abs=0.1)
    for name in ("navigation", "navigation_error", "wrench"):
        for signal, table in flight.signals.items():
            if signal.startswith(f"{name}."):
                assert np.isfinite(table).all(), signal
    return flight


@pytest.mark.parametrize("model", VEHICLES)
@pytest.mark.parametrize("fault", MILD)
def test_outliers_that_contradict_each_other_cost_little(model, fault):
    signals = flown(model, MILD[fault]).signals
    after = signals["path_error.cross_track"][:, 0] > 10.0
    assert np.abs(signals["path_error.cross_track"][after, 1]).max() < 0.6
    assert np.abs(signals["navigation_error.velocity"][:, 1:]).max() < 0.5


@pytest.mark.parametrize("model", VEHICLES)
@pytest.mark.parametrize("fault", HARD)
def test_what_nothing_survives_is_flown_to_its_end(model, fault):
    signals = flown(model, HARD[fault]).signals
    assert np.linalg.norm(signals["navigation.linear"][:, 1:], axis=1).max() <= FASTEST + 1e-9
    if fault.startswith("depth"):  # the depth is believed, and nothing else with it
        assert np.abs(signals["navigation_error.velocity"][:, 1:]).max() < 0.5
        assert np.abs(signals["navigation_error.attitude"][:, 1:]).max() < 0.3
    if fault.startswith("free fall"):  # seen for what it is: the estimate goes on by the other sensors
        assert np.abs(signals["navigation_error.velocity"][:, 1:]).max() < 8.0
    if fault == "velocity off by 3 m/s":  # believed, and what it is led to: 4 to 9 m/s, by the moment it begins
        assert np.abs(signals["navigation_error.velocity"][:, 1:]).max() < 10.0
