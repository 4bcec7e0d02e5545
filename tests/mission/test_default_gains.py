"""The gains nobody has set, on each of the vehicles: they are times, so they suit 11 kg as well as two tonnes."""

import pytest
from support.places import MODELS

import cube_sim

pytestmark = pytest.mark.flight

PATHS = {
    "cube": "{type: helix, centre_m: [0, 0, -8], radius_m: 3, pitch_m: 2, turns: 2}",
    "cube_as_built": "{type: sinusoid, start_m: [0, 0, -8], amplitude_m: 1, wavelength_m: 8, periods: 4}",
    "bluerov2_heavy": "{type: helix, centre_m: [0, 0, -8], radius_m: 3, pitch_m: -2, turns: 2}",
    "jack": "{type: circle, centre_m: [0, 0, -8], radius_m: 3}",
    "infante": "{type: circle, centre_m: [0, 0, -8], radius_m: 12}",
}
SPEEDS = {"infante": 1.5, "jack": 0.3}


@pytest.mark.parametrize("vehicle", PATHS)
def test_every_vehicle_follows_a_curved_path_with_the_defaults(vehicle, tmp_path):
    scenario = tmp_path / "defaults.yaml"
    scenario.write_text(
        f"""\
schema_version: 1
name: defaults
model: {MODELS / (vehicle + ".xml")}
duration_s: 75
initial: {{position_m: [4.0, -4.0, -8.0], attitude_deg: [0, 0, -60], velocity_m_s: [0.2, 0.0, 0.0]}}
path: {PATHS[vehicle]}
guidance: {{speed_m_s: {SPEEDS.get(vehicle, 0.4)}}}
checks:
  - {{kind: signal, signal: path_error.cross_track, statistic: max, from_s: 55, at_most: 0.03}}
  - {{kind: allowed_forces}}
"""
    )
    run = cube_sim.run(scenario, out=tmp_path / "run")
    assert run.verdict == "PASS", [(check.name, check.value) for check in run.checks]
