"""Drawn torpedoes and REMUS 100 keep paths in currents, known wrongly too, and stop without turning away."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.drawn_torpedo import drawn_torpedo
from support.places import SCENARIOS

import cube_sim

LINE = SCENARIOS / "remus100_line.yaml"
FORCES = [{"kind": "allowed_forces"}]


def changes_of(seed, tmp_path, current, helix=False, **more):
    """What makes the line's scenario fly a drawn torpedo, in a current by shares of its speed; its length [m]."""
    drawn = drawn_torpedo(seed)
    L, u = drawn.length_m, drawn.speed_m_s
    (tmp_path / "drawn.xml").write_text(drawn.text)
    path = {"type": "line", "start_m": [0, 0, -60], "end_m": [400 * L, 0, -60]}
    start = {"position_m": [0.0, L, -60.0], "velocity_m_s": [u, 0.0, 0.0]}
    if helix:
        path = {"type": "helix", "centre_m": [0, 0, -60], "radius_m": 6 * L, "pitch_m": -2 * L, "turns": 10}
        start = {"position_m": [6 * L, 0.0, -60.0], "velocity_m_s": [u, 0.0, 0.0], "attitude_deg": [0.0, 0.0, 90.0]}
    return {
        "model": str(tmp_path / "drawn.xml"),
        "parameters": {},
        "duration_s": round(60 * L / u + 20, 1),
        "initial": start,
        "path": path,
        "guidance": {"speed_m_s": u, "stop_at_end": False},
        "current_m_s": [share * u for share in current],
        "control.safe_mode.distance_limit_m": None,
        "checks": FORCES,
        **more,
    }, L


def error_at_last(run):
    """RMS of the cross-track error over the second half of a flight [m]."""
    error = run.signals["path_error.cross_track"][:, 1]
    return float(np.sqrt(np.mean(error[len(error) // 2 :] ** 2)))


@pytest.mark.flight
@pytest.mark.parametrize(
    "current", [(0.0, 0.0, 0.0), (0.0, 0.3, 0.0), (-0.3, 0.0, 0.0)], ids=["still", "across", "against"]
)
@pytest.mark.parametrize("seed", [1, 3, 5, 7])
def test_drawn_torpedoes_keep_a_line(seed, current, tmp_path):
    """The nose along the velocity through the water; with thrust pointed two of them left the line in still water."""
    changes, L = changes_of(seed, tmp_path, current)
    assert error_at_last(cube_sim.run(LINE, changes, out=tmp_path / "out")) < 0.01 * L


@pytest.mark.flight
@pytest.mark.parametrize("seed", [5, 7])
def test_begun_with_a_slip_of_half_a_radian_they_come_back(seed, tmp_path):
    changes, L = changes_of(seed, tmp_path, (0.0, 0.5, 0.0))
    assert error_at_last(cube_sim.run(LINE, changes, out=tmp_path / "out")) < 0.02 * L


@pytest.mark.flight
@pytest.mark.parametrize("key", ["drag", "added_mass", "fins", "thrust"])
@pytest.mark.parametrize("factor", [0.7, 1.3])
def test_wrong_knowledge_is_learned_of_by_the_course(key, factor, tmp_path):
    """A slip that is reckoned wrongly would leave the hull beside its helix: by 0.06 of its length."""
    changes, L = changes_of(3, tmp_path, (0.0, 0.0, 0.0), helix=True, **{f"knowledge.{key}": factor})
    assert error_at_last(cube_sim.run(LINE, changes, out=tmp_path / "out")) < 0.005 * L


@pytest.mark.flight
@pytest.mark.parametrize("current", [(0.0, 0.0, 0.0), (0.0, 0.2, 0.0)])
def test_at_the_end_of_its_path_it_glides_on_without_turning_away(current, tmp_path):
    path = {"type": "line", "start_m": [0, 0, -10], "end_m": [40, 0, -10]}
    changes = {"path": path, "current_m_s": list(current), "duration_s": 70, "checks": FORCES}
    run = cube_sim.run(LINE, changes, out=tmp_path / "out")
    w, x, y, z = run.signals["pose.quaternion"][2500:, 1:].T
    heading = np.degrees(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
    assert np.ptp(heading) < 30.0
    assert run.signals["pose.position"][:, 1].max() < 60.0


@pytest.mark.parametrize("navigated", [False, True])
def test_both_loops_keep_a_course_alike(navigated, tmp_path, monkeypatch):
    more = {"navigation": {}} if navigated else {}
    changes, _ = changes_of(5, tmp_path, (0.1, 0.3, 0.0), helix=True, **more)
    assert assert_same_flight(LINE, {**changes, "duration_s": 4}, monkeypatch) > 0.9
