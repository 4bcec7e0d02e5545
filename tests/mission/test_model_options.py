"""What a model's file says of step and current, and its scenario does not take over, is told before the flight."""

from __future__ import annotations

import pytest
from support.edited_cube import edited_text
from support.places import SCENARIO_FILES
from support.scenario_files import FLIGHT

from cube_sim.mission.model_options import option_words
from cube_sim.scenario import load

STEP = "its model's file has timestep 0.002, and steps of 0.01 s are flown: a scenario says them by physics.step_s"
WIND = "its model's file has wind 0 0.5 0, and the water is at rest: a scenario says its current by current_m_s"


@pytest.mark.parametrize(
    ("option", "changes", "said"),
    [
        ('timestep="0.002"', {}, [STEP]),
        ('timestep="0.002"', {"physics": {"step_s": 0.002}}, []),
        ('timestep="0.02"', {}, []),
        ('wind="0 0.5 0"', {}, [WIND]),
        ('wind="0 0.5 0"', {"current_m_s": [0.1, 0, 0]}, []),
        ('timestep="0.002" wind="0 0.5 0"', {}, [STEP, WIND]),
    ],
)
def test_what_is_left_out_is_told(option, changes, said, tmp_path):
    text = edited_text()
    start = text.index("<option")
    (tmp_path / "hull.xml").write_text(text[:start] + f"<option {option}/>" + text[text.index("/>", start) + 2 :])
    (tmp_path / "mission.yaml").write_text(FLIGHT)
    loaded = load(tmp_path / "mission.yaml", {"model": str(tmp_path / "hull.xml")} | changes)
    assert option_words(loaded.scenario) == said


@pytest.mark.parametrize("scenario", SCENARIO_FILES, ids=lambda path: path.stem)
def test_scenarios_of_the_repository_have_nothing_to_tell(scenario):
    assert option_words(load(scenario).scenario) == []
