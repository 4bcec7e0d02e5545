"""Six thrusters that cannot pitch, and gusts: what the water holds is left to it, in flight."""

from __future__ import annotations

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.catalogue.wrong import thrusters_moved
from support.flights import FORCES_ONLY, values
from support.places import SCENARIOS
from support.vehicles import vehicle

import cube_sim
from cube_sim.control.authority import Authority

pytestmark = pytest.mark.flight

GUST = SCENARIOS / "bluerov2_gust.yaml"
LIMITS = {"line": 0.01, "hover": 0.01, "helix": 0.02}
"""Cross-track RMS from 40 s on [m] of the vehicle as drawn."""

VERTICALS = [{f"T{i}": (x, 0.0, 0.0) for i in (5, 6)} for x in (0.002, -0.002, 0.005, -0.005, 0.02, -0.02, 0.05, -0.05)]
HORIZONTALS = [{f"T{i}": (0.0, 0.0, z) for i in (1, 2, 3, 4)} for z in (0.072, -0.072)]
QUICK = [("line", VERTICALS[6]), ("hover", VERTICALS[5]), ("helix", HORIZONTALS[0])]
EVERY = [(path, off) for path in LIMITS for off in VERTICALS + HORIZONTALS if (path, off) not in QUICK]


def as_words(value):
    return "_".join(f"{1e3 * x:+.0f}mm" for x in next(iter(value.values())) if x) if isinstance(value, dict) else value


def rms_with(off, path, folder):
    """Cross-track RMS from 40 s on [m] of the six-thruster BlueROV2 with its thrusters elsewhere."""
    (folder / "hull.xml").write_text(thrusters_moved(catalogue()["bluerov2_vectored"].make(), off))
    changes = {"model": str(folder / "hull.xml"), "checks": FORCES_ONLY}
    run = cube_sim.run(SCENARIOS / f"bluerov2_vectored_{path}.yaml", changes, out=folder / "run")
    assert run.verdict == "PASS"
    assert Authority.SAFE not in run.signals["health.authority"][:, 1]
    rows = run.signals["path_error.cross_track"]
    return float(np.sqrt(np.mean(rows[rows[:, 0] >= 40.0, 1] ** 2)))


@pytest.mark.parametrize(("path", "off"), QUICK, ids=as_words)
def test_thrusters_elsewhere_do_not_change_who_flies(path, off, tmp_path):
    """Verticals ahead or astern of the middle push and pitch, horizontals above or below it push and pitch."""
    assert rms_with(off, path, tmp_path) < 2.0 * LIMITS[path]


@pytest.mark.campaign
@pytest.mark.parametrize(("path", "off"), EVERY, ids=as_words)
def test_nor_do_thrusters_anywhere_else(path, off, tmp_path):
    assert rms_with(off, path, tmp_path) < 2.0 * LIMITS[path]


def farthest(run):
    """Largest distance from the held point [m]."""
    signals = values(run)
    return float(np.hypot(signals["path_error.along"], signals["path_error.cross_track"]).max())


def power_while_carried_off(run, at_s):
    """Mean power [W] of the thrusters' force over each second that lies between a gust and the farthest point after."""
    signals = values(run)
    A = vehicle("bluerov2_heavy").actuation_matrix
    power = np.sum(signals["thrusters.force"] @ A[:3].T * signals["velocity.linear"], axis=1)
    away = np.hypot(signals["path_error.along"], signals["path_error.cross_track"])[:, 0]
    first = round(at_s / 0.02)
    last = max(first + int(np.argmax(away[first : first + 500])), first + 50)
    return np.convolve(power[first:last], np.full(50, 0.02), "valid")


GUSTS = [
    ({}, 0.20),
    ({"events": [{"kind": "current", "at_s": 20, "current_m_s": [0.7, 0.0, 0.0]}], "duration_s": 50}, 0.45),
]


@pytest.mark.parametrize(("changes", "limit"), GUSTS, ids=["0.3 m/s and back", "0.7 m/s"])
def test_a_gust_moves_a_hull_no_farther_than_it_must(changes, limit, tmp_path):
    run = cube_sim.run(GUST, {"checks": FORCES_ONLY, **changes}, out=tmp_path / "run")
    assert farthest(run) < limit
    assert np.abs(values(run)["path_error.along"][-250:]).max() < 0.02  # and it comes back
    for at_s in (20.0, 50.0) if not changes else (20.0,):
        assert power_while_carried_off(run, at_s).max() < 0.0  # the thrusters fight the drift, they never feed it
