"""What the campaign of missions draws is what it says, and what it judges is judged right."""

from __future__ import annotations

import numpy as np
import pytest
from flights import tables
from flights.ability import ability_of
from flights.forecast import forecast
from flights.judging import judged
from flights.mission import JUDGED_S, RECOVERY_S, written
from flights.paths import PATHS, drawn_path
from flights.plan import INGREDIENTS, KINDS, drawn_plan
from flights.sweep import verdicts
from flights.workers import in_processes
from scipy.spatial.transform import Rotation
from support.places import MODELS

from cube_sim.mission.path import path_of
from cube_sim.scenario import load


def test_a_seed_is_a_mission_whatever_is_flown_beside_it(tmp_path):
    some = [drawn_plan(seed) for seed in range(300)]
    assert some == [drawn_plan(seed) for seed in range(300)]
    assert {plan.kind for plan in some} == set(KINDS)
    assert {plan.path for plan in some} == set(PATHS)
    assert {name for plan in some for name in plan.ingredients} == set(INGREDIENTS)
    assert len({plan.vehicle for plan in some}) > 60
    texts = []
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        written(some[9], tmp_path / folder)
        texts.append({file.name: file.read_text() for file in (tmp_path / folder).iterdir()})
    assert texts[0] == texts[1]


@pytest.mark.parametrize("seed", range(24))
def test_a_mission_is_a_scenario_that_may_be_flown(seed, tmp_path):
    mission = written(drawn_plan(seed), tmp_path)
    scenario = load(tmp_path / "mission.yaml").scenario
    assert scenario.duration_s >= mission.from_s + JUDGED_S - 1.0
    assert scenario.path.type == mission.plan.path
    for event in scenario.events:
        if event.at_s > 0.0:
            assert mission.from_s >= event.at_s + RECOVERY_S
    assert (scenario.navigation is not None) == ("navigation" in mission.plan.ingredients)
    assert bool(mission.stuck or mission.weak) <= ("fault" in mission.plan.ingredients)
    current = np.linalg.norm(scenario.current_m_s)
    assert mission.through_water_m_s >= min(current, 0.35) / 1.01


@pytest.mark.parametrize("kind", [kind for kind in PATHS if kind != "point"])
def test_a_path_is_as_long_as_asked_and_starts_where_it_says(kind, tmp_path):
    (tmp_path / "cube.xml").write_text((MODELS / "cube.xml").read_text())
    for seed in range(3):
        block, start, heading, table = drawn_path(np.random.default_rng(seed), kind, 60.0, 3.0, 0.2)
        if table:
            (tmp_path / "path.csv").write_text(table)
        scenario = {"schema_version": 1, "name": "x", "model": "cube.xml", "duration_s": 10, "path": block}
        scenario |= {"guidance": {"speed_m_s": 0.3}, "checks": [{"kind": "allowed_forces"}]}
        (tmp_path / "x.yaml").write_text(repr(scenario).replace("'", '"'))
        path = path_of(load(tmp_path / "x.yaml"))
        first = path.at(0.0)
        np.testing.assert_allclose(first.position, start, atol=1e-6)
        if kind not in ("spline", "csv"):  # a spline's own ends decide its first tangent
            ahead = first.rotation[:2, 0] / np.linalg.norm(first.rotation[:2, 0])
            np.testing.assert_allclose(ahead, (np.cos(heading), np.sin(heading)), atol=1e-3)
        if kind != "circle":
            assert path.length >= 0.9 * 60.0
        assert start[2] < -5.0
        places = np.array([path.at(s).position for s in np.linspace(0.0, path.length, 4001)])
        assert np.max(places[:, 2]) < -1.0
        if kind not in ("spline", "csv"):
            tangents = np.diff(places, axis=0)
            lengths = np.linalg.norm(tangents, axis=1)
            turns = np.linalg.norm(np.diff(tangents / lengths[:, None], axis=0), axis=1)
            assert np.max(turns / lengths[1:]) <= 1.02 / 3.0


