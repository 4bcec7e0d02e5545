"""Vehicles whose attitude has to point their thrust, in flight: what the analysis says yes to flies."""

from __future__ import annotations

import pytest
from flights.sampled import sampled
from flights.trial import trial_of
from support.places import REPO

from cube_sim import run

pytestmark = pytest.mark.flight

FLIGHTS = [
    ("three_astern_up", "helix"),  # level is unstable at this speed: it goes nose up or nose down
    pytest.param("torpedo_four_fins", "helix", marks=pytest.mark.campaign),  # its fins push it the wrong way first
    pytest.param("drawn3_0", "helix", marks=pytest.mark.campaign),  # its righting moment is nearly used up
    pytest.param("drawn4_0", "line", marks=pytest.mark.campaign),
    ("six_octahedron-T1", "line"),  # a side force of its stern turns it, and little thrust points it
    pytest.param("drawn6_3", "helix", marks=pytest.mark.campaign),  # sideways it is too costly to push, not impossible
    pytest.param("six_octahedron-T1", "helix", marks=pytest.mark.campaign),
]


@pytest.mark.parametrize(("name", "path"), FLIGHTS)
def test_what_the_analysis_says_yes_to_flies(name, path, tmp_path):
    overrides, notes = sampled(trial_of(name, path, tmp_path / "model"))
    assert notes["forecast"]
    flown = run(REPO / "benchmarks" / "catalogue.yaml", {**overrides, "samples": None}, tmp_path / "run", record="none")
    assert flown.verdict == "PASS", flown.checks
