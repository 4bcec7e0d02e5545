"""Four of eight thrusters lost on the way: what the analysis says yes to is followed to the end of the path."""

from __future__ import annotations

import pytest
from support.places import SCENARIOS

import cube_sim

pytestmark = pytest.mark.flight


def test_a_vehicle_that_points_its_thrust_comes_to_rest_at_the_end_of_its_path():
    """To brake harder than the water does it would have to turn half round."""
    lost = ["T1", "T2", "T3", "T8"]
    rms = {"kind": "signal", "signal": "path_error.cross_track", "statistic": "rms", "from_s": 45.0}
    run = cube_sim.run(
        SCENARIOS / "cube_survival.yaml",
        {
            "model": "../models/cube_as_built.xml",
            "events": [{"kind": "thrusters", "at_s": 20.0, "thrusters": lost, "state": "dead"}],
            "checks": [rms | {"at_most": 0.05}, {"kind": "path_end", "reach_m": 0.5}],
        },
    )
    assert run.verdict == "PASS", run.checks