def test_abilities_of_vehicles_that_are_known(tmp_path):
    cube = ability_of(MODELS / "cube.xml", (), False)
    assert cube.full
    assert cube.stands
    heavy = ability_of(MODELS / "bluerov2_heavy.xml", (), False)
    force = 13.7 * heavy.top_m_s + 141.0 * heavy.top_m_s**2  # its table's drag ahead
    assert force == pytest.approx(0.6 * np.sqrt(0.5) * 2.0 * (51.44 + 39.91))
    no_heave = ability_of(MODELS / "bluerov2_heavy.xml", ("T5", "T6", "T7", "T8"), False)
    assert not no_heave.stands
    assert ability_of(MODELS / "jack.xml", (), True).stands
    assert not ability_of(MODELS / "infante.xml", (), True).stands
    assert cube.converges_s == 0.0
    assert ability_of(MODELS / "torpedo.xml", ("rudder",), False).converges_s == 0.0
    assert 40.0 < ability_of(MODELS / "torpedo.xml", (), False).converges_s < 60.0


def test_a_long_hull_that_steers_by_its_heading_is_judged_once_it_can_be_there(tmp_path):
    """The same mission as if it were judged earlier, but for its end."""
    mission = written(drawn_plan(828), tmp_path)
    assert mission.plan.vehicle == "torpedo_fins"
    able = ability_of(tmp_path / "model.xml", (), False)
    assert mission.from_s == able.converges_s > 50.0
    assert mission.scenario["duration_s"] == pytest.approx(mission.from_s + JUDGED_S, abs=0.5)


def asked(model, **changes):
    kinds = {"lost": (), "weak": {}, "stuck": {}, "speed_m_s": 0.3, "planar": False}
    return forecast(model, **(kinds | changes)).flies


def test_the_forecast_is_the_analysis_and_knows_weak_and_stuck_thrusters(tmp_path):
    model = tmp_path / "cube.xml"
    model.write_text((MODELS / "cube.xml").read_text())
    assert asked(model)
    assert not asked(model, lost=("T1", "T2", "T3", "T4", "T5"))
    assert not asked(model, speed_m_s=5.0)
    assert asked(model, weak={"T1": 0.5})
    assert not asked(model, weak={f"T{i}": 0.02 for i in range(1, 9)})
    assert asked(model, stuck={"T1": 10.0})
    assert not asked(model, stuck={"T1": 51.0, "T2": 51.0})


def flight(
    error_m=0.0,
    *,
    to_s=100.0,
    from_s=60.0,
    speed=0.5,
    believed=1.0,
    authority=0,
    planar=None,
    lateral=(0, 0),
    **scenario,
):
    """Signals of a flight of two thrusters whose cross-track error is a function of the time."""
    t = np.arange(0.0, to_s + 1e-9, 0.1)[:, None]
    n = len(t)
    error = np.vectorize(error_m, otypes=[float])(t) if callable(error_m) else np.full((n, 1), float(error_m))
    columns = {
        "pose.position": np.zeros((n, 3)),
        "path_error.cross_track": error,
        "path_error.along": np.zeros((n, 1)),
        "path_error.attitude": np.zeros((n, 1)),
        "target.arc_length": speed * t,
        "target.remaining": np.full((n, 1), 50.0),
        "health.believed": np.column_stack([np.ones(n), np.where(t[:, 0] > 30.0, believed, 1.0)]),
        "health.efficiency": np.ones((n, 2)),
        "health.authority": np.full((n, 1), authority),
        "allocation.status": np.zeros((n, 1)),
    }
    asked_for = {"duration_s": 100.0, "path": {"type": "line"}, "guidance": {"speed_m_s": 0.5}} | scenario
    if planar is not None:
        columns |= {"target.quaternion": np.tile(planar, (n, 1)), "path_error.lateral": np.tile(lateral, (n, 1))}
    signals = {name: np.hstack([t, rows]) for name, rows in columns.items()}
    return judged(signals, asked_for, from_s, planar is not None)


