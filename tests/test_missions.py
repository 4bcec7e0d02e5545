"""What the campaign of missions draws is what it says, and asks what it should."""

from __future__ import annotations

import time
from types import SimpleNamespace

import numpy as np
import pytest
from draw_mission import FILES, named
from flights import workers
from flights.ability import ability_of
from flights.asked import checks
from flights.forecast import forecast
from flights.mission import JUDGED_S, RECOVERY_S, written
from flights.paths import PATHS, drawn_path
from flights.plan import INGREDIENTS, KINDS, drawn_plan
from flights.trial import every_vehicle, trials
from flights.workers import in_processes
from support.places import MODELS, REPO

from cube_sim.campaign.sampling import SamplePlan, count
from cube_sim.campaign.sweep import sweep
from cube_sim.errors import ScenarioError
from cube_sim.mission.path import path_of
from cube_sim.scenario import load

MISSIONS, CATALOGUE = (REPO / "benchmarks" / f"{name}.yaml" for name in ("missions", "catalogue"))
OPTIONS = "samples.generator.options"


def test_a_seed_is_a_mission_whatever_is_flown_beside_it(tmp_path):
    some = [drawn_plan(seed) for seed in range(300)]
    assert some == [drawn_plan(seed) for seed in range(300)]
    assert {plan.kind for plan in some} == set(KINDS)
    assert {plan.path for plan in some} == set(PATHS)
    assert {name for plan in some for name in plan.ingredients} == set(INGREDIENTS)
    assert len({plan.vehicle for plan in some}) > 60
    texts, told = [], []
    for folder in ("a", "b"):
        mission = written(some[9], tmp_path / folder)
        texts.append({file.name: file.read_text() for file in (tmp_path / folder).iterdir()})
        told.append(str(mission.scenario).replace(str(tmp_path / folder), ""))
    assert texts[0] == texts[1]
    assert told[0] == told[1]


@pytest.mark.parametrize("seed", range(24))
def test_a_mission_is_a_scenario_that_may_be_flown(seed):
    plan = SamplePlan(load(MISSIONS, {f"{OPTIONS}.first_seed": seed}))
    drawn = plan.sample(0)
    mission = written(drawn_plan(seed), FILES / f"mission_{seed}")
    scenario = plan.scenario_of(drawn).scenario
    assert scenario.seed == seed == drawn.notes["seed"]
    assert (drawn.notes["vehicle"], drawn.notes["kind"]) == (mission.plan.vehicle, mission.plan.kind)
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
    able = ability_of(mission.model, (), False)
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


def asked_of(path="line", planar=False, **more):
    scenario = {"path": {"type": path}, "guidance": {"speed_m_s": 0.5}, **more}
    return {check.get("name", check["kind"]): check for check in checks(scenario, 60.0, planar)}


def test_a_mission_is_asked_to_be_near_its_path_to_advance_and_to_doubt_no_whole_thruster():
    found = asked_of()
    assert list(found) == ["error RMS", "progress", "false_alarms"]
    assert (found["error RMS"]["signal"], found["error RMS"]["at_most"]) == ("path_error.cross_track", 0.05)
    assert (found["progress"]["at_least_m_s"], found["progress"]["from_s"]) == (0.25, 60.0)
    assert list(asked_of("point")) == ["error RMS", "false_alarms"]
    point = asked_of("point")["error RMS"]
    assert (point["signal"], point["minus"]) == ("pose.position", "target.position")  # `along` comes on top there


def test_a_vehicle_for_the_plane_is_judged_in_it():
    lateral = asked_of(planar=True)["error RMS"]
    assert (lateral["signal"], lateral["component"]) == ("path_error.lateral", 0)
    assert asked_of("point", planar=True)["error RMS"]["combine"] == "horizontal"


@pytest.mark.parametrize("kind", [kind for kind in PATHS if kind != "point"])
def test_the_first_normal_of_a_level_path_is_level(kind, tmp_path):
    """So that the part of the error along it is the error in the plane."""
    (tmp_path / "cube.xml").write_text((MODELS / "cube.xml").read_text())
    block, _, _, table = drawn_path(np.random.default_rng(3), kind, 60.0, 3.0, 0.0)
    (tmp_path / "path.csv").write_text(table)
    scenario = {"schema_version": 1, "name": "x", "model": "cube.xml", "duration_s": 10, "path": block}
    scenario |= {"guidance": {"speed_m_s": 0.3}, "checks": [{"kind": "allowed_forces"}]}
    (tmp_path / "x.yaml").write_text(repr(scenario).replace("'", '"'))
    path = path_of(load(tmp_path / "x.yaml"))
    assert max(abs(path.at(s).rotation[2, 1]) for s in np.linspace(0.0, path.length, 400)) < 1e-12


