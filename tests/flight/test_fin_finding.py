"""Faults of fins that nobody tells of, in flight: found by either loop, and never where there are none."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.finned import mission_of, x_tail
from support.places import SCENARIO_FILES, SCENARIOS

from cube_sim.flight import Flight

pytestmark = pytest.mark.flight

FINNED = [path for path in SCENARIO_FILES if path.stem.startswith(("remus100", "nps_auv2"))]


WEAVE = {"type": "sinusoid", "start_m": [0, 0, -10], "heading_deg": 0, "amplitude_m": 1.5, "wavelength_m": 12.0,
         "periods": 8}  # fmt: skip
DIVE = {"type": "helix", "centre_m": [0, 10, -10], "radius_m": 10.0, "pitch_m": -4.0, "turns": 3}


@pytest.fixture
def mission(tmp_path):
    model = tmp_path / "x_tail.xml"
    model.write_text(x_tail())
    return mission_of(model)


@pytest.mark.parametrize("wrong", [{}, {"current_m_s": [0.1, -0.15, 0.02]}, {"knowledge.fins": 0.7}], ids=str)
@pytest.mark.parametrize("path", FINNED, ids=lambda path: path.stem)
def test_a_healthy_fin_is_never_doubted(path, wrong):
    flight = Flight(path, wrong)
    flight.fly_to_its_end()
    assert not flight.mission.fin_finding.found.codes.any()
    assert not flight.mission.events.fins_told.codes.any()


@pytest.mark.parametrize(
    "layout", [{"area": 0.006}, {"bow_planes": True}, {"side_thrusters": True}, {"makes_roll": False}]
)
@pytest.mark.parametrize("path", [WEAVE, DIVE], ids=["weave", "dive"])
def test_drawn_tails_are_not_doubted_in_shear_that_turns(mission, layout, path):
    with open(mission["model"], "w") as file:
        file.write(x_tail(**layout))
    water = {"depths_m": [0.0, 20.0], "velocities_m_s": [[0.2, -0.1, 0.0], [-0.1, 0.2, 0.0]]}
    turns = {"kind": "current", "at_s": 15, "over_s": 5, "current_m_s": [0.0, 0.25, 0.05]}
    wrong = {"fins": 1.3, "drag": 0.7}
    flight = Flight(mission | {"path": path, "current_profile": water, "events": [turns], "knowledge": wrong})
    flight.fly_to_its_end()
    assert not flight.mission.fin_finding.found.codes.any()
    assert np.abs(flight.signals["fins.deflection"][:, 1:]).max() > 0.1


@pytest.mark.parametrize("state", ["jammed", "loose", "short"])
def test_both_loops_find_the_same(mission, state, monkeypatch):
    more = {"short": {"travel_deg": [-1, 1]}, "jammed": {"angle_deg": 8}}.get(state, {})
    event = {"kind": "fins", "at_s": 3.5, "fins": ["x1"], "state": state, **more}
    changes = {"duration_s": 16, "events": [event], "path": WEAVE, "current_m_s": [0.0, 0.1, 0.0]}
    assert assert_same_flight({**mission, **changes}, {}, monkeypatch) > 0.7


def test_a_jammed_fin_is_found_and_the_others_go_on(mission):
    """Within decimetres of its path until it is found, millimetres at the end."""
    event = {"kind": "fins", "at_s": 20.0, "fins": ["x3"], "state": "jammed", "angle_deg": 10}
    flight = Flight({**mission, "duration_s": 80, "events": [event]})
    flight.fly_to_its_end()
    believed = flight.signals["fin_health.believed"]
    k = flight.mission.fins.fins.names.index("x3")
    assert believed[-1, 1 + k] >= 2.0
    found_s = believed[believed[:, 1 + k] > 0.0, 0][0]
    assert 20.0 < found_s < 24.0
    off = flight.signals["path_error.cross_track"]
    assert off[off[:, 0] > 70.0, 1].max() < 0.02
    said = [line.text for line in flight.log if line.t == found_s]
    assert any(text.startswith("x3 ") for text in said)


def test_a_snapshot_goes_on_to_the_bit(mission):
    event = {"kind": "fins", "at_s": 3.0, "fins": ["x3"], "state": "jammed", "angle_deg": 10}
    one = Flight({**mission, "events": [event]})
    one.fly(165)
    kept = one.snapshot()
    one.fly(150)
    first = one.signals["fins.deflection"][-150:].copy()
    one.restore(kept)
    one.fly(150)
    assert np.array_equal(one.signals["fins.deflection"][-150:], first)
    assert one.mission.fin_finding.found.codes.any()


@pytest.mark.parametrize("fault", [{"state": "loose"}, {"state": "jammed", "angle_deg": 4}], ids=str)
def test_what_leaves_no_way_to_steer_is_told_and_not_given_in_to(fault):
    """A cruciform tail has nothing beside its rudder: it flies as if nobody looked, and is back once that is."""
    events = [{"kind": "fins", "at_s": 30.0, "fins": ["rudder"], **fault},
              {"kind": "fins", "at_s": 36.0, "fins": ["rudder"], "state": "recovered"}]  # fmt: skip
    flown = {}
    for faults in ("diagnosed", "ignored"):
        flight = Flight(SCENARIOS / "remus100_line.yaml", {"events": events, "control.faults": faults})
        flight.fly_to_its_end()
        flown[faults] = flight
    found, ignored = flown["diagnosed"], flown["ignored"]
    off = found.signals["path_error.cross_track"]
    assert np.array_equal(off, ignored.signals["path_error.cross_track"])
    assert off[off[:, 0] > 30.0, 1].max() > 1.0
    assert off[-1, 1] < 0.05
    said = [line.text for line in found.log if "as if all were whole" in line.text]
    assert said
    assert all(text.startswith("rudder ") for text in said)
    assert not any("as if all were whole" in line.text for line in ignored.log)
