"""A healthy thruster is never doubted, however its motor is modelled and integrated."""

from __future__ import annotations

import numpy as np
import pytest
from support.edited_cube import edited_text
from support.flights import said
from support.places import SCENARIOS

import cube_sim

pytestmark = pytest.mark.flight

HELIX = SCENARIOS / "cube_helix.yaml"


def doubts(run):
    """What the log says of thrusters' health."""
    return [text for text in said(run) if any(word in text for word in (" dead", " stuck", " %", "whole"))]


@pytest.mark.parametrize(
    ("motor", "physics", "period_s"),
    [
        ('delay="0.04" nsample="4"', {}, 0.02),
        ('delay="0.1" nsample="10"', {}, 0.02),
        ('delay="0.055" nsample="6" interp="linear"', {}, 0.02),
        ("", {"physics.step_s": 0.049}, 0.049),
        ("", {"physics.step_s": 0.02, "physics.integrator": "Euler"}, 0.02),
        ("", {"physics.step_s": 0.038, "physics.integrator": "implicitfast"}, 0.038),
        ('dyntype="filterexact"', {"physics.step_s": 0.05}, 0.05),
        ('dyntype="filterexact"', {"physics.step_s": 0.06, "physics.integrator": "Euler"}, 0.06),
        ('dynprm="0.15"', {"physics.step_s": 0.02}, 0.04),
    ],
)
def test_no_healthy_thruster_is_doubted(tmp_path, motor, physics, period_s):
    """Lags and delays in whole steps and between them, steps of up to 2.5 lags, several steps a period."""
    class_line = 'dyntype="filter" dynprm="0.02"'
    name = motor.partition("=")[0]
    kept = " ".join(word for word in class_line.split() if name != word.partition("=")[0])
    text = edited_text((class_line, f"{kept} {motor}"))
    (tmp_path / "cube.xml").write_text(text)
    changes = {
        "model": str(tmp_path / "cube.xml"),
        "duration_s": 8,
        "control_period_s": period_s,
        "checks": [{"kind": "allowed_forces"}],
        **physics,
    }
    run = cube_sim.run(HELIX, changes, out=tmp_path / "run")
    assert (run.signals["health.believed"][:, 1:] == 1.0).all()
    assert doubts(run) == []
    thrusters = cube_sim.Vehicle.from_model(cube_sim.load_model(tmp_path / "cube.xml")).thrusters
    asked, sent = run.signals["thrusters.force_demanded"][:, 1:], run.signals["thrusters.command"][:, 1:]
    for force, commands in zip(asked, sent, strict=True):
        np.testing.assert_allclose(commands, thrusters.command(force), atol=1e-12)  # nobody was probed
