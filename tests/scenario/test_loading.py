"""Reading scenario files: what is right is kept bit for bit, what is wrong is named where it stands."""

from __future__ import annotations

import dataclasses
import errno
import math
import os
import random
import re
import struct
from typing import get_args
from unittest.mock import Mock

import pydantic
import pytest
from support.places import HELIX, MODELS, REPO, SCENARIO_FILES
from support.scenario_files import MINIMAL, mistakes, write

from cube_sim.scenario import load
from cube_sim.scenario.document import parse
from cube_sim.scenario.path_blocks import AnyPath

PATH_TYPES = [get_args(block.model_fields["type"].annotation)[0] for block in get_args(get_args(AnyPath)[0])]


def test_minimal_file_is_completed_with_defaults(tmp_path):
    scenario = load(write(tmp_path)).scenario
    assert scenario.physics.integrator == "RK4"
    assert scenario.model == str(tmp_path / "hull.xml")
    assert (scenario.steps_per_tick, scenario.ticks) == (2, 500)
    assert scenario.current_m_s == (0.0, 0.0, 0.0)


def test_a_scenario_cannot_be_changed(tmp_path):
    loaded = load(write(tmp_path))
    with pytest.raises(pydantic.ValidationError):
        loaded.scenario.duration_s = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        loaded.text = ""


def test_text_is_kept_as_written(tmp_path):
    text = "# a remark\r\n" + MINIMAL.replace("\n", "\r\n")
    assert load(write(tmp_path, text)).text == text


def test_a_byte_order_mark_is_no_mistake(tmp_path):
    assert load(write(tmp_path, b"\xef\xbb\xbf" + MINIMAL.encode())).scenario.name == "short_line"


@pytest.mark.parametrize("path", SCENARIO_FILES, ids=lambda path: path.stem)
def test_resolved_file_reads_back_equal_from_another_folder(path, tmp_path):
    loaded = load(path)
    text = loaded.resolved_yaml()
    saved = tmp_path / "elsewhere" / "resolved.yaml"
    saved.parent.mkdir()
    saved.write_text(text)
    again = load(saved)
    assert again.scenario == loaded.scenario
    assert again.resolved_yaml() == text


def test_resolved_numbers_keep_every_bit(tmp_path):
    source = random.Random(20)
    # Any finite double: all exponents, all mantissas, subnormals, both zeros.
    drawn = [struct.unpack("<d", source.randbytes(8))[0] for _ in range(250)]
    values = [value for value in drawn if math.isfinite(value)] + [0.0, -0.0, 5e-324, 1e22, 1e-7]
    checks = [
        {"kind": "signal", "name": f"{index}", "signal": "a.b", "statistic": "max", "at_most": value}
        for index, value in enumerate(values)
    ]
    resolved = load(write(tmp_path), {"checks": checks}).resolved_yaml()
    again = load(write(tmp_path, resolved, "resolved.yaml")).scenario
    assert [check.at_most.hex() for check in again.checks] == [value.hex() for value in values]


def test_yaml_is_version_1_2(tmp_path):
    text = MINIMAL.replace("duration_s: 10", "duration_s: 1e1\nseed: 0o17\ndescription: on")
    scenario = load(write(tmp_path, text)).scenario
    assert (scenario.duration_s, scenario.seed, scenario.description) == (10.0, 15, "on")


def test_anchors_and_aliases_are_followed(tmp_path):
    text = MINIMAL.replace("[0, 0, -5]", "&here [0, 0, -5]") + "initial: {position_m: *here}\n"
    assert load(write(tmp_path, text)).scenario.initial.position_m == (0.0, 0.0, -5.0)


