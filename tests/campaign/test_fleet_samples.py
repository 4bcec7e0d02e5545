"""Samples of several vehicles: drawn over keys of all and of each, flown as they would be alone."""

from __future__ import annotations

import pytest
from support.dask_cluster import cluster_of
from support.fleets import PAIR, write

from cube_sim.campaign import sample_flight
from cube_sim.campaign.sampling import SamplePlan, count, sample, variation
from cube_sim.campaign.sweep import sweep
from cube_sim.errors import DirectoryError, ScenarioError
from cube_sim.scenario.fleet_loading import load_any
from cube_sim.simulation import fly
from cube_sim.vehicle.compiled_once import CompiledOnce

SAMPLES = """\
samples:
  count: 3
  vary:
    current_m_s: {distribution: direction, high: 0.2}
    guidance.speed_m_s: {distribution: uniform, low: 0.2, high: 0.35}
    vehicles.follower.guidance.speed_m_s: {distribution: uniform, gives: factor, low: 0.8, high: 1.2}
    vehicles.leader.parameters.hull:mass: {distribution: uniform, gives: percent, low: -2, high: 2}
    vehicles.leader.initial.position_m.1: {distribution: normal, gives: offset, mean: 0, std: 0.2}
"""
SHORT = PAIR.replace("duration_s: 12", "duration_s: 2")


def loaded(folder, samples=SAMPLES, **settings):
    return load_any(write(folder, SHORT + samples), settings)


def test_a_sample_is_a_scenario_of_all_vehicles_without_samples(tmp_path):
    whole = loaded(tmp_path)
    assert count(whole) == 3
    drawn, flown = variation(whole, 1), sample(whole, 1).scenario
    leader, follower = flown.vehicles["leader"], flown.vehicles["follower"]
    assert flown.samples is None
    assert leader.current_m_s == follower.current_m_s == tuple(drawn["current_m_s"])
    assert leader.guidance.speed_m_s == drawn["guidance.speed_m_s"]
    factor = drawn["vehicles.follower.guidance.speed_m_s"]
    assert follower.guidance.speed_m_s == pytest.approx(0.25 * factor)
    assert leader.initial.position_m[1] == pytest.approx(0.2 + drawn["vehicles.leader.initial.position_m.1"])
    assert set(leader.parameters) == {"hull:mass"}
    assert follower.parameters == {}
    assert sample(whole, 1).scenario == flown
    assert sample(whole, 2).scenario.vehicles["leader"].seed != leader.seed != follower.seed


@pytest.mark.flight
def test_a_sweep_of_several_vehicles_is_the_same_whoever_flies(tmp_path):
    whole = loaded(tmp_path)
    one = sweep(whole, tmp_path / "one", workers=1, workers_as="threads")
    sweep(whole, tmp_path / "two", workers=2, keep="all")
    with cluster_of(tmp_path, 2) as (address, _):
        sweep(whole, tmp_path / "cluster", cluster=address)
    for name in ("rows.parquet", "sweep.json"):
        assert len({(tmp_path / way / name).read_bytes() for way in ("one", "two", "cluster")}) == 1
    rows = one.rows.to_pylist()
    assert [row["sample"] for row in rows] == [0, 1, 2]
    alone = fly(sample(whole, 2), out=tmp_path / "alone", record="mcap")
    for check in alone.checks:
        name = f"check.{check.name}"
        assert (rows[2][f"{name}.value"], rows[2][f"{name}.verdict"]) == (check.value, check.verdict)
    assert [check["name"] for check in one.head["checks"]] == [check.name for check in alone.checks]
    kept = tmp_path / "two" / "runs" / "2" / "run.mcap"
    assert kept.read_bytes() == (tmp_path / "alone" / "run.mcap").read_bytes()


@pytest.mark.flight
def test_what_samples_share_is_compiled_once_and_changes_nothing(tmp_path, monkeypatch):
    compiled, whole = [], CompiledOnce.of
    monkeypatch.setattr(CompiledOnce, "of", lambda *given: compiled.append(given) or whole(*given))

    def counted(folder, **settings):
        compiled.clear()
        sweep(loaded(tmp_path, **settings), tmp_path / folder, workers=1, workers_as="threads")
        return len(compiled)

    first, all_of_them = counted("first", **{"samples.count": 1}), counted("shared")
    assert first == all_of_them
    monkeypatch.setattr(sample_flight, "sharing", lambda each: each)
    assert counted("anew") >= first + 2 * 3  # either alone, and both together
    assert len({(tmp_path / way / "rows.parquet").read_bytes() for way in ("shared", "anew")}) == 1


@pytest.mark.flight
def test_another_scenario_of_several_vehicles_is_another_sweep(tmp_path):
    few = {"samples.count": 1}
    sweep(loaded(tmp_path, **few), tmp_path / "out")
    assert sweep(loaded(tmp_path, **{"samples.count": 2}), tmp_path / "out", resume=True).count("PASS") >= 0
    with pytest.raises(DirectoryError, match="holds another sweep; what differs: scenario; give a new folder"):
        sweep(loaded(tmp_path, **few, **{"vehicles.leader.guidance.speed_m_s": 0.31}), tmp_path / "out", resume=True)


def test_code_of_ones_own_draws_of_several_vehicles(tmp_path):
    (tmp_path / "draw.py").write_text(
        "def draw(k, rng):\n    return {'vehicles.leader.guidance.speed_m_s': 0.2 + 0.1 * k}, {'kind': 'slow'}\n"
    )
    whole = loaded(tmp_path, "samples: {count: 2, generator: {python: 'draw.py:draw'}}\n")
    assert sample(whole, 1).scenario.vehicles["leader"].guidance.speed_m_s == pytest.approx(0.3)
    assert SamplePlan(whole).sample(0).notes == {"kind": "slow"}


LINE = len(SHORT.splitlines())


@pytest.mark.parametrize(
    ("vary", "said"),
    [
        (
            "vehicles.leeder.guidance.speed_m_s: {distribution: uniform, low: 0.2, high: 0.3}",
            "samples.vary.vehicles.leeder.guidance.speed_m_s: no vehicle 'leeder'; there are leader, follower",
        ),
        (
            "vehicles.leader.guidance.speed_m_s: {distribution: uniform, low: -1, high: 0.3}",
            "samples.vary.vehicles.leader.guidance.speed_m_s: may be -1.0: must be at least 0.0001, got -1.0",
        ),
        (
            "vehicles.leader.parameters.hull:mas: {distribution: uniform, low: 1, high: 2}",
            "samples.vary.vehicles.leader.parameters.hull:mas: ",
        ),
    ],
)
def test_what_no_vehicle_can_have_is_refused_at_its_place(tmp_path, vary, said):
    with pytest.raises(ScenarioError) as caught:
        SamplePlan(loaded(tmp_path, f"samples:\n  count: 2\n  vary:\n    {vary}\n")).require_possible()
    assert f"pair.yaml:{LINE + 4}:" in caught.value.mistakes[0]
    assert said in str(caught.value)


def test_whose_thrusters_are_lost_must_be_said_otherwise(tmp_path):
    with pytest.raises(ScenarioError, match=r"samples\.lost_thrusters: are those of one vehicle: give it events"):
        loaded(tmp_path, "samples: {lost_thrusters: {losses: 1}}\n")
