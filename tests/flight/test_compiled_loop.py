"""The compiled loop against the loop in Python: the same bits and sentences, for every scenario there is."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.places import HELIX, SCENARIO_FILES, SCENARIOS

from cube_sim.flight import Flight, loop
from cube_sim.flight.compiled.loop import fly
from cube_sim.scenario import load

CHECKS = [{"kind": "allowed_forces"}]
COMPILED = {
    "bluerov2_arm",
    "bluerov2_battery",
    "bluerov2_free",
    "bluerov2_gust",
    "bluerov2_tide",
    "bluerov2_vectored_helix",
    "bluerov2_vectored_hover",
    "bluerov2_vectored_line",
    "cube_free",
    "cube_helix",
    "cube_hover",
    "cube_look_at",
    "cube_lose_one",
    "cube_navigated",
    "cube_sensor_faults",
    "cube_waypoints",
    "cube_survival",
    "cube_track",
    "infante_circle",
    "infante_circle_current",
    "infante_line",
    "infante_line_current",
    "infante_sinusoid",
    "infante_spline",
    "jack_compensation",
    "jack_contraction",
    "jack_exact",
    "rov6_helix",
    "torpedo_helix",
    "torpedo_line",
}
"""Scenarios whose ticks are nearly all of them flown by compiled code."""


@pytest.mark.flight
@pytest.mark.parametrize("path", SCENARIO_FILES, ids=lambda path: path.stem)
def test_both_loops_fly_the_same(path, monkeypatch):
    events = [event.model_dump(exclude_none=True) for event in load(path).scenario.events]
    for k, event in enumerate(events):
        event["at_s"] = 1.0 + 0.5 * k
    share = assert_same_flight(path, {"duration_s": 6.0, "checks": CHECKS, "events": events}, monkeypatch)
    if path.stem in COMPILED:
        assert share > 0.7


@pytest.mark.flight
@pytest.mark.parametrize(
    "settings",
    [
        {"events": [{"kind": "thrusters", "at_s": 1.01, "thrusters": ["T1"], "state": "stuck", "force_N": 51.0}]},
        {"control_period_s": 0.1, "current_m_s": [0.0, 0.9, 0.0]},
        {"initial.position_m": [0.0, 0.0, -0.3], "current_m_s": [0.2, 0.0, 0.0]},
        {"allocation.method": "search", "guidance.speed_m_s": 2.0},
        {
            "control.safe_mode": {"action": "hold", "distance_limit_m": 0.5, "patience_s": 0.5},
            "guidance.speed_m_s": 3.0,
        },
    ],
    ids=["stuck", "slow_in_current", "at_the_surface", "too_fast", "lost"],
)
def test_both_loops_go_through_the_same_trouble(settings, monkeypatch):
    assert_same_flight(HELIX, {"duration_s": 12.0, "checks": CHECKS, **settings}, monkeypatch)


@pytest.mark.flight
@pytest.mark.parametrize(
    "settings",
    [
        {"battery.charge": 0.2, "battery.capacity_Wh": 1.0},
        {"events": [{"kind": "thrusters", "at_s": 3.0, "thrusters": ["T2"], "state": "dead"}]},
    ],
    ids=["empty", "fault"],
)
def test_both_loops_run_on_a_battery_the_same(settings, monkeypatch):
    scenario = SCENARIOS / "bluerov2_battery.yaml"
    assert assert_same_flight(scenario, {"duration_s": 10.0, "checks": CHECKS, **settings}, monkeypatch) > 0.1


@pytest.mark.flight
@pytest.mark.parametrize(
    "settings",
    [
        {"seed": 3, "events": [{"kind": "thrusters", "at_s": 3.0, "thrusters": ["T2"], "state": "dead"}]},
        {"control.safe_mode.distance_limit_m": 0.4, "control.safe_mode.patience_s": 0.5, "guidance.speed_m_s": 3.0},
        {"navigation.initial.position_m": 1.5, "navigation.position.delay_s": 2.0},
    ],
    ids=["fault", "lost", "late_and_wrong"],
)
def test_both_loops_navigate_the_same(settings, monkeypatch):
    scenario = SCENARIOS / "cube_navigated.yaml"
    assert assert_same_flight(scenario, {"duration_s": 12.0, "checks": CHECKS, **settings}, monkeypatch) > 0.3


@pytest.mark.flight
def test_both_loops_wish_for_the_same_trims(monkeypatch):
    """A current turns the course through the water, so that trims are looked for more than once."""
    lost = {"kind": "thrusters", "at_s": 1.0, "thrusters": ["T5"], "state": "dead"}
    path = {"type": "circle", "centre_m": [0.0, 2.0, -5.0], "radius_m": 2.0}
    settings = {"path": path, "events": [lost], "guidance.speed_m_s": 0.7, "current_m_s": [0.2, 0.0, 0.0]}
    scenario = SCENARIOS / "bluerov2_vectored_line.yaml"
    assert assert_same_flight(scenario, {"duration_s": 25.0, "checks": CHECKS, **settings}, monkeypatch) > 0.7


FAULT = {"kind": "thrusters", "at_s": 3.0, "thrusters": ["T1"]}


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("circle_current", {"events": [{**FAULT, "state": "dead"}]}),
        ("circle_current", {"events": [{**FAULT, "state": "weak", "efficiency": 0.4}], "control.faults": "told"}),
        ("sinusoid", {"guidance.speed_m_s": 4.0}),
        ("spline", {"guidance.speed_m_s": 6.0, "guidance.target_speed_limit_m_s": 3.0}),
        ("line_current", {"path.end_m": [8.0, 0.0, -5.0]}),
        ("circle", {"control.disturbance_time_s": None, "control.current_time_s": None}),
    ],
    ids=["dead", "weak", "too_fast", "slowed", "beyond_its_end", "as_published"],
)
def test_both_loops_steer_in_plane_the_same(name, settings, monkeypatch):
    scenario = SCENARIOS / f"infante_{name}.yaml"
    assert assert_same_flight(scenario, {"duration_s": 12.0, "checks": CHECKS, **settings}, monkeypatch) > 0.3


@pytest.mark.flight
@pytest.mark.parametrize(
    ("telemetry", "events", "least"),
    [
        ({"noise_N": 2.0}, [], 0.9),
        ({"noise_N": 1.0, "gain": 1.08, "gain_tolerance": 0.1}, [{**FAULT, "state": "dead"}], 0.5),
        ({"noise_N": 6.0, "gain_tolerance": 0.05}, [{**FAULT, "state": "stuck", "force_N": 20.0}], 0.5),
        ({"gain": 0.93, "gain_tolerance": 0.1}, [{**FAULT, "state": "weak", "efficiency": 0.5}], 0.5),
    ],
    ids=["noise", "dead", "stuck", "weak"],
)
def test_both_loops_read_the_same_telemetry(telemetry, events, least, monkeypatch):
    settings = {"duration_s": 12.0, "checks": CHECKS, "events": events}
    settings |= {f"telemetry.{key}": value for key, value in telemetry.items()}
    assert assert_same_flight(HELIX, settings, monkeypatch) > least


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "thruster", "force_N", "settings"),
    [
        ("cube_helix", "T1", 20.0, {"current_m_s": [0.0, 0.2, 0.0]}),
        ("cube_helix", "T1", -35.0, {"control.priority": "path"}),
        ("bluerov2_vectored_helix", "T1", 10.0, {}),
        ("bluerov2_battery", "T1", 15.0, {"battery.charge": 0.2, "battery.capacity_Wh": 60.0}),
        ("cube_look_at", "T1", 51.0, {}),
        ("cube_helix", "T1", 51.0, {"duration_s": 18.0, "current_m_s": [0.0, 0.7, 0.0]}),
        ("cube_helix", "T7", 36.0, {"duration_s": 18.0, "current_m_s": [0.0, 0.7, 0.0]}),
    ],
    ids=["any_motion", "path_first", "at_trim", "low_battery", "in_refuge", "to_another_refuge", "back_from_refuge"],
)
def test_both_loops_serve_the_force_first_alike(name, thruster, force_N, settings, monkeypatch):
    settings = {"duration_s": 12.0, "checks": CHECKS, "control.faults": "told", **settings}
    stuck = {"kind": "thrusters", "at_s": 1.0, "thrusters": [thruster], "state": "stuck", "force_N": force_N}
    assert assert_same_flight(SCENARIOS / f"{name}.yaml", settings | {"events": [stuck]}, monkeypatch) > 0.8


@pytest.mark.flight
@pytest.mark.parametrize(
    ("scenario", "settings"),
    [
        (HELIX, {"allocation.change_limit_N": 3.0}),
        (HELIX, {"allocation.change_limit_N": 0.2, "allocation.method": "search", "guidance.speed_m_s": 1.0}),
        (
            HELIX,
            {"allocation.change_limit_N": 1.0, "allocation.allow_off": False, "events": [{**FAULT, "state": "dead"}]},
        ),
        (SCENARIOS / "bluerov2_battery.yaml", {"allocation.change_limit_N": 1.0, "current_m_s": [0.0, 0.6, 0.0]}),
    ],
    ids=["wide", "narrow", "fault", "battery"],
)
def test_both_loops_allocate_under_a_change_limit_the_same(scenario, settings, monkeypatch):
    assert assert_same_flight(scenario, {"duration_s": 8.0, "checks": CHECKS, **settings}, monkeypatch) > 0.5


@pytest.mark.flight
@pytest.mark.parametrize("method", ["contraction", "compensation", "pseudo_inverse", "clipped_pseudo_inverse"])
@pytest.mark.parametrize("allow_off", [False, True])
def test_both_loops_allocate_by_a_baseline_the_same(method, allow_off, monkeypatch):
    events = [{**FAULT, "state": "dead"}] if allow_off else []
    settings = {"allocation.method": method, "allocation.allow_off": allow_off, "events": events}
    assert assert_same_flight(HELIX, {"duration_s": 8.0, "checks": CHECKS, **settings}, monkeypatch) > 0.5


@pytest.mark.flight
def test_one_machine_code_flies_either_law_by_any_allocation():
    for name in ("cube_helix", "infante_spline", "bluerov2_free", "jack_contraction"):
        Flight(SCENARIOS / f"{name}.yaml").fly(5)
    Flight(HELIX, {"allocation.change_limit_N": 3.0}).fly(5)
    assert len(fly.forms) == 1


@pytest.mark.flight
@pytest.mark.parametrize("name", ["cube_lose_one", "cube_navigated", "infante_circle_current", "torpedo_helix"])
def test_a_snapshot_between_compiled_stretches_is_taken_up_to_the_bit(name):
    settings = {"duration_s": 5.0, "checks": CHECKS, "events": [], "telemetry.noise_N": 1.0}
    if name == "cube_lose_one":
        settings["events"] = [{"kind": "thrusters", "at_s": 1.5, "thrusters": ["T1"], "state": "dead"}]
    one, other = (Flight(SCENARIOS / f"{name}.yaml", settings) for _ in range(2))
    while one.time_s < 3.0:
        one.fly(37)
    middle, since = one.snapshot(), one.time_s - 1e-9
    one.fly_to_its_end()
    other.restore(middle)
    other.fly_to_its_end()
    for name, rows in one.signals.items():
        late, again = rows[rows[:, 0] > since], other.signals[name]
        if name.startswith("path.") or name.startswith("actuation."):
            continue  # told at the beginning
        assert late.tobytes() == again[again[:, 0] > since].tobytes(), name


def without_a_state(mission):
    mission.data.qvel[:] = np.nan


def without_an_answer(mission):
    mission.controller.observer.memory["estimate"] = np.nan


def without_an_answer_in_plane(mission):
    mission.controller.observer.parts.unexplained["w"] = np.nan


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "broken"),
    [
        ("cube_helix", without_a_state),
        ("cube_helix", without_an_answer),
        ("infante_circle", without_a_state),
        ("infante_circle", without_an_answer_in_plane),
    ],
)
def test_both_loops_end_alike_when_something_is_no_number(name, broken, monkeypatch):
    settings = {"duration_s": 3.0, "checks": CHECKS}
    ended = []
    for compiled in (True, False):
        one = Flight(SCENARIOS / f"{name}.yaml", settings)
        if not compiled:
            monkeypatch.setattr(loop, "begin_ticks", lambda *_: None)
        while not one.over:
            if one.tick == 50:
                broken(one.mission)
            one.fly(10)
        one.finish()
        ended.append((one.tick, one.ended, one.log, {name: rows.tobytes() for name, rows in one.signals.items()}))
    assert ended[0] == ended[1]
    assert "not a number" in ended[0][1]