def test_all_mistakes_at_once_in_file_order(tmp_path):
    text = """\
schema_version: 1
name: two words
model: missing.xml
duration_s: -3
durration_s: 3
physics: {step_s: 0.015}
control_period_s: 0.02
current_m_s: [0.1, .nan, 0]
path: {type: helix, centre_m: [0, 0], radius_m: 3, pitch_m: yes, turns: 2}
duration_s: 4
checks:
  - kind: signal
    signal: path_error.cross_track
    statistic: rsm
    at_most: 0.1
  - {kind: path_end, reach_m: 0}
"""
    lines = mistakes(write(tmp_path, text))
    places = [tuple(line.split(": ")[:2]) for line in lines]
    assert places == [
        ("mission.yaml:1:1", "guidance"),
        ("mission.yaml:2:7", "name"),
        ("mission.yaml:3:8", "model"),
        ("mission.yaml:4:13", "duration_s"),
        ("mission.yaml:5:1", "durration_s"),
        ("mission.yaml:7:19", "control_period_s"),
        ("mission.yaml:8:20", "current_m_s.1"),
        ("mission.yaml:9:21", "path.centre_m.2"),
        ("mission.yaml:9:61", "path.pitch_m"),
        ("mission.yaml:10:1", "duration_s"),
        ("mission.yaml:14:16", "checks.0.statistic"),
        ("mission.yaml:16:31", "checks.1.reach_m"),
    ]
    assert "did you mean duration_s?" in lines[4]
    assert "0.02 s is 1.33333 steps of 0.015 s" in lines[5]
    assert "the text 'yes'" in lines[8]
    assert "already given in line 4" in lines[9]
    assert "did you mean rms?" in lines[10]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("schema_version: 1", "schema_version: 2", "1:17: schema_version: must be 1, got 2"),
        ("duration_s: 10", "duration_s: 0.01", "4:13: duration_s: control_period_s: must not exceed duration_s: 0.02"),
        ("schema_version: 1", "schema_version: true", "1:17: schema_version: must be 1, got true"),
        ("schema_version: 1", "schema_version: 1.0", "1:17: schema_version: must be 1, got 1.0"),
        ("duration_s: 10", "duration_s: .inf", "4:13: duration_s: must be finite, got inf"),
        ("duration_s: 10", "duration_s: 1_0", "4:13: duration_s: must be a number, got the text '1_0'"),
        ("duration_s: 10", "duration_s: true", "4:13: duration_s: must be a number, got true"),
        ("duration_s: 10", "duration_s:", "4:1: duration_s: must be a number, got nothing"),
        ("duration_s: 10", "duration_s: 2020-01-01", "4:13: duration_s: must be a number, got date"),
        ("duration_s: 10", "duration_s: !secret 3", "4:13: duration_s: cannot be read: "),
        ("hull.xml", ".", "3:8: model: . is a folder, not an MJCF file"),
        (
            "guidance:",
            "control: {attitude: {mode: path}}\nguidance:",
            "6:28: control.attitude.mode: unknown mode 'path'; did you mean along_path?",
        ),
        ("type: line", "type: lien", "5:14: path.type: unknown type 'lien'; did you mean line?"),
        (
            "type: line, ",
            "",
            f"5:7: path: needs the key type: one of {', '.join(PATH_TYPES)}",
        ),
        ("end_m: [4, 0, -5]", "end_m: [0, 0, -5]", "5:48: path.end_m: a line needs two different points"),
        ("end_m: [4, 0, -5]", "end_m: [4, 0, -5, 1]", "5:48: path.end_m: must have 3 entries, has 4"),
        ("end_m: [4, 0, -5]", "end_m: far", "5:48: path.end_m: must be a list, got the text 'far'"),
        ("guidance: {speed_m_s: 0.4}", "guidance: {}", "6:1: guidance.speed_m_s: this key is required"),
        ("guidance: {speed_m_s: 0.4}", "guidance: fast", "6:11: guidance: must be a block of keys, got the text"),
        ("guidance:", "thrusters: {dead_zone_N: [2, -2]}\nguidance:", "6:26: thrusters.dead_zone_N: must be"),
        ("guidance:", "seed: 1.5\nguidance:", "6:7: seed: must be a whole number, got 1.5"),
        ("guidance:", "seed: -1\nguidance:", "6:7: seed: must be at least 0, got -1"),
        ("reach_m: 0.5}", "reach_m: 0.5}\n  - {kind: path_end, reach_m: 1}", "9:5: checks.1: checks 0 and 1 are"),
        ("- {kind: path_end, reach_m: 0.5}", "[]", "8:3: checks: a run without checks shows nothing"),
        ("{kind: path_end, reach_m: 0.5}", "reach it", "8:5: checks.0: must be a block of keys, got the text"),
        ("kind: path_end, reach_m: 0.5", "kind: signal, signal: a.b, statistic: max", "8:5: checks.0: give exactly"),
        (
            "kind: path_end, reach_m: 0.5",
            "kind: signal, signal: a.b, statistic: max, at_most: 1, from_s: 5, to_s: 5",
            "8:78: checks.0.to_s: the window is empty",
        ),
        (
            "guidance:",
            "initial: {position_m: [1.0e+300, 0, 0]}\nguidance:",
            "6:24: initial.position_m.0: must be at most 100000, got 1e+300",
        ),
        ("name: short_line", "name: ../up", "2:7: name: must match "),
    ],
)  # fmt: skip
def test_one_mistake_one_line(tmp_path, old, new, expected):
    assert old in MINIMAL
    (line,) = mistakes(write(tmp_path, MINIMAL.replace(old, new)))
    assert line.startswith(f"mission.yaml:{expected}")


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "mission.yaml:1:1: the file is empty"),
        (b"# nothing but a remark\n", "mission.yaml:1:1: the file is empty"),
        (b"null", "mission.yaml:1:1: the file is empty"),
        (b"- 1\n", "mission.yaml:1:1: a scenario is a block of keys, this file holds a list"),
        (b"name: x\nmodel: \xff\xfe\n", "mission.yaml:2:8: not UTF-8 text (byte 0xff)"),
        (b"name: x\nmodel: \x00", "mission.yaml:2:8: not text: character '\\x00' is not allowed in YAML"),
        (b"<mujoco model='x'>\n  <!-- a: b -->\n</mujoco>", "mission.yaml:1:1: not valid YAML but XML: a scenario"),
        (b"name: [1,\n", "mission.yaml:2:1: not valid YAML: "),
        (b"name: x\n  model: y\n", "mission.yaml:2:8: not valid YAML: "),
        (b"name: x\n\tmodel: y\n", "mission.yaml:2:1: not valid YAML: "),
        (b"name: x\n---\nname: y\n", "mission.yaml:2:1: not valid YAML: "),
        (b"name: *nowhere\n", "mission.yaml:1:7: not valid YAML: found undefined alias 'nowhere'"),
        (b"[" * 1_000, "mission.yaml:1:61: nested more than 60 deep"),
        (b"[" * 100_000, "mission.yaml:1:61: nested more than 60 deep"),
    ],
)
def test_what_is_no_scenario_at_all(tmp_path, content, expected):
    (line,) = mistakes(write(tmp_path, content))
    assert line.startswith(expected)


