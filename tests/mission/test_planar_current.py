"""The planar law flown in a current, as a scenario asks for it: estimated, known, or as in still water."""

from __future__ import annotations

import numpy as np
import pytest
from support.places import HELIX, SCENARIOS

import cube_sim
from cube_sim.control.planar.follower import PlanarFollower
from cube_sim.errors import ScenarioError
from cube_sim.mission import prepare
from cube_sim.scenario import load

LINE, CIRCLE = SCENARIOS / "infante_line_current.yaml", SCENARIOS / "infante_circle_current.yaml"
AS_PUBLISHED = {"control.disturbance_time_s": None, "control.current_time_s": None}
KNOWN = {**AS_PUBLISHED, "knowledge.current_m_s": [0.0, 0.3, 0.0]}
NEAR = {"duration_s": 70, "initial.velocity_m_s": [1.4, 0.0, 0.0], "checks": [{"kind": "allowed_forces"}]}
ON_THE_CIRCLE = {**NEAR, "initial.position_m": [12.0, 0.0, -5.0], "initial.attitude_deg": [0.0, 0.0, 90.0]}


def standing_error(scenario, changes, out):
    """Cross-track RMS [m] from 40 s on."""
    track = cube_sim.run(scenario, changes, out=out).signals["path_error.cross_track"]
    late = track[track[:, 0] >= 40.0, 1]
    return float(np.sqrt(np.mean(late**2)))


@pytest.mark.flight
def test_on_a_circle_a_current_is_held_off_unknown_and_known_and_not_by_the_law_of_still_water(tmp_path):
    unknown, known, published = (
        standing_error(CIRCLE, {**ON_THE_CIRCLE, **changes}, tmp_path / str(i))
        for i, changes in enumerate(({}, KNOWN, AS_PUBLISHED))
    )
    assert unknown < 0.005
    assert known < 0.005
    assert published > 0.1


@pytest.mark.flight
@pytest.mark.parametrize(
    "wrong",
    [
        {"knowledge.drag": 1.3, "knowledge.added_mass": 0.7},
        {"knowledge.drag": 0.7, "knowledge.added_mass": 1.3, "knowledge.thrust": 1.3},
    ],
    ids=lambda wrong: " ".join(f"{key[10:]} {value}" for key, value in wrong.items()),
)
def test_knowledge_wrong_by_a_third_costs_centimetres_at_most(wrong, tmp_path):
    assert standing_error(CIRCLE, {**ON_THE_CIRCLE, **wrong}, tmp_path / "out") < 0.02


@pytest.mark.flight
def test_a_known_current_that_is_estimated_no_further_is_recorded_as_known(tmp_path):
    run = cube_sim.run(LINE, {**NEAR, **KNOWN, "duration_s": 2}, out=tmp_path / "out")
    np.testing.assert_array_equal(run.signals["water.estimated"][:, 1:], [[0.0, 0.3, 0.0]] * 101)


def test_a_current_faster_than_the_speed_wanted_is_headed_off_through_the_water():
    """Asked for 0.3 m/s over ground along a current of 0.5, the hull would go astern through the water."""
    still = {"guidance.speed_m_s": 0.3, **AS_PUBLISHED, "knowledge.current_m_s": [0.5, 0.0, 0.0]}
    follower = prepare(load(LINE, {**NEAR, **still})).controller
    assert isinstance(follower, PlanarFollower)
    assert follower.wanted_speed(0.0, follower.observer.in_body(0.0), 1.0).value == pytest.approx(1.0)
    assert follower.wanted_speed(0.0, follower.observer.in_body(np.pi), 1.0).value == pytest.approx(0.3)


def test_the_law_for_all_axes_does_not_take_a_known_current():
    with pytest.raises(ScenarioError, match=r"knowledge.current_m_s: only the planar law"):
        prepare(load(HELIX, {"knowledge.current_m_s": [0.1, 0.0, 0.0]}))
