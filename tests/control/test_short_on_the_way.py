"""A hull that starts upside down and is short of torque until it has turned: it looks for no refuge on the way."""

from __future__ import annotations

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY
from support.places import HELIX

import cube_sim

pytestmark = pytest.mark.flight


def test_it_rights_itself_and_follows_its_path(tmp_path):
    """One thruster alone pitches it, with a fraction of its righting moment."""
    (tmp_path / "model.xml").write_text(catalogue()["drawn7_2"].make())
    settings = {
        "model": tmp_path / "model.xml",
        "path": {"type": "line", "start_m": [0.0, 0.0, -20.0], "end_m": [60.0, 0.0, -20.0]},
        "initial": {"position_m": [1.0, 1.0, -20.0], "attitude_deg": [162.0, 18.0, 137.0]},
        "guidance.speed_m_s": 0.45,
        "current_m_s": [0.0, 0.0, 0.0],
        "events": [],
        "duration_s": 60.0,
        "checks": FORCES_ONLY,
    }
    run = cube_sim.run(HELIX, settings, out=tmp_path / "run")
    t, error = run.signals["path_error.cross_track"].T
    assert error.max() < 2.0
    assert np.sqrt(np.mean(error[t >= 40.0] ** 2)) < 0.005