def test_paths_that_are_no_files(tmp_path):
    os.mkfifo(tmp_path / "pipe.yaml")
    assert mistakes(tmp_path / "pipe.yaml") == ["pipe.yaml: is not a regular file, not a scenario file"]
    assert mistakes(tmp_path / "none.yaml") == ["none.yaml: cannot be read: No such file or directory"]
    (tmp_path / "table.yaml").write_text("0.1, 0.2\n" * 200_000)
    assert mistakes(tmp_path / "table.yaml") == ["table.yaml: is larger than 1000000 bytes, so it is no scenario file"]
    (tmp_path / "folder.yaml").mkdir()
    assert mistakes(tmp_path / "folder.yaml") == ["folder.yaml: is a folder, not a scenario file"]


def test_a_file_without_read_permission(tmp_path, monkeypatch):
    path = write(tmp_path)
    path.chmod(0)
    if os.access(path, os.R_OK):  # root may read every file
        refusal = PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        monkeypatch.setattr(type(path), "read_bytes", Mock(side_effect=refusal))
    assert mistakes(path) == ["mission.yaml: cannot be read: Permission denied"]


def test_aliases_that_grow_without_bound_are_refused():
    tower = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
        f"a{level}: &a{level} [{', '.join([f'*a{level - 1}'] * 10)}]\n" for level in range(1, 12)
    )
    document = parse(tower)
    (mistake,) = document.mistakes
    assert mistake.message == "aliases repeat more than 20000 values"
    assert 2 <= mistake.position.line <= 12
    (mistake,) = parse("a: &a [*a]").mistakes
    assert mistake.position == (1, 8, "")
    assert mistake.message == "an alias that contains itself"
    assert parse("a: &a {<<: *a, b: 1}").mistakes


