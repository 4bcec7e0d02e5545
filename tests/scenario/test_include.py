"""`include`: a file on top of another is the file that says all of it, and mistakes stand where they are written."""

from __future__ import annotations

import pytest
from support.places import HELIX
from support.scenario_files import FLIGHT, MINIMAL, mistakes, write

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.runs.recorded_run import load_run
from cube_sim.runs.replay import replay
from cube_sim.scenario import load
from cube_sim.scenario.loading import load_checks, loaded_again


@pytest.fixture
def base(tmp_path):
    return write(tmp_path, MINIMAL, "base.yaml")


def test_what_the_file_says_takes_the_place_of_the_base(base, tmp_path):
    text = "include: base.yaml\nname: other\nguidance: {stop_time_s: 3.0}\ninitial: {position_m: [1, 2, 3]}\n"
    scenario = load(write(tmp_path, text)).scenario
    whole = MINIMAL.replace("short_line", "other").replace("{speed_m_s: 0.4}", "{speed_m_s: 0.4, stop_time_s: 3.0}")
    assert scenario == load(write(tmp_path, whole + "initial: {position_m: [1, 2, 3]}\n", "whole.yaml")).scenario


def test_a_list_is_replaced_as_a_whole(base, tmp_path):
    scenario = load(write(tmp_path, "include: base.yaml\nchecks: [{kind: allowed_forces}]\n")).scenario
    assert [check.kind for check in scenario.checks] == ["allowed_forces"]


def test_a_block_of_another_kind_is_replaced_as_a_whole(base, tmp_path):
    scenario = load(write(tmp_path, "include: base.yaml\npath: {type: point, position_m: [0, 0, -3]}\n")).scenario
    assert scenario.path.type == "point"
    moved = load(write(tmp_path, "include: base.yaml\npath: {type: line, end_m: [9, 0, -5]}\n")).scenario
    assert (moved.path.start_m, moved.path.end_m) == ((0, 0, -5), (9, 0, -5))


LEGS = "[{name: own, path: {type: line, start_m: [0, 0, -5], end_m: [0, 7, -5]}}]"
WAYS = {
    "path": "path: {type: line, start_m: [0, 0, -5], end_m: [0, 7, -5]}\n",
    "phases": f"phases: {LEGS}\n",
    "waypoints": "waypoints: [{to_m: [0, 7, -5]}]\ninitial: {position_m: [0, 0, -5]}\n",
}


@pytest.mark.parametrize("ours", WAYS)
@pytest.mark.parametrize("theirs", ["path", "phases", "waypoints"])
def test_another_way_to_say_where_to_go_is_in_place_of_the_bases(tmp_path, ours, theirs):
    gone = "path: {type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}\n"
    assert gone in MINIMAL
    below = {
        "path": gone,
        "phases": "phases: [{name: first, path: {type: point, position_m: [9, 9, -9]}}]\n",
        "waypoints": "waypoints: [{to_m: [9, 9, -9]}]\n",
    }
    write(tmp_path, MINIMAL.replace(gone, below[theirs]), "base.yaml")
    scenario = load(write(tmp_path, "include: base.yaml\n" + WAYS[ours])).scenario
    assert (scenario.path.start_m, scenario.path.end_m) == ((0, 0, -5), (0, 7, -5))
    assert len(scenario.phases) == (ours != "path")


def test_phases_and_waypoints_in_one_file_are_refused(tmp_path):
    gone = "path: {type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}\n"
    text = MINIMAL.replace(gone, f"phases: {LEGS}\nwaypoints: [{{to_m: [0, 7, -5]}}]\n")
    place = "mission.yaml:6:12: waypoints"
    assert mistakes(write(tmp_path, text)) == [
        f"{place}: are phases, written in short: give either phases or waypoints"
    ]


def test_a_name_the_system_cannot_look_up_is_one_line(tmp_path):
    (tmp_path / "a.yaml").symlink_to("b.yaml")
    (tmp_path / "b.yaml").symlink_to("a.yaml")
    for key, name, why in (
        ("include", "a.yaml", "Too many levels of symbolic links"),
        ("include", "x" * 300, "File name too long"),
        ("model", "a.yaml", "Too many levels of symbolic links"),
        ("model", "x" * 300, "File name too long"),
    ):
        text = f"include: {name}\n" if key == "include" else MINIMAL.replace("model: hull.xml", f"model: {name}")
        (line,) = mistakes(write(tmp_path, text))
        shown = name if len(name) < 60 else f"{name[:60]}..."
        assert line.endswith(f": {key}: {shown}: cannot be looked at: {why}")


def test_a_base_may_include_another_and_files_are_named_from_the_one_that_names_them(tmp_path):
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "course.csv").write_text("x_m,y_m,z_m\n0,0,-5\n4,0,-5\n8,1,-5\n")
    text = MINIMAL.replace("{type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}", "{type: csv, file: course.csv}")
    write(tmp_path / "deep", text.replace("hull.xml", "../hull.xml"), "first.yaml")
    write(tmp_path, "include: deep/first.yaml\nduration_s: 20\n", "second.yaml")
    scenario = load(write(tmp_path, "include: second.yaml\nname: third\n")).scenario
    assert (scenario.name, scenario.duration_s, scenario.guidance.speed_m_s) == ("third", 20.0, 0.4)
    assert scenario.model == str(tmp_path / "hull.xml")
    assert scenario.path.file == str(tmp_path / "deep" / "course.csv")


def test_code_of_the_base_stands_beside_the_base(tmp_path):
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "law.py").write_text("def law(setup): ...\n")
    text = MINIMAL + "control: {law: {python: 'law.py:law', options: {file: stays}}}\n"
    write(tmp_path / "deep", text, "base.yaml")
    law = load(write(tmp_path, "include: deep/base.yaml\n")).scenario.control.law
    assert law.python == f"{tmp_path}/deep/law.py:law"
    assert law.options == {"file": "stays"}