@pytest.mark.parametrize(
    ("found", "cause"),
    [
        (flight(0.049), ""),
        (flight(lambda t: 3.0 if t < 60.0 else 0.0), ""),
        (flight(0.051), "standing error"),
        (flight(0.3, to_s=50.0), "ended early, at 50 s"),
        (flight(0.0, to_s=80.0), "ended early, at 80 s"),
        (flight(0.2, authority=3), "given up"),
        (flight(0.0, authority=3), ""),
        (flight(lambda t: 0.2 * t), "runs away"),
        (flight(lambda t: 2.0 * np.exp(-(t - 60.0) / 8.0)), "slow to converge"),
        (flight(lambda t: 0.3 * abs(np.sin(t))), "moves about the path"),
        (flight(0.0, believed=0.5), "false alarm"),
        (flight(0.0, speed=0.1), "does not advance"),
        (flight(0.0, believed=0.5, events=[{"state": "recovered", "at_s": 29.0}]), "false alarm"),
    ],
)
def test_a_flight_passes_or_has_a_cause(found, cause):
    assert found["cause"] == cause
    assert found["passes"] == (cause == "")


def test_the_figures_are_those_of_the_window():
    found = flight(lambda t: 3.0 if t < 60.0 else 0.04)
    assert found["rms_m"] == pytest.approx(0.04)
    assert found["worst_m"] == 3.0
    assert found["worst_late_m"] == pytest.approx(0.04)
    assert found["advance"] == pytest.approx(1.0)


@pytest.mark.parametrize("turned", [0.0, 0.7, 2.0])
def test_a_vehicle_for_the_plane_is_judged_in_it(turned):
    """0.3 m off its depth, or aside; the normals of its path are turned about the tangent, and that by a heading."""
    frame = Rotation.from_euler("ZX", [0.9, turned])

    def across(aside, up):
        level = Rotation.from_euler("z", 0.9).apply([0.0, aside, up])
        return flight(0.3, planar=frame.as_quat()[[3, 0, 1, 2]], lateral=frame.inv().apply(level)[1:])

    assert across(0.0, 0.3)["rms_m"] == pytest.approx(0.0, abs=1e-12)
    assert across(0.0, 0.3)["passes"]
    assert across(-0.3, 0.0)["rms_m"] == pytest.approx(0.3)
    assert across(0.2, 0.3)["cause"] == "standing error"


def test_a_process_that_hangs_or_dies_costs_its_own_call_only():
    calls = [("6 * 7",), ("__import__('os')._exit(3)",), ("1 / 0",), ("__import__('time').sleep(600)",), ("'last'",)]
    found = {index: (good, value) for index, good, value in in_processes(eval, calls, jobs=2, cpu_s=60.0, wall_s=10.0)}
    assert found[0] == (True, 42)
    assert found[1] == (False, "crash: the process died")
    assert found[2] == (False, "ZeroDivisionError: division by zero")
    assert found[3] == (False, "timeout: 10 s")
    assert found[4] == (True, "last")


def test_a_call_that_computes_for_ever_ends_by_its_processor_time():
    endless = [("sum(0 for _ in iter(int, 1))",), ("6 * 7",)]
    found = {
        index: (good, value) for index, good, value in in_processes(eval, endless, jobs=1, cpu_s=1.0, wall_s=600.0)
    }
    assert found == {0: (False, "timeout: it took all its processor time"), 1: (True, 42)}


def test_tables_count_what_the_analysis_calls_flyable():
    rows = [
        {"kind": "a", "forecast": True, "passes": True},
        {"kind": "a", "forecast": True, "passes": False, "false_alarms": 2},
        {"kind": "b", "forecast": False, "passes": True},
    ]
    assert tables.counts(rows, lambda row: [row["kind"]]) == [("a", 2, 2, 1, 2), ("b", 1, 0, 0, 0)]


def test_a_vehicle_flies_when_all_that_is_asked_of_it_passes():
    def row(vehicle, path, says, passes, asked_of_it=True):
        return {"vehicle": vehicle, "path": path, "forecast": says, "passes": passes, "asked": asked_of_it}

    rows = [row("x", "line", True, True), row("x", "helix", True, False), row("x", "point", False, False, False)]
    rows += [row("y", "line", True, True), row("y", "helix", True, True)]
    assert [found[:3] for found in verdicts(rows)] == [("x", True, False), ("y", True, True)]