def test_what_is_written_out_may_be_long(tmp_path):
    """A path of thousands of points is no tower of aliases."""
    points = "".join(f"    - [{0.5 * index}, {index % 2}, -5]\n" for index in range(7_000))
    text = MINIMAL.replace(
        "path: {type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}", f"path:\n  type: spline\n  points_m:\n{points}"
    )
    assert len(load(write(tmp_path, text)).scenario.path.points_m) == 7_000


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("name: short_line", 'name: "short_line', "2:7: not valid YAML: a quote that opens here is not closed"),
        ("name: short_line", "name: 'short_line", "2:7: not valid YAML: a quote that opens here is not closed"),
        (
            "name: short_line",
            'name: "short_line\ndescription: "of two"',
            "2:7: not valid YAML: a double quote that opens here closes only in line 3, amid other text",
        ),
        ("{speed_m_s: 0.4}", "{speed_m_s: 0.4", "6:11: not valid YAML: a '{' that opens here is not closed"),
        ("[0, 0, -5], end", "[0, 0, -5, end", "5:57: not valid YAML: expected ',' or ']', but got '}', for the '['"),
        ("0.5}", "0.5", "8:5: not valid YAML: a '{' that opens here is not closed"),
    ],
)
def test_what_is_not_closed_is_shown_where_it_opens(tmp_path, old, new, place):
    (line,) = mistakes(write(tmp_path, MINIMAL.replace(old, new)))
    assert line.startswith(f"mission.yaml:{place}")


def test_merge_keys_are_named_as_what_they_are(tmp_path):
    text = MINIMAL.replace(
        "guidance: {speed_m_s: 0.4}", "guidance:\n  <<: &slow {speed_m_s: 0.4}\n  stop_at_end: false"
    )
    (line,) = mistakes(write(tmp_path, text))
    assert line.startswith(
        "mission.yaml:7:3: guidance.<<: merge keys are not part of YAML 1.2; write the keys out, or "
    )


@pytest.mark.parametrize(
    ("text", "overrides", "expected"),
    [
        ("physics: {step_s: 0.015}", {}, "mission.yaml:5:19: physics.step_s: control_period_s: must be an integer mul"),
        ("", {"physics.step_s": 0.015}, "override physics.step_s: control_period_s: must be an integer multiple of"),
        ("control_period_s: 0.5\nphysics: {step_s: 0.5}\nnavigation: {imu: {}}", {},
         "mission.yaml:5:19: control_period_s: navigation.dvl.rate_hz: must be at most one reading per control period"),
    ],
)  # fmt: skip
def test_a_default_that_does_not_fit_is_shown_where_what_it_does_not_fit_stands(tmp_path, text, overrides, expected):
    lines = mistakes(write(tmp_path, MINIMAL.replace("duration_s: 10", f"duration_s: 10\n{text}")), overrides)
    assert lines[0].startswith(expected)


