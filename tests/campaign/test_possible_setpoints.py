"""Samples of set-points that no actuator follows are refused before anything flies, those that some may fly are not."""

import json

import pytest
from support.ballasted import ballasted

from cube_sim.campaign.sampling import SamplePlan
from cube_sim.errors import ScenarioError
from cube_sim.scenario import load

TABLE, EVENT = "setpoints.tank.values.0", "events.0.value"  # of the tank, 0 to 0.002 m^3; of the bladder, -1 to 1 l


def asked(folder, path, distribution):
    given = ballasted(folder, samples={"count": 3, "vary": {path: distribution}})
    file = folder / "mission.json"
    file.write_text(json.dumps(given))
    SamplePlan(load(file)).require_possible()


@pytest.mark.parametrize(
    ("path", "distribution", "told"),
    [
        (
            TABLE,
            {"distribution": "uniform", "low": 0.5, "high": 1.0},
            "gives 0.5 to 1, and tank follows 0 to 0.002 m^3",
        ),
        (TABLE, {"distribution": "sobol", "low": -2.0, "high": -1.0}, "gives -2 to -1, and tank follows"),
        (TABLE, {"distribution": "normal", "mean": 1.0, "std": 0.01}, "gives 0.94 to 1.06, and tank follows"),
        (
            TABLE,
            {"distribution": "uniform", "gives": "percent", "low": 900, "high": 950},
            "gives 0.005 to 0.00525, and",
        ),
        (TABLE, {"distribution": "choice", "values": [-1.0, 1.0]}, "gives -1 to 1, and tank follows"),
        (
            EVENT,
            {"distribution": "grid", "values": [0.4, 0.5]},
            "gives 0.4 to 0.5, and bladder follows -0.001 to 0.001",
        ),
        (
            "setpoints.tank.values",
            {"distribution": "choice", "values": [[0.0, 0.0, 3.0], [0.0, 2.0, 0.0]]},
            "gives 0 to 3, and tank follows",
        ),
    ],
)
def test_values_all_beyond_the_range_are_refused(path, distribution, told, tmp_path):
    with pytest.raises(ScenarioError) as refused:
        asked(tmp_path, path, distribution)
    (line,) = refused.value.mistakes
    assert f"samples.vary.{path}: {told}" in line
    assert line.endswith(": no sample of it can be flown")


@pytest.mark.parametrize(
    ("path", "distribution"),
    [
        (TABLE, {"distribution": "uniform", "low": 0.0, "high": 1.0}),
        (TABLE, {"distribution": "uniform", "low": -1.0, "high": 1.0}),
        (TABLE, {"distribution": "choice", "values": [-1.0, 1e-3]}),
        (EVENT, {"distribution": "normal", "mean": 0.0, "std": 1.0}),
        ("setpoints.tank.values", {"distribution": "choice", "values": [[0.0, 0.0, 3.0], [0.0, 1e-3, 0.0]]}),
        ("setpoints.tank.times_s.1", {"distribution": "uniform", "low": 3.0, "high": 4.0}),
        ("guidance.speed_m_s", {"distribution": "uniform", "low": 0.3, "high": 0.4}),
    ],
)
def test_values_of_which_some_are_followed_are_not(path, distribution, tmp_path):
    asked(tmp_path, path, distribution)
