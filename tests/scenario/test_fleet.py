"""Scenario files of several vehicles: what each has, and where a mistake is said to stand."""

import pytest
from support.fleets import PAIR, loaded_fleet, write

from cube_sim.errors import ScenarioError
from cube_sim.scenario import load
from cube_sim.scenario.document import parse
from cube_sim.scenario.fleet import vehicle_seed
from cube_sim.scenario.fleet_loading import fleet_of, load_any


def test_each_vehicle_has_what_stands_at_the_top_and_its_own(tmp_path):
    fleet = loaded_fleet(write(tmp_path)).scenario
    leader, follower = fleet.vehicles["leader"], fleet.vehicles["follower"]
    assert list(fleet.vehicles) == ["leader", "follower"]
    assert (leader.guidance.speed_m_s, follower.guidance.speed_m_s) == (0.3, 0.25)
    assert (leader.path.type, follower.path.type) == ("line", "circle")
    assert leader.current_m_s == follower.current_m_s == (0.1, 0.0, 0.0)
    assert leader.duration_s == follower.duration_s == 12
    assert len(leader.checks) == 1
    assert follower.checks == ()
    assert [check.signal for check in fleet.checks] == [
        "distance.leader_to_follower",
        "follower/path_error.cross_track",
    ]


def test_a_block_is_merged_key_by_key_and_one_of_another_kind_is_not(tmp_path):
    text = PAIR.replace("guidance: {speed_m_s: 0.25}", "guidance: {tracking_time_s: 3.0}")
    follower = loaded_fleet(write(tmp_path, text)).scenario.vehicles["follower"]
    assert (follower.guidance.speed_m_s, follower.guidance.tracking_time_s) == (0.3, 3.0)
    assert not hasattr(follower.path, "start_m")


def test_streams_come_of_the_name_not_of_the_place(tmp_path):
    seeds = {name: one.seed for name, one in loaded_fleet(write(tmp_path)).scenario.vehicles.items()}
    assert seeds == {name: vehicle_seed(4, name) for name in ("leader", "follower")}
    assert len(set(seeds.values())) == 2
    told = loaded_fleet(write(tmp_path), {"vehicles.leader.seed": 9}).scenario
    assert told.vehicles["leader"].seed == 9
    assert told.vehicles["follower"].seed == seeds["follower"]


def test_resolved_it_is_the_same_fleet(tmp_path):
    loaded = loaded_fleet(write(tmp_path))
    again = tmp_path / "resolved.yaml"
    again.write_text(loaded.resolved_yaml())
    assert loaded_fleet(again).scenario == loaded.scenario
    assert fleet_of(parse(again.read_text()).data) == loaded.scenario
    relative = tmp_path / "relative.yaml"
    relative.write_text(loaded.resolved_yaml(tmp_path))
    assert loaded_fleet(relative).scenario == loaded.scenario


def test_a_file_of_one_vehicle_is_what_it_was(tmp_path):
    from support.places import HELIX

    assert load_any(HELIX).scenario == load(HELIX).scenario


def test_what_flies_one_vehicle_says_so(tmp_path):
    from cube_sim import Flight, fly_many

    path = write(tmp_path)
    said = r"pair.yaml:9:1: vehicles: here one vehicle is flown at a time"
    with pytest.raises(ScenarioError, match=said):
        load(path)
    with pytest.raises(ScenarioError, match=said):
        Flight(path)
    with pytest.raises(ScenarioError, match=said):
        fly_many(path, [{}])


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("speed_m_s: 0.25", "sped_m_s: 0.25", "16:16: vehicles.follower.guidance.sped_m_s: unknown key; did you mean"),
        ("guidance: {speed_m_s: 0.3}", "guidance: {speed_m_s: -1}", "7:23: guidance.speed_m_s: must be at least"),
        ("  follower:", "  Follower:", "vehicles.Follower: a vehicle's name has"),
        ("  follower:\n", "  follower:\n    duration_s: 3\n", "duration_s: is the same for all vehicles"),
        ("radius_m: 2", "radios_m: 2", "vehicles.follower.path.radios_m: unknown key"),
        ("between: [follower, leader]", "between: [follower, hare]", "19:42: checks.0.between.1: no vehicle 'hare'"),
        ("between: [follower, leader]", "between: [leader, leader]", "checks.0.between: name two vehicles"),
        ("kind: distance", "kind: distanse", "checks.0.kind: unknown kind 'distanse'; did you mean distance?"),
        ("vehicles:\n", "samples: {cont: 3}\nvehicles:\n", "9:11: samples.cont: unknown key; did you mean count?"),
        ("seed: 4", "seed: x", "4:7: seed: must be a whole number"),
        ("duration_s: 12", "duration_s: 12\nfoo: 1", "4:1: foo: unknown key"),
    ],
)
def test_a_mistake_stands_where_it_is_written(tmp_path, before, after, said):
    assert before in PAIR
    path = write(tmp_path, PAIR.replace(before, after, 1))
    with pytest.raises(ScenarioError) as error:
        load_any(path)
    assert said in str(error.value)
    lines = str(error.value).splitlines()
    assert len(set(lines)) == len(lines)
    assert all(line.startswith(f"{path}:") for line in lines)


def test_an_empty_block_and_none_without_checks_are_refused(tmp_path):
    top = PAIR.partition("vehicles:\n")[0]
    with pytest.raises(ScenarioError, match="must be a block of names"):
        load_any(write(tmp_path, f"{top}vehicles: {{}}\n"))
    with pytest.raises(ScenarioError, match="a run without checks shows nothing"):
        load_any(write(tmp_path, f"{top}vehicles:\n  a: {{}}\n  b: {{}}\n"))
    no_path = "\n".join(line for line in top.splitlines() if not line.startswith("path:"))
    with pytest.raises(ScenarioError, match=r"vehicles\.a\.path: this key is required"):
        load_any(write(tmp_path, f"{no_path}\nvehicles:\n  a: {{}}\nchecks: []\n"))