def test_on_sensors_it_is_held_against_its_own_estimate():
    own = asked_of(navigation={})["error RMS in its own sigmas"]
    assert own["numerator"]["signal"] == "path_error.cross_track"
    assert own["denominator"]["signal"] == "navigation.position_sigma"
    assert (own["at_most"], own["at_most"] * own["least_denominator"]) == (3.0, pytest.approx(0.05))


def test_missions_of_some_vehicles_and_kinds():
    some = {f"{OPTIONS}.vehicles": ["infante", "drawn4*"], f"{OPTIONS}.kinds": ["fault", "plain"]}
    plan = SamplePlan(load(MISSIONS, some))
    notes = [plan.sample(k).notes for k in range(4)]
    assert [each["seed"] for each in notes] == sorted({each["seed"] for each in notes})
    assert all(each["vehicle"] == "infante" or each["vehicle"].startswith("drawn4") for each in notes)
    assert {each["kind"] for each in notes} <= {"fault", "plain"}
    with pytest.raises(ScenarioError, match="ValueError: no vehicle submarine; the catalogue has"):
        SamplePlan(load(MISSIONS, {f"{OPTIONS}.vehicles": ["submarine"]})).sample(0)
    with pytest.raises(ScenarioError, match="ValueError: no kind fog; there are plain"):
        SamplePlan(load(MISSIONS, {f"{OPTIONS}.kinds": ["fog"]})).sample(0)


def test_every_vehicle_of_the_catalogue_has_its_trials(tmp_path):
    every = trials(named((), every_vehicle()), tmp_path)
    whole = load(CATALOGUE)
    assert count(whole) == len(every)
    asked = whole.scenario.samples.required
    assert (asked.pass_rate, asked.where, asked.each, asked.forecast) == (None, {}, "vehicle", "forecast")
    assert len({vehicle for vehicle, _ in every}) == len(every_vehicle()) == 87 + 8
    torpedo = {f"{OPTIONS}.vehicles": ["torpedo"], "samples.count": 3}
    plan = SamplePlan(load(CATALOGUE, torpedo))
    assert [plan.sample(k).notes["path"] for k in range(2)] == ["line", "helix"]  # it cannot stay at a point
    with pytest.raises(ScenarioError, match="ValueError: there are 2 trials of these vehicles"):
        plan.sample(2)


@pytest.mark.flight
def test_vehicles_that_fins_steer_fly_if_and_only_if_the_analysis_says_so(tmp_path):
    """NPS AUV II does; REMUS 100 does not with 9 N of lift, and does with 3 N."""
    names = ["nps_auv2", "remus100", "remus100_propeller"]
    result = sweep(load(CATALOGUE, {f"{OPTIONS}.vehicles": names, "samples.count": 6}), tmp_path / "out")
    rows = result.rows.to_pylist()
    assert [row["note.forecast"] for row in rows] == [row["verdict"] == "PASS" for row in rows]
    assert {row["note.vehicle"] for row in rows if row["note.forecast"]} == {"nps_auv2", "remus100_propeller"}
    assert {row["note.path"] for row in rows} == {"line", "helix"}


@pytest.mark.flight
def test_missions_come_out_as_they_are_forecast(tmp_path):
    some = {f"{OPTIONS}.vehicles": ["cube", "jack"], f"{OPTIONS}.kinds": ["plain", "fault"], "samples.count": 4}
    result = sweep(load(MISSIONS, some), tmp_path / "out")
    rows = result.rows.to_pylist()
    assert all(row["verdict"] == "PASS" for row in rows if row["note.forecast"])
    assert result.counted.count == sum(row["note.forecast"] for row in rows) > 0
    columns = [name for name in rows[0] if not name.startswith(("note.", "check."))]
    assert columns[:4] == ["sample", "verdict", "reason", "seed"]
    assert "path" not in columns


def test_a_process_that_hangs_or_dies_costs_its_own_call_only(monkeypatch):
    calls = [("6 * 7",), ("__import__('os')._exit(3)",), ("1 / 0",), ("__import__('time').sleep(6000)",), ("'last'",)]
    found = {}

    def now():  # nobody waits until it is late
        return time.monotonic() + 1000.0 * (len(found) == len(calls) - 1)

    monkeypatch.setattr(workers, "time", SimpleNamespace(monotonic=now, process_time=time.process_time))
    for index, good, value in in_processes(eval, calls, jobs=2, cpu_s=60.0, wall_s=600.0):
        found[index] = good, value
    assert found[0] == (True, 42)
    assert found[1] == (False, "crash: the process died")
    assert found[2] == (False, "ZeroDivisionError: division by zero")
    assert found[3] == (False, "timeout: 600 s")
    assert found[4] == (True, "last")


def test_a_call_that_computes_for_ever_ends_by_its_processor_time():
    endless = [("sum(0 for _ in iter(int, 1))",), ("6 * 7",)]
    found = {
        index: (good, value) for index, good, value in in_processes(eval, endless, jobs=1, cpu_s=1.0, wall_s=600.0)
    }
    assert found == {0: (False, "timeout: it took all its processor time"), 1: (True, 42)}
