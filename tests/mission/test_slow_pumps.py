"""Set-points that a pump is too slow for are told beforehand, by what it has pumped until then."""

from __future__ import annotations

import json

import pytest
from support.ballasted import ballasted

from cube_sim.mission.first_warnings import first_warnings
from cube_sim.mission.prepare import prepare
from cube_sim.scenario import load


def told(folder, table, **changes):
    mission = ballasted(folder, setpoints={"tank": table}, events=[], **changes)
    (folder / "mission.yaml").write_text(json.dumps(mission | {"checks": [{"kind": "allowed_forces"}]}))
    return [text for text in first_warnings(prepare(load(folder / "mission.yaml"))) if text.startswith("the pump")]


def test_a_ramp_that_is_too_steep(tmp_path):
    """1 l in 2 s of a pump that moves 0.1 l/s."""
    assert told(tmp_path, {"times_s": [1, 3], "values": [0.0, 1e-3]}) == [
        "the pump 'tank' moves 0.1 l/s: told to have 1 l at 3.00 s it has 0.2 l then"
    ]


@pytest.mark.parametrize("between", ["held", "linear"])
def test_what_it_can_keep_is_no_news(tmp_path, between):
    table = {"times_s": [0, 5.5, 11], "values": [0.0, 5e-4, 5e-4], "between": between}
    assert told(tmp_path, table) == []


def test_a_step_is_news_where_the_run_ends_before_it_is_made(tmp_path):
    """2 l told at 6 s, of which 0.6 l are there after 12 s."""
    assert told(tmp_path, {"times_s": [0, 6], "values": [0.0, 2e-3], "between": "held"}) == [
        "the pump 'tank' moves 0.1 l/s: told to have 2 l at 12.00 s it has 0.6 l then"
    ]