def test_a_mistake_stands_in_the_file_that_makes_it(tmp_path):
    write(tmp_path, MINIMAL.replace("speed_m_s: 0.4", "speed_m_s: -1"), "base.yaml")
    found = mistakes(write(tmp_path, "include: base.yaml\nduration_s: -2\nguidance: {stop_time: 3}\n"))
    assert [line.split(": ")[:2] for line in found] == [
        ["mission.yaml:2:13", "duration_s"],
        ["mission.yaml:3:12", "guidance.stop_time"],
        ["base.yaml:6:23", "guidance.speed_m_s"],
    ]


def test_mistakes_found_after_loading_stand_in_their_file(base, tmp_path):
    loaded = load(write(tmp_path, "include: base.yaml\nseed: 3\n"))
    assert loaded.mistake("path.end_m", "is far").startswith(f"{base}:5:")
    assert loaded.mistake("seed", "is odd").startswith(f"{loaded.path}:2:7: seed: is odd")


def test_an_override_comes_after_all_files(base, tmp_path):
    path = write(tmp_path, "include: base.yaml\n")
    assert load(path, {"checks.0.reach_m": 0.2}).scenario.checks[0].reach_m == 0.2
    assert mistakes(path, {"include": "base.yaml"}) == ["override include: only a file includes another; load that one"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("include: none.yaml\n", "mission.yaml:1:10: include: no such file: none.yaml"),
        ("include: [a]\n", "mission.yaml:1:10: include: must be the name of a scenario file, for example base.yaml"),
        ("include: mission.yaml\n", "mission.yaml:1:10: include: includes itself: mission.yaml includes mission.yaml"),
        ("include: .\n", "is a folder, not a scenario file"),
    ],
)
def test_what_cannot_be_included_is_refused_in_place(tmp_path, text, expected):
    (found,) = mistakes(write(tmp_path, text))
    assert expected in found


def test_a_circle_is_named_where_it_closes(tmp_path):
    write(tmp_path, "name: b\ninclude: ./mission.yaml\n", "b.yaml")
    (found,) = mistakes(write(tmp_path, "include: b.yaml\n"))
    assert found.startswith("b.yaml:2:10: include: includes itself: mission.yaml includes b.yaml includes mission.yaml")


def test_bad_yaml_of_a_base_is_placed_in_the_base(tmp_path):
    write(tmp_path, "name: [a\nseed: 1\n", "base.yaml")
    (found,) = mistakes(write(tmp_path, "include: base.yaml\n"))
    assert found.startswith("base.yaml:")
    write(tmp_path, MINIMAL + "name: again\n", "base.yaml")
    (found,) = mistakes(write(tmp_path, "include: base.yaml\n"))
    assert found.startswith("base.yaml:9:1: name: the key 'name' is already given in line 2")


def test_replaced_again_from_what_was_read(base, tmp_path):
    """The files may be gone or others by then."""
    loaded = load(write(tmp_path, "include: base.yaml\nseed: 3\n"))
    base.unlink()
    again = loaded_again(loaded, {"guidance.speed_m_s": 0.2})
    assert (again.scenario.guidance.speed_m_s, again.scenario.seed) == (0.2, 3)
    with pytest.raises(ScenarioError, match=r"override guidance\.speed_m_s: must be at least 0.0001"):
        loaded_again(again, {"guidance.speed_m_s": 0.0})


def test_checks_are_read_through_an_include(tmp_path):
    write(tmp_path, "checks: [{kind: path_end, reach_m: 0.1}]\n", "base.yaml")
    scenario = load(HELIX).scenario.model_dump(mode="json")
    (check,) = load_checks(write(tmp_path, "include: base.yaml\n"), scenario, {}, ())
    assert check.reach_m == 0.1


@pytest.mark.flight
def test_a_record_needs_none_of_the_files(tmp_path):
    write(tmp_path, FLIGHT, "base.yaml")
    path = write(tmp_path, "include: base.yaml\nname: on_top\nduration_s: 0.3\n")
    result = cube_sim.run(path, out=tmp_path / "runs")
    (tmp_path / "base.yaml").unlink()
    path.unlink()
    run = load_run(result.directory / "run.mcap")
    assert run.header.inputs["include/1/base.yaml"] == FLIGHT.encode()
    assert load(result.directory / "resolved.yaml").scenario.duration_s == 0.3
    assert not replay(run).differences


def test_null_includes_nothing(tmp_path):
    assert load(write(tmp_path, MINIMAL + "include: null\n")).scenario == load(write(tmp_path, MINIMAL)).scenario
    write(tmp_path, MINIMAL + "include:\n", "base.yaml")
    assert load(write(tmp_path, "include: base.yaml\nname: other\n")).scenario.name == "other"


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "base.yaml: is a folder, not a scenario file"),
        (b"", "base.yaml:1:1: the file is empty"),
        (b"- 1\n", "base.yaml:1:1: a scenario is a block of keys, this file holds a list"),
        (b"\x89MCAP0\r\n", "base.yaml:1:1: not UTF-8 text (byte 0x89)"),
    ],
)
def test_a_base_that_is_no_scenario_is_the_mistake_of_who_names_it(content, said, tmp_path):
    base = tmp_path / "base.yaml"
    base.mkdir() if content is None else base.write_bytes(content)
    path = write(tmp_path, "name: other\ninclude: base.yaml\n")
    with pytest.raises(ScenarioError) as refused:
        load(path)
    assert refused.value.mistakes == [f"{path}:2:10: include: {tmp_path / said}"]
