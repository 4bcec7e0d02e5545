"""Vehicles whose attitude has to point their thrust, in flight: what the analysis says yes to flies."""

from __future__ import annotations

import pytest
from flights.sweep import swept

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
    row = swept(name, path, tmp_path, keep=False)
    assert row["forecast"]
    assert row["passes"], f"{row['rms_m']:.3f} m RMS: {row['cause']}"
