"""Fins that fail in flight: told or not, the others hold the path where they can, and it is said where they cannot."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.finned import mission_of, x_tail
from support.places import SCENARIOS

from cube_sim.control.authority import Authority
from cube_sim.errors import ScenarioError
from cube_sim.flight import Flight

LINE = SCENARIOS / "remus100_line.yaml"
FAULTS = {
    "jammed": {},
    "at 0": {"state": "jammed", "angle_deg": 0},
    "at 5": {"state": "jammed", "angle_deg": 5},
    "at 10": {"state": "jammed", "angle_deg": 10},
    "loose": {"state": "loose"},
    "slow": {"state": "slow", "rate_deg_s": 2},
    "short": {"state": "short", "travel_deg": [-2, 2]},
}


def event(at_s=20.0, fin="x1", **what):
    return {"kind": "fins", "at_s": at_s, "fins": [fin], "state": "jammed", **what}


@pytest.fixture
def mission(tmp_path):
    model = tmp_path / "x_tail.xml"
    model.write_text(x_tail())
    return mission_of(model) | {"control": {"faults": "told"}}


def off_path(flight, from_s):
    rows = flight.signals["path_error.cross_track"]
    return rows[rows[:, 0] >= from_s, 1]


@pytest.mark.parametrize("fault", FAULTS, ids=str)
@pytest.mark.parametrize("fin", ["x1", "x3"])
def test_an_x_tail_flies_on_with_three_fins(mission, fault, fin):
    """Told, within millimetres of its path; untold, within decimetres until the observer has learned it."""
    worst = {}
    for faults in ("told", "ignored"):
        events = [event(40.0, fin, **FAULTS[fault])]
        flight = Flight({**mission, "duration_s": 80, "events": events, "control": {"faults": faults}})
        flight.fly_to_its_end()
        assert not flight.ended
        worst[faults] = off_path(flight, 40).max()
        k = flight.mission.fins.fins.names.index(fin)
        had = np.degrees(flight.signals["fins.deflection"][-1, 1 + k])
        if "angle_deg" in FAULTS[fault]:
            assert had == pytest.approx(FAULTS[fault]["angle_deg"], abs=1e-3)
    assert worst["told"] < 0.01
    assert worst["told"] < 0.25 * worst["ignored"]
    assert worst["ignored"] < 0.3
    assert off_path(flight, 70).max() < 0.03  # untold, the observer of the disturbance learns it


@pytest.mark.parametrize("fault", ["at 10", "loose", "slow"])
@pytest.mark.parametrize("faults", ["told", "ignored"])
def test_both_loops_fly_the_same(mission, fault, faults, monkeypatch):
    changes = {"duration_s": 8, "events": [event(2.5, **FAULTS[fault])], "control": {"faults": faults}}
    moving = {"current_m_s": [0.0, 0.2, 0.05], "knowledge": {"fins": 0.8}}
    assert assert_same_flight({**mission, **changes, **moving}, {}, monkeypatch) > 0.8


def test_what_is_recorded_and_said(mission):
    events = [event(1.0, "x2", angle_deg=5), event(2.0, "x4", state="loose"), event(3.0, "x2", state="recovered")]
    flight = Flight({**mission, "duration_s": 4, "events": events})
    flight.fly_to_its_end()
    rows = flight.signals["fin_health.state"]
    assert rows[-1, 1:].tolist() == [0.0, 0.0, 0.0, 4.0]
    assert [0.0, 3.0, 0.0, 4.0] in rows[:, 1:].tolist()
    assert flight.signals["fin_health.believed"][-1, 1:].tolist() == [0.0, 0.0, 0.0, 4.0]
    said = [line.text for line in flight.log if "x2" in line.text or "x4" in line.text]
    assert said[0] == "x2: jammed at 5 deg"
    assert said[1].startswith("x2 jammed at 5.0 deg; LINE")
    assert said[2] == "x4: loose"
    assert any(text.startswith("x2 jammed at 5.0 deg, x4 loose; ") for text in said)
    assert any(text.startswith("x4 loose; ") for text in said)


def test_untold_nobody_believes_it(mission):
    flight = Flight({**mission, "duration_s": 3, "events": [event(1.0)], "control": {"faults": "ignored"}})
    flight.fly_to_its_end()
    assert flight.signals["fin_health.state"][-1, 1] == 3.0
    assert not flight.signals["fin_health.believed"][:, 1:].any()


def test_a_snapshot_flies_on_the_same(mission):
    one = Flight({**mission, "events": [event(1.0, angle_deg=8)]})
    one.fly(100)
    kept = one.snapshot()
    one.fly(60)
    first = one.signals["fins.deflection"][-60:].tobytes()
    one.restore(kept)
    one.fly(60)
    assert one.signals["fins.deflection"][-60:].tobytes() == first
    one.reset()
    one.fly(20)
    assert not one.mission.events.fin_health.jammed.any()
    assert np.abs(one.signals["fins.deflection"][:, 1]).max() > 0.0


@pytest.mark.parametrize("fin", ["rudder", "stern_planes"])
def test_a_cruciform_pair_that_jams_leaves_nothing_that_turns_it(fin):
    """One stock for both halves: nothing else makes that torque. It is said at once, and the path is given up."""
    changes = {"events": [event(5.0, fin, angle_deg=5)], "control.faults": "told", "duration_s": 8}
    flight = Flight(LINE, {**changes, "checks": [{"kind": "allowed_forces"}]})
    flight.fly_to_its_end()
    told = next(line.text for line in flight.log if line.text.startswith(f"{fin} jammed"))
    assert f"{Authority.SAFE.name}: " in told
    assert "the others make up for " in told


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ({"fins": ["x9"]}, "no fin 'x9'; the model has x1, x2, x3, x4"),
        ({"fins": ["propeller"]}, "is a thruster, which fails by an event of kind: thrusters"),
        ({"fins": ["x1", "x1"]}, "x1 is named twice"),
        ({"fins": []}, "at least one fin"),
        ({"angle_deg": 30}, "x1 turns from -20.05 to 20.05 deg, not to 30 deg"),
        ({"state": "short", "travel_deg": [-30, 5]}, "not to -30 deg"),
        ({"state": "short", "travel_deg": [5, -5]}, "must increase"),
        ({"state": "short"}, "travel_deg and state short go together"),
        ({"state": "slow"}, "rate_deg_s and state slow go together"),
        ({"rate_deg_s": 3}, "rate_deg_s and state slow go together"),
        ({"state": "loose", "angle_deg": 3}, "is that of a jammed fin"),
        ({"at_s": 99}, "before the end of the run"),
    ],
)
def test_one_line_says_what_is_wrong(mission, what, words):
    with pytest.raises(ScenarioError) as told:
        Flight({**mission, "events": [event(**what)]})
    assert words in str(told.value)
    assert "\n" not in str(told.value).strip()
