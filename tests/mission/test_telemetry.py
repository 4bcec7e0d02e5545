"""The `telemetry` block: what it may say, what it does to the readings, and flights that depend on it."""

from __future__ import annotations

import numpy as np
import pytest
from support.flights import FORCES_ONLY, said, thruster_event
from support.places import SCENARIOS
from support.scenario_files import FLIGHT, mistakes, write

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.mission.telemetry import Telemetry
from cube_sim.scenario.telemetry_block import TelemetryBlock

SURVIVAL = SCENARIOS / "cube_survival.yaml"


@pytest.mark.parametrize(
    ("block", "text"),
    [
        ({"gain": 0.0}, "telemetry.gain: must be"),
        ({"noise_N": -1.0}, "telemetry.noise_N: must be"),
        ({"gain_tolerance": 0.6}, "telemetry.gain_tolerance: must be"),
        ({"thruster_gains": [1.0, -1.0]}, "telemetry.thruster_gains.1: must be"),
        ({"gain": 1.1, "thruster_gains": [1.0] * 8}, "telemetry.thruster_gains: stands in place of gain"),
    ],
)
def test_what_makes_no_sense_is_refused(tmp_path, block, text):
    (line,) = mistakes(write(tmp_path), {"telemetry": block})
    assert text in line


def test_a_gain_for_each_thruster(tmp_path):
    with pytest.raises(ScenarioError, match=r"telemetry\.thruster_gains: 3 numbers for 8 thrusters; the model has T1"):
        cube_sim.run(write(tmp_path, FLIGHT), {"telemetry.thruster_gains": [1.0] * 3}, out=tmp_path / "run")


def test_readings_have_the_gain_and_the_noise_they_are_said_to_have():
    gains = (0.9, 1.0, 1.1)
    force = np.array([10.0, -20.0, 30.0])
    block = TelemetryBlock(thruster_gains=gains, noise_N=2.0)
    one, again, other = (Telemetry(block, 3, seed) for seed in (4, 4, 5))
    rows = np.array([one.read(force) for _ in range(4000)])
    np.testing.assert_allclose(rows.mean(axis=0), force * gains, atol=0.15)
    np.testing.assert_allclose(rows.std(axis=0), 2.0, rtol=0.05)
    np.testing.assert_array_equal(rows[0], again.read(force))
    assert not np.array_equal(rows[0], other.read(force))
    np.testing.assert_array_equal(Telemetry(TelemetryBlock(gain=1.2), 3, 0).read(force), 1.2 * force)


@pytest.mark.flight
@pytest.mark.parametrize("gains", [[1.1] * 8, [0.9, 1.1, 1.05, 0.95, 1.0, 0.92, 1.08, 1.1]])
@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_dead_thrusters_are_found_and_healthy_ones_left_alone_in_flight(tmp_path, gains, noise):
    changes = {
        "duration_s": 16,
        "events": [thruster_event(9, ["T1", "T5"], "dead")],
        "checks": FORCES_ONLY,
        "telemetry": {"thruster_gains": gains, "noise_N": noise},
    }
    run = cube_sim.run(SURVIVAL, changes, out=tmp_path / "run")
    told = [text.split(";")[0] for text in said(run) if ";" in text and "T" in text.split(";")[0]]
    assert all(set(text.split(", ")) <= {"T1 dead", "T5 dead"} for text in told)
    assert told[-1] == "T1 dead, T5 dead"
    t, believed = run.signals["health.believed"][:, 0], run.signals["health.believed"][:, 1:]
    assert (believed[t < 9.0] == 1.0).all()
    np.testing.assert_array_equal(believed[-1], [0, 1, 1, 1, 0, 1, 1, 1])
