"""What is recorded on change is judged by how long it held, in a flight and in its record."""

from __future__ import annotations

import numpy as np
import pytest
from support.scenario_files import FLIGHT, write

import cube_sim
from cube_sim.runs.judged_record import judged_record


@pytest.mark.flight
def test_the_mean_of_the_limits_believed_is_over_time_not_over_rows(tmp_path):
    """A thruster loses half its force when three quarters of the run are over, and the controller is told."""
    check = {"kind": "signal", "signal": "actuation.limits", "component": 3, "at_least": 1.0}
    settings = {
        "duration_s": 4.0,
        "control.faults": "told",
        "events": [{"kind": "thrusters", "at_s": 3.0, "thrusters": ["T1"], "state": "weak", "efficiency": 0.5}],
        "checks": [{**check, "statistic": statistic} for statistic in ("mean", "min", "max")],
    }
    run = cube_sim.run(write(tmp_path, FLIGHT), settings, tmp_path / "run")
    rows = run.signals["actuation.limits"][:, [0, 4]]
    whole, half = rows[0, 1], rows[-1, 1]
    assert half == pytest.approx(0.5 * whole)
    mean, least, largest = (result.value for result in run.checks)
    assert (least, largest) == (half, whole)
    assert mean == pytest.approx(0.75 * whole + 0.25 * half, rel=1e-9)
    assert abs(mean - np.mean(rows[:, 1])) > 0.1 * whole
    assert judged_record(tmp_path / "run", lambda run: None).results == run.checks