MAY_BE_BLOCKS = {
    ("parameters",),
    ("current_profile",),
    ("navigation",),
    ("battery",),
    ("control", "law"),
    ("allocation", "method"),
    ("guidance", "law"),
}
"""What is left out, or a name, or empty, and may be a block."""


def complete_file(folder) -> str:
    """A file in which every key is written: the resolved form of the first scenario."""
    return write(folder, load(SCENARIO_FILES[0]).resolved_yaml()).read_text()


def broken(lines, changes):
    """Text whose lines are changed: {line number: (column, length of what goes, what comes)}."""
    lines = list(lines)
    for line, (column, length, new) in changes.items():
        old = lines[line - 1]
        lines[line - 1] = old[: column - 1] + new + old[column - 1 + length :]
    return "\n".join(lines)


def test_every_value_is_checked_and_found_by_position(tmp_path):
    """Put a block, which no single value may be, in place of each value: one value per line at a time."""
    text = complete_file(tmp_path)
    lines = text.splitlines()
    document = parse(text)
    blocks = {location[:-1] for location in document.values if location}
    leaves = [location for location in document.values if location not in blocks]
    assert len(leaves) > 50
    rounds: list[dict[int, tuple]] = []
    for location in leaves:
        line, column, _ = document.values[location]
        tag = location[-1] in {"type", "kind", "mode"}
        # In a list the value ends at a comma or a bracket, elsewhere with the line. A wrong tag hides the
        # mistakes of its block: tags have a round of their own.
        value = lines[line - 1][column - 1 :]
        length = len(re.match(r"[^],]*", value)[0]) if isinstance(location[-1], int) else len(value)
        at = next((n for n, taken in enumerate(rounds) if n > 0 and line not in taken), len(rounds)) if not tag else 0
        while len(rounds) <= max(at, 1):
            rounds.append({})
        wrong = "1" if location in MAY_BE_BLOCKS else "{no: 1}"
        rounds[at][line] = (column, length, wrong, location)
    for changes in rounds:
        changed = broken(lines, {line: change[:3] for line, change in changes.items()})
        found = mistakes(write(tmp_path, changed))
        for line, (column, _, _, location) in changes.items():
            start = f"mission.yaml:{line}:{column}: {'.'.join(map(str, location))}: "
            assert any(item.startswith(start) for item in found), (location, found)


def test_every_misspelt_key_is_pointed_at_with_the_right_one(tmp_path):
    """Swap two letters of every key, one level of the file at a time."""
    text = complete_file(tmp_path)
    document = parse(text)
    tags = {"type", "kind", "mode"}
    keys = [location for location in document.keys if isinstance(location[-1], str) and location[-1] not in tags]
    keys = [location for location in keys if location[:-1] != ("setpoints",)]  # names of the vehicle's own
    assert len(keys) > 50
    for depth in sorted({len(location) for location in keys}):
        changes, expected = {}, []
        for location in keys:
            if len(location) == depth:
                key, (line, column, _) = str(location[-1]), document.keys[location]
                wrong = key[0] + key[2] + key[1] + key[3:]
                wrong = wrong if wrong != key else key[1] + key[0] + key[2:]
                changes[line] = (column, len(key), wrong)
                dotted = ".".join(map(str, (*location[:-1], wrong)))
                expected.append(f"mission.yaml:{line}:{column}: {dotted}: unknown key; did you mean {key}?")
        found = mistakes(write(tmp_path, broken(text.splitlines(), changes)))
        assert set(expected) <= set(found)


def test_a_mistake_found_after_loading_names_the_same_places(tmp_path):
    path = write(tmp_path)
    loaded = load(path, {"guidance.speed_m_s": 0.5})
    assert loaded.mistake("path.end_m", "too far") == f"{path}:5:48: path.end_m: too far"
    assert loaded.mistake("guidance.speed_m_s", "too fast") == "override guidance.speed_m_s: too fast"
    assert loaded.mistake("guidance.stop_time_s", "too long") == f"{path}:6:1: guidance.stop_time_s: too long"
    assert loaded.mistake("seed", "unlucky") == f"{path}:1:1: seed: unlucky"


