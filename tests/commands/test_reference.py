"""The pages docs/scenario.md and docs/recording.md: made from the code, complete, and their examples fly."""

from __future__ import annotations

import json
import re

import pytest
from support.command_line import call
from support.places import MODELS, REPO

from cube_sim.commands.pages import scenario_examples
from cube_sim.commands.pages.markdown import anchor
from cube_sim.commands.pages.recording_page import WRITTEN_BY, recording_page
from cube_sim.commands.pages.scenario_page import scenario_page
from cube_sim.commands.pages.schema_words import allowed, number, unit_and_meaning
from cube_sim.mission import prepare
from cube_sim.recording.channels import channel_table
from cube_sim.recording.navigation_channels import READINGS, navigation_channels
from cube_sim.scenario import Scenario, load
from cube_sim.scenario.document import parse

PAGES = {"scenario": scenario_page, "recording": recording_page}


@pytest.mark.parametrize("page", PAGES)
def test_the_committed_page_is_the_generated_one(page, monkeypatch, capsys):
    committed = (REPO / "docs" / f"{page}.md").read_text()
    assert committed == PAGES[page](), f"write it anew: cube-sim reference {page} > docs/{page}.md"
    assert call(monkeypatch, capsys, "reference", page) == (0, committed, "")


@pytest.mark.parametrize("page", PAGES)
def test_every_link_has_its_heading(page):
    text = PAGES[page]()
    headings = [anchor(title) for title in re.findall(r"^#+ (.*)$", text, re.MULTILINE)]
    assert len(set(headings)) == len(headings)
    links = set(re.findall(r"\]\(#([^)]*)\)", text))
    assert links
    assert links <= set(headings)


def test_every_key_of_the_schema_has_a_row():
    """A block that is used in one place has one table, so rows are counted by key."""
    schema = Scenario.model_json_schema()
    tags = {"type", "kind", "mode", "distribution"}
    keys = sorted(
        name for block in (schema, *schema["$defs"].values()) for name in block["properties"] if name not in tags
    )
    rows = re.findall(r"^\| `(\w+)` \| [^|]* \| (?:required|its defaults|`.*`) \|", scenario_page(), re.MULTILINE)
    assert sorted(rows) == keys


def test_readers_are_not_shown_classes():
    assert not re.search(r"\w(Block|Check|Event)\b", scenario_page())


def test_a_unit_in_a_key_is_a_unit_in_its_row():
    endings = {"_m": "m", "_s": "s", "_m_s": "m/s", "_N": "N", "_deg": "deg", "_deg_s": "deg/s", "_per_s": "1/s"}
    endings["_N_m"] = "N m"
    found = 0
    for name, unit in re.findall(r"^\| `(\w+)` \| ([^|`]*) \|", scenario_page(), re.MULTILINE):
        ending = max((end for end in endings if name.endswith(end)), key=len, default=None)
        if ending and not name.endswith("_per_m"):
            assert unit == endings[ending], name
            found += 1
    assert found > 40


@pytest.mark.parametrize(
    ("schema", "words"),
    [
        ({"type": "number"}, "number"),
        ({"type": "number", "exclusiveMinimum": 0, "maximum": 86400}, "number > 0, ≤ 86400"),
        ({"anyOf": [{"type": "integer", "minimum": 0}, {"type": "null"}]}, "whole number ≥ 0 or `null`"),
        ({"enum": ["a", "b"], "type": "string"}, "`a`, `b`"),
        ({"type": "array", "prefixItems": [{"type": "number", "minimum": -1, "maximum": 1}] * 3},
         "list of 3 numbers, each -1 to 1"),
    ],
)  # fmt: skip
def test_what_is_allowed_is_said_in_words(schema, words):
    assert allowed(schema) == words


def test_a_schema_without_words_is_noticed():
    with pytest.raises(ValueError, match="nothing says in words"):
        allowed({"type": "object"})


@pytest.mark.parametrize(
    ("value", "text"), [(60.0, "60"), (0.3, "0.3"), (1e-6, "1e-6"), (100000, "1e5"), (2**63, "2^63"), (0, "0")]
)
def test_numbers_are_short(value, text):
    assert number(value) == text


def test_units_are_told_from_lists():
    assert unit_and_meaning("[roll, pitch, yaw], as elsewhere [deg].") == ("deg", "[roll, pitch, yaw], as elsewhere.")
    assert unit_and_meaning("Density [m/s^3/sqrt(Hz)].") == ("m/s^3/sqrt(Hz)", "Density.")
    assert unit_and_meaning("Names, for example [T1].") == ("", "Names, for example [T1].")


@pytest.mark.parametrize("where", ["", *scenario_examples.BLOCKS])
def test_every_example_can_be_flown(where, tmp_path):
    content = parse(scenario_examples.WHOLE).data
    if where:
        shown = parse(scenario_examples.BLOCKS[where]).data
        assert list(shown)[-1] == re.split("[.:]", where)[0]
        content |= shown
    if where in ("phases", "waypoints"):
        del content["path"]
    elif content["path"].get("laps") or content["path"]["type"] == "point":
        content["initial"] = {"position_m": [0, 0, -5]}
    (tmp_path / "scenarios").mkdir()
    (tmp_path / "models").symlink_to(MODELS)
    (tmp_path / "scenarios" / "survey.csv").write_text("x_m,y_m,z_m\n0,0,-5\n8,0,-5\n8,8,-5\n")
    path = tmp_path / "scenarios" / "mission.yaml"
    path.write_text(json.dumps(content))
    prepare(load(path))


def test_every_channel_says_who_writes_it():
    sensors = dict.fromkeys(READINGS, 1.0)
    told = {"setpoints": ("A1",), "setpoint_units": (("m", "m"),), "failing": ("F1",)}
    told |= {"joint_positions": (("J1", "m"),), "joint_velocities": (("J1", "m/s"),)}
    channels = (
        *channel_table(("T1",), 2, pushed=True, phases=("leg",), timed=True, fins=("F1",), **told),
        *navigation_channels(sensors),
    )
    assert {channel.name for channel in channels} == WRITTEN_BY.keys()
    text = recording_page()
    for channel in channels:
        section = text[text.index(f"### `{channel.name}`\n") :].partition("\n#")[0]
        assert re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE) == [field.name for field in channel.fields]
