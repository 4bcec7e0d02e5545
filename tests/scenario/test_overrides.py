"""Overrides: they reach every value, and a wrong one is named as such."""

from __future__ import annotations

import numpy as np
import pytest
from support.places import CUBE, SCENARIO_FILES
from support.scenario_files import MINIMAL, mistakes, write

from cube_sim.scenario import Scenario, load
from cube_sim.scenario.document import parse, parse_value
from cube_sim.scenario.overrides import apply


def test_every_value_of_a_scenario_can_be_overridden(tmp_path):
    """Move the values of a complete file one by one, by override, into another scenario: it becomes that file."""
    wanted = load(SCENARIO_FILES[0], {"guidance.speed_m_s": 0.25, "initial.attitude_deg": [1, 2, 3]})
    data = parse(wanted.resolved_yaml()).data

    def leaves(value, path):
        if isinstance(value, dict):
            for key, item in value.items():
                yield from leaves(item, [*path, key])
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for index, item in enumerate(value):
                yield from leaves(item, [*path, str(index)])
        else:
            yield ".".join(path), value

    overrides = dict(leaves(data, []))
    assert len(overrides) > 40
    lists = {key: [{} for _ in data[key]] for key in ("events", "checks")}
    start = write(tmp_path)
    assert load(start, {"path": {}, **lists, **overrides}).scenario == wanted.scenario


def test_outer_overrides_come_first_whatever_the_order(tmp_path):
    line = {"type": "line", "start_m": [0, 0, 0], "end_m": [1, 0, 0]}
    for overrides in ({"path.end_m": [9, 0, 0], "path": line}, {"path": line, "path.end_m": [9, 0, 0]}):
        assert load(write(tmp_path), overrides).scenario.path.end_m == (9.0, 0.0, 0.0)


def test_the_file_and_the_given_values_stay_as_they_are(tmp_path):
    data, given = {"a": {"b": [1, 2]}}, {"a.b.0": [5]}
    result, _, wrong = apply(data, given)
    assert result == {"a": {"b": [[5], 2]}}
    assert not wrong
    assert data == {"a": {"b": [1, 2]}}
    assert given == {"a.b.0": [5]}


def test_numpy_values_are_numbers_and_lists(tmp_path):
    overrides = {"current_m_s": np.array([0.1, 0.2, 0.3]), "duration_s": np.float64(7), "seed": np.int64(3)}
    scenario = load(write(tmp_path), overrides).scenario
    assert (scenario.current_m_s, scenario.duration_s, scenario.seed) == ((0.1, 0.2, 0.3), 7.0, 3)


def test_a_path_is_the_name_of_its_file(tmp_path):
    path = write(tmp_path)
    assert load(path, {"model": CUBE}).scenario.model == str(CUBE)


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ({"duration_s": -1}, "override duration_s: must be greater than 0, got -1"),
        ({"duration_s": float("nan")}, "override duration_s: must be finite, got nan"),
        ({"duration_s": "10"}, "override duration_s: must be a number, got the text '10'"),
        ({"duraton_s": 1}, "override duraton_s: unknown key; did you mean duration_s?"),
        ({"guidence.speed_m_s": 1}, "override guidence.speed_m_s: guidence: unknown key; did you mean guidance?"),
        ({"checks.1.reach_m": 1}, "override checks.1.reach_m: checks is a list of 1, '1' is not an index of it"),
        ({"checks.-1.reach_m": 1}, "override checks.-1.reach_m: checks is a list of 1, '-1' is not an index of it"),
        ({"duration_s.x": 1}, "override duration_s.x: duration_s is a single value and has no 'x' inside"),
        ({"path..end_m": 1}, "override path..end_m: an empty name in the path; write for example guidance.speed_m_s"),
        ({"": 1}, "override : an empty name in the path; write for example guidance.speed_m_s"),
        ({"path": {"type": "line", "start_m": [0, 0, 0]}}, "override path: path.end_m: this key is required"),
        ({"checks.0.reach_m": 0}, "override checks.0.reach_m: must be greater than 0, got 0"),
        ({"checks": []}, "override checks: a run without checks shows nothing: give at least one"),
        ({"seed": 10**30}, "override seed: must be less than 9.22337e+18, got 1000000000000000000000000000000"),
        ({1: 2}, "override 1: a path is text"),
        ({"duration_s": 1e6}, "override duration_s: must be at most 86400, got 1000000.0"),
        ({"model": "a\0b"}, "override model: a file name cannot hold a NUL character"),
    ],
)  # fmt: skip
def test_a_wrong_override_is_named(tmp_path, override, expected):
    assert mistakes(write(tmp_path), override) == [expected]


def test_mistakes_of_file_and_overrides_come_together(tmp_path):
    path = write(tmp_path)
    path.write_text(path.read_text().replace("0.4", "-0.4"))
    assert mistakes(path, {"seed": -1, "no.where": 1, "checks.7": 1}) == [
        "mission.yaml:6:23: guidance.speed_m_s: must be at least 0.0001, got -0.4",
        "override seed: must be at least 0, got -1",
        f"override no.where: no: unknown key; known: {', '.join(Scenario.model_fields)}",
        "override checks.7: checks is a list of 1, '7' is not an index of it",
    ]


def test_an_override_mends_what_the_file_got_wrong(tmp_path):
    path = write(tmp_path)
    path.write_text(path.read_text().replace("0.4", "-0.4"))
    assert load(path, {"guidance.speed_m_s": 0.3}).scenario.guidance.speed_m_s == 0.3


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.3", 0.3),
        ("1e-3", 1e-3),
        ("[1, 2.5]", [1, 2.5]),
        ("{mode: fixed}", {"mode": "fixed"}),
        ("null", None),
        ("", None),
        ("on", "on"),
    ],
)
def test_command_line_values_are_yaml(text, value):
    assert parse_value(text) == value


def test_command_line_values_that_are_not_yaml():
    with pytest.raises(ValueError, match="not valid YAML"):
        parse_value("[1, 2")


def test_an_override_that_makes_a_block_another_kind_is_blamed_for_its_keys(tmp_path):
    write(tmp_path, MINIMAL, "base.yaml")
    for path in (tmp_path / "base.yaml", write(tmp_path, "include: base.yaml\nname: above\n")):
        found = mistakes(path, {"path.type": "point"})
        assert [line.split(";")[0] for line in found] == [
            "override path.type: path.position_m: this key is required",
            "override path.type: path.start_m: unknown key",
            "override path.type: path.end_m: unknown key",
        ]
        assert all(line.endswith("another type takes the whole block: path={...}") for line in found)


def test_a_misspelt_actuator_in_an_override_is_told_the_one_there_is():
    table = {"times_s": [0], "values": [1.0]}
    for data, prefix in (
        ({"setpoints": {"shoulder": table}}, ""),
        ({"vehicles": {"a": {"setpoints": {"shoulder": table}}}}, "vehicles.a."),
    ):
        path = f"{prefix}setpoints.sholder.values"
        assert apply(data, {path: [0]})[2] == [f"override {path}: no set-points of 'sholder'; did you mean shoulder?"]
        assert apply(data, {f"{prefix}setpoints.shoulder.values": [0]})[2] == []
        both = {f"{prefix}setpoints.elbow.times_s": [0], f"{prefix}setpoints.elbow.values": [1]}
        assert apply(data, both)[2] == []