WINDOWED = MINIMAL.replace(
    "{kind: path_end, reach_m: 0.5}",
    """kind: signal
    signal: path_error.cross_track
    statistic: max
    from_s: 4
    to_s: 8
    at_most: 0.1""",
)


EVENTFUL = """\
events:
  - {kind: current, at_s: 4, current_m_s: [0, 0.2, 0]}
checks:
  - kind: signal
    signal: path_error.cross_track
    statistic: settling
    band: [0, 0.1]
    from_event: 0
    at_most: 3
  - kind: before_after
    event: 0
    signal: path_error.cross_track
    statistic: rms
    before_s: 4
    after_s: 5
    delay_s: 1
    at_most: 0.1
  - kind: eventually
    within_s: 6
    from_event: 0
    all: [{signal: path_error.cross_track, at_most: 0.1}]
  - kind: ratio
    numerator: {signal: power.energy, statistic: increase, from_s: 1, to_event: 0, to_s: 2}
    denominator: {signal: target.arc_length, statistic: increase}
    at_most: 400
"""


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        ({}, None),
        ({"events.0.at_s": 4.1}, "mission.yaml:21:14: checks.1.after_s: the window after the event ends at 10.1 s,"
                                 " the run at 10 s"),
        ({"events.0.at_s": 3.9}, "mission.yaml:20:15: checks.1.before_s: the window before the event starts at -0.1 s,"
                                 " before the run"),
        ({"checks.0.at_most": 6}, "override checks.0.at_most: settling is timed in the window, which is 6 s long: 6 s"
                                  " must be less"),
        ({"checks.2.within_s": 6.5}, "override checks.2.within_s: 6.5 s after the start of the window, 4 s, the run has"
                                     " ended, at 10 s"),
        ({"checks.0.from_event": 1}, "override checks.0.from_event: no event 1; there are 0: current becomes"
                                     " [0, 0.2, 0] m/s"),
        ({"checks.1.event": "gust"}, "override checks.1.event: no event 'gust'; there are 0: current becomes"
                                     " [0, 0.2, 0] m/s"),
        ({"checks.3.numerator.to_s": -3.5}, "override checks.3.numerator.to_s: the window is empty: from_s 1 is not"
                                            " before to_s 0.5"),
        ({"checks.3.numerator.to_s": 7}, "override checks.3.numerator.to_s: the window ends at 11 s, the run at 10 s"),
        ({"checks.0.from_s": -5}, "override checks.0.from_s: the window starts at -1 s, before the run"),
    ],
)  # fmt: skip
def test_a_window_that_counts_from_an_event_lies_in_the_run(tmp_path, overrides, expected):
    path = write(tmp_path, MINIMAL[: MINIMAL.index("checks:")] + EVENTFUL)
    if expected is None:
        load(path, overrides)
    else:
        assert mistakes(path, overrides) == [expected]


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        ({}, None),
        ({"duration_s": 8}, None),
        ({"duration_s": 7.99}, "mission.yaml:12:11: checks.0.to_s: the window ends at 8 s, the run at 7.99 s"
                               " (override duration_s)"),
        ({"duration_s": 4}, "mission.yaml:11:13: checks.0.from_s: the window starts at 4 s, the run ends at 4 s"
                            " (override duration_s)"),
        ({"checks.0.to_s": 11}, "override checks.0.to_s: the window ends at 11 s, the run at 10 s"),
        ({"checks.0.from_s": 10, "checks.0.to_s": None},
         "override checks.0.from_s: the window starts at 10 s, the run ends at 10 s"),
    ],
)  # fmt: skip
def test_a_window_outside_the_run_is_a_mistake_before_it(tmp_path, overrides, expected):
    path = write(tmp_path, WINDOWED)
    if expected is None:
        load(path, overrides)
    else:
        assert mistakes(path, overrides) == [expected]


