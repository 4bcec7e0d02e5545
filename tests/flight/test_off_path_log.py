"""What a run says of a vehicle that stays off its path: once for each spell, whatever the cause."""

from __future__ import annotations

import numpy as np
import pytest
from support.flights import FORCES_ONLY, thruster_event
from support.places import MODELS

import cube_sim
from cube_sim.control.authority import Authority
from cube_sim.flight.off_path_log import BACK_S, OFF_M, PATIENCE_S, OffPathLog
from cube_sim.flight.rows import rows_for
from cube_sim.recording.channels import channel_table
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_conditions import OFF_PATH

DT = 0.1
CHANNELS = channel_table(("bow", "side"), 2)


def flown(off_m, *, along_m=0.0, remaining_m=10.0, authority=Authority.HOLONOMIC):
    rows = rows_for(CHANNELS, len(off_m))
    rows.path_error[:], rows.target[:], rows.health[:] = 0.0, 0.0, 1.0
    rows.path_error[:, 4], rows.path_error[:, 1], rows.target[:, 2] = off_m, along_m, remaining_m
    rows.health[:, -1] = authority
    return rows


def told(rows, at_once=True):
    store, n = SignalStore(CHANNELS), len(rows.target)
    log, times = OffPathLog(store), [k * DT for k in range(n)]
    if at_once:
        log.note_all(times, rows, 0, n)
    for k in () if at_once else range(n):
        log.note(times[k], rows, k)
    return [(line.t, line.level, line.text) for line in store.lines]


def seconds(*parts):
    """(value, seconds) one after the other."""
    return np.concatenate([np.full(round(time / DT), value) for value, time in parts])


@pytest.mark.parametrize("at_once", [True, False])
def test_a_spell_is_told_once_with_how_far_and_since_when_and_its_end(at_once):
    rows = flown(seconds((0.0, 10.0), (3.2, 60.0), (0.1, 20.0), (0.8, 30.0)))
    first, back, second = told(rows, at_once)
    assert first[:2] == (pytest.approx(10.0 + PATIENCE_S), "WARNING")
    assert first[2] == f"{OFF_PATH.begins}3.2 m from it, farther than 0.5 m since 10.00 s, and comes no nearer"
    assert back == (pytest.approx(70.0 + BACK_S, abs=2 * DT), "INFO", OFF_PATH.ends)
    assert second[0] == pytest.approx(90.0 + PATIENCE_S)


def test_one_that_comes_nearer_or_is_off_for_a_while_is_no_news():
    assert told(flown(np.linspace(25.0, 0.0, 1200))) == []
    assert told(flown(seconds((0.0, 5.0), (2.0, 0.9 * PATIENCE_S), (0.0, 60.0)))) == []
    assert told(flown(seconds((0.9 * OFF_M, 90.0)))) == []


def test_one_that_is_carried_off_and_comes_back_is_no_news_unless_it_stays():
    away, back = np.linspace(0.0, 4.0, 100), np.linspace(4.0, 2.0, 200)
    assert told(flown(np.concatenate([away, back, np.linspace(2.0, 0.0, 300)]))) == []
    ((t, _, _),) = told(flown(np.concatenate([away, back, np.full(300, 2.0)])))
    assert 30.0 < t < 45.0


def test_one_that_swings_about_its_path_stays_off_it():
    swings = np.abs(1.5 * np.sin(np.arange(0.0, 60.0, DT)))
    ((t, _, text),) = told(flown(swings))
    assert t < 2.0 * PATIENCE_S
    assert "farther than 0.5 m since 0.40 s" in text


def test_a_path_given_up_is_the_message_of_another():
    assert told(flown(seconds((5.0, 90.0)), authority=Authority.SAFE)) == []


def test_to_be_late_is_not_to_be_off_the_path_but_to_be_away_from_a_point_is():
    assert told(flown(np.zeros(600), along_m=-5.0)) == []
    ((_, level, text),) = told(flown(np.zeros(600), along_m=-5.0, remaining_m=0.0))
    assert level == "WARNING"
    assert "5 m from it" in text


@pytest.mark.flight
def test_a_flight_without_thrust_across_a_current_says_so_once():
    """Told of nothing, the law gives no path up within its limit."""
    scenario = {
        "schema_version": 1,
        "name": "off",
        "model": str(MODELS / "cube.xml"),
        "duration_s": 40.0,
        "path": {"type": "line", "start_m": [0.0, 0.0, -20.0], "end_m": [60.0, 0.0, -20.0]},
        "initial": {"position_m": [0.0, 0.0, -20.0]},
        "guidance": {"speed_m_s": 0.3},
        "control": {"faults": "ignored", "safe_mode": {"distance_limit_m": None}},
        "current_m_s": [0.0, 0.2, 0.0],
        "events": [thruster_event(5.0, [f"T{k}" for k in range(1, 9)], "dead")],
        "checks": FORCES_ONLY,
    }
    (run,) = cube_sim.fly_many(scenario, [{}], signals=["path_error.cross_track"])
    said = [line for line in run.log if line.text.startswith(OFF_PATH.begins)]
    assert [line.level for line in said] == ["WARNING"]
    off = run.signals["path_error.cross_track"]
    since = float(off[np.argmax(off[:, 1] >= OFF_M), 0])
    assert f"since {since:.2f} s" in said[0].text
