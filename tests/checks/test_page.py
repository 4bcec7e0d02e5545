"""docs/checks.md: its checks are those there are, can be flown as they stand, and are judged."""

from __future__ import annotations

import json
import re
from typing import get_args

import pytest
from support.places import MODELS, REPO

import cube_sim
from cube_sim.commands.pages import scenario_examples
from cube_sim.mission import prepare
from cube_sim.runs.judged_record import judged_record
from cube_sim.scenario import load, load_mapping
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.scenario.document import parse
from cube_sim.scenario.statistic_keys import NEEDS, Statistic

PAGE = (REPO / "docs" / "checks.md").read_text(encoding="utf-8")
EXAMPLES = [parse(text).data for text in re.findall(r"^```yaml\n(.*?)^```", PAGE, re.M | re.S)]

WAYPOINTS = next(example["waypoints"] for example in EXAMPLES if "waypoints" in example)


def scenario(example):
    model = str(MODELS / "cube.xml")
    whole = {**parse(scenario_examples.WHOLE).data, "model": model, **example}
    return {key: value for key, value in whole.items() if key != "path" or "waypoints" not in example}


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with an earlier run that is called reference."""
    folder = tmp_path_factory.mktemp("page")
    cube_sim.fly(load_mapping(scenario({})), out=folder / "reference", record="mcap")
    return folder


@pytest.mark.flight
@pytest.mark.parametrize("example", EXAMPLES, ids=range(len(EXAMPLES)))
def test_every_example_can_be_flown(example, place):
    assert set(example) <= {"events", "waypoints", "checks"}
    (place / "mission.yaml").write_text(json.dumps(scenario(example)))
    assert len(prepare(load(place / "mission.yaml")).scenario.checks) == len(example["checks"])


def test_the_page_has_every_statistic_and_what_it_needs():
    rows = dict(re.findall(r"^\| (`[a-z_]+`.*?) \| (.*)$", PAGE, re.M))
    first = " ".join(rows)
    assert set(re.findall(r"`([a-z_]+)`", first)) >= set(get_args(Statistic))
    for statistic, key in NEEDS.items():
        cell = next(cell for cell in rows if f"`{statistic}`" in cell)
        assert key in cell, statistic


def test_the_page_shows_every_kind():
    kinds = {get_args(block.model_fields["kind"].annotation)[0] for block in get_args(get_args(AnyCheck)[0])}
    assert {check["kind"] for example in EXAMPLES for check in example["checks"]} == kinds


@pytest.mark.flight
def test_every_check_of_the_page_is_judged_and_passes(place, tmp_path):
    events = [event for example in EXAMPLES for event in example.get("events", ())]
    assert all(event == events[0] for event in events)
    for name, more in (("whole", {}), ("lost", {"events": events[:1]}), ("phases", {"waypoints": WAYPOINTS})):
        chosen = [e for e in EXAMPLES if set(e) - {"checks"} == set(more)]
        checks = [check for example in chosen for check in example["checks"]]
        (place / "mission.yaml").write_text(json.dumps(scenario({**more, "checks": checks})))
        mission = load(place / "mission.yaml")
        kept = cube_sim.fly(mission, out=tmp_path / name, record="mcap")
        assert {check.name: check.verdict for check in kept.checks if check.verdict != "PASS"} == {}
        assert all(check.unit and check.margin is not None for check in kept.checks)
        judged = cube_sim.fly(mission, out=tmp_path / f"{name} alone", record="none", keep_signals=False)
        assert judged.checks == kept.checks
        again = judged_record(tmp_path / name, lambda run: None)
        assert again.results == cube_sim.load_run(tmp_path / name).checks == kept.checks