def test_a_run_too_long_to_record_is_a_mistake(tmp_path):
    overrides = {"duration_s": 86400, "physics.step_s": 0.001, "control_period_s": 0.001}
    (line,) = mistakes(write(tmp_path), overrides)
    assert line.startswith("override control_period_s: 86400 s in periods of 0.001 s are 8.64e+07; a run is recorded")
    assert load(write(tmp_path), {"duration_s": 86400}).scenario.ticks == 4_320_000


def test_the_example_of_a_mistake_in_the_readme_is_what_the_program_prints(tmp_path):
    folder = tmp_path / "scenarios"
    folder.mkdir()
    text = HELIX.read_text().replace("../models", str(MODELS))
    (line,) = mistakes(write(folder, text.replace("  speed_m_s", "  sped_m_s"), "x.yaml"))
    assert f"```\nscenarios/{line}\n```" in (REPO / "README.md").read_text()


STOP = "kind: signal, signal: pose.position, component: 0"
SHARE = "kind: signal, signal: pose.position, statistic: share_above, level: 1"


@pytest.mark.parametrize(
    ("key", "item", "expected"),
    [
        (
            "events",
            "kind: thrusters, at_s: 1, thrusters: [T1, T1], state: dead",
            "events.0.thrusters.1: T1 is",
        ),
        ("events", "kind: thrusters, at_s: 1, thrusters: [T1], state: dead, efficiency: 0.5", "events.0.efficiency: "),
        ("stop", f"{STOP}, above: 1, below: 2, verdict: pass", "stop.0.below: give exactly one limit"),
        ("stop", f"{STOP}, above: 1, from_s: 10, verdict: pass", "stop.0.from_s: 10 s is not before the end of the"),
        (
            "stop",
            f"{STOP}, above: 1, from_s: 6, for_s: 5, verdict: pass",
            "stop.0.for_s: from 6 s on it can hold for 4",
        ),
        ("checks", f"{SHARE}, at_most: 1", "checks.0.at_most: share_above is 1 at most"),
        ("checks", f"{SHARE}, at_least: 0", "checks.0.at_least: share_above is never negative"),
        ("checks", f"{SHARE}, at_least: 0.1, at_most: 0.2", "checks.0.at_least: give exactly one limit"),
        ("checks", f"{SHARE}, at_most: 0.2, minus: pose.position", "checks.0.minus: a signal less itself"),
        (
            "checks",
            "kind: always, all: [{signal: pose.position, minus: pose.position, at_most: 1}]",
            "checks.0.all.0.minus: a signal less itself",
        ),
    ],
)
def test_what_can_only_be_meant_otherwise_is_refused_in_place(key, item, expected, tmp_path):
    text = MINIMAL.partition("checks:")[0] if key == "checks" else MINIMAL
    (found,) = mistakes(write(tmp_path, f"{text}{key}:\n  - {{{item}}}\n"))
    assert expected in found
    word = expected.partition(":")[0].split(".")[-1]
    line, column = (int(number) for number in found.split(":")[1:3])
    if not word.isdigit():
        written = (text + f"{key}:\n  - {{{item}}}\n").splitlines()[line - 1][: column - 1]
        assert written.endswith(f"{word}: ")


def test_two_events_or_two_stops_of_one_name_are_refused(tmp_path):
    event = "{kind: current, name: tide, at_s: 1, current_m_s: [0, 0.1, 0]}"
    stop = f"{{{STOP}, name: far, above: 1, verdict: pass}}"
    for key, item, name in (("events", event, "tide"), ("stop", stop, "far")):
        (found,) = mistakes(write(tmp_path, f"{MINIMAL}{key}: [{item}, {item}]\n"))
        assert f"{key}.1.name: {key} 0 and 1 are both called '{name}'" in found
