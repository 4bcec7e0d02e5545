"""Hulls turned away by their flow, farther than their fins stop: they lose their way, begin anew and come back."""

from __future__ import annotations

import pytest
from support.both_loops import assert_same_flight
from support.drawn_torpedo import drawn_torpedo
from support.finned import x_tail
from support.places import SCENARIOS

from cube_sim.flight import Flight

FORCES = [{"kind": "allowed_forces"}]


def changes_of(text, speed, tmp_path, **more):
    """What makes the line of REMUS 100 that of a drawn model, far from the surface and with no limit of distance."""
    (tmp_path / "drawn.xml").write_text(text)
    return {
        "model": str(tmp_path / "drawn.xml"),
        "parameters": {},
        "duration_s": 120,
        "initial": {"position_m": [0.0, 0.5, -60.0], "velocity_m_s": [speed, 0.0, 0.0]},
        "path": {"type": "line", "start_m": [0, 0, -60], "end_m": [1000, 0, -60]},
        "guidance": {"speed_m_s": speed, "stop_at_end": False},
        "control": {"faults": "ignored", "safe_mode": {"distance_limit_m": None}},
        "checks": FORCES,
        **more,
    }


def loose_until(t):
    rudder = {"kind": "fins", "fins": ["rudder"]}
    return [{**rudder, "at_s": 6.0, "state": "loose"}, {**rudder, "at_s": t, "state": "recovered"}]


def flown(changes):
    flight = Flight(SCENARIOS / "remus100_line.yaml", changes)
    flight.fly_to_its_end()
    return flight


def lost_way(flight):
    """Whether it is to lose its way, every fifth of a second of a flight to its end."""
    while not flight.over:
        flight.fly(10)
        yield flight.mission.controller.course["turned_away"][0]


def error_at_last(flight):
    return flight.signals["path_error.cross_track"][-250:, 1].max()


@pytest.mark.flight
@pytest.mark.parametrize(("drawn", "until"), [(True, 12.0), (True, 18.0), (False, 18.0)])
def test_a_rudder_that_was_loose_leaves_no_circles(drawn, until, tmp_path):
    """Untold. Thrust kept it in circles for ever, the rudder stalled, the unknown force taken for a current."""
    torpedo = drawn_torpedo(3)
    told = (torpedo.text, torpedo.speed_m_s) if drawn else (x_tail(0.01, makes_roll=False), 1.2)
    flight = flown(changes_of(*told, tmp_path, events=loose_until(until)))
    assert flight.signals["path_error.cross_track"][:, 1].max() > 3.0
    assert error_at_last(flight) < 0.02


@pytest.mark.flight
@pytest.mark.parametrize("seed", [2, 4])
def test_a_current_that_hits_the_smallest_fins_at_once_does_not_lose_them(seed, tmp_path):
    torpedo = drawn_torpedo(seed)
    current = [0.0, 0.3 * torpedo.speed_m_s, 0.0]
    changes = changes_of(torpedo.text, torpedo.speed_m_s, tmp_path, current_m_s=current, duration_s=180)
    assert error_at_last(flown(changes)) < 0.02 * torpedo.length_m


def test_both_loops_lose_way_alike(tmp_path, monkeypatch):
    torpedo = drawn_torpedo(2)
    current = [0.0, 0.3 * torpedo.speed_m_s, 0.0]
    changes = changes_of(torpedo.text, torpedo.speed_m_s, tmp_path, current_m_s=current, duration_s=5)
    assert assert_same_flight(SCENARIOS / "remus100_line.yaml", changes, monkeypatch) > 0.9
    assert any(lost_way(Flight(SCENARIOS / "remus100_line.yaml", changes)))


@pytest.mark.flight
@pytest.mark.parametrize("name", ["remus100_survey", "nps_auv2_survey"])
def test_hulls_that_their_fins_hold_keep_their_way(name):
    """In corners in a current across."""
    flight = Flight(SCENARIOS / f"{name}.yaml", {"duration_s": 150, "checks": FORCES})
    assert not any(lost_way(flight))
