"""Directions that cost too much: given up as if thrusters were missing, by the judgement and in flight."""

import re
from itertools import combinations

import numpy as np
import pytest
from support.flights import FORCES_ONLY, said
from support.places import MODELS, SCENARIOS

import cube_sim
from cube_sim import Vehicle, load_model
from cube_sim.actuation.directions.selection_criteria import final_approach
from cube_sim.control.authority import Authority
from cube_sim.control.judged_capability import DEAR, capability, remaining_capability
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.yielding import WaterHold
from cube_sim.errors import ScenarioError
from cube_sim.mission import prepare
from cube_sim.scenario import load
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.health import Health
from cube_sim.wrench.matrix import lever_arm

LOST = [1, 2]
"""T2 and T3 of the CUBE as built: what is left has rank 6, but one direction costs 35 N/N, the others 0.85 at most."""
FLIGHT = SCENARIOS / "cube_lose_two.yaml"
AS_BUILT = {"model": str(MODELS / "cube_as_built.xml")}
SHORT = AS_BUILT | {
    "duration_s": 20.0,
    "initial.position_m": [3.0, 0.0, -8.0],
    "control.faults": "told",
    "events.0.at_s": 1.0,
    "events.0.thrusters": ["T2", "T3"],
    "checks": FORCES_ONLY,
}


@pytest.fixture(scope="module")
def vehicle():
    return Vehicle.from_model(load_model(AS_BUILT["model"]))


def damaged(vehicle, cost_limit=None):
    health = Health.whole(8)
    for thruster in LOST:
        health = health.with_thruster(thruster, 0.0)
    return remaining_capability(vehicle.actuation_matrix, vehicle.thrusters.limits, health, cost_limit)


def test_a_costly_direction_is_lost_as_one_without_thrusters_is(vehicle):
    A = vehicle.actuation_matrix
    left = np.delete(A, LOST, axis=1)
    length = lever_arm(A, SPATIAL)
    directions = final_approach(left, length_m=length)
    assert directions.costs[-1] > 30 > 1 > directions.costs[-2]
    assert damaged(vehicle, 100.0).authority is Authority.HOLONOMIC
    rng = np.random.default_rng(0)
    for limit in (10.0, None):
        with_limit = damaged(vehicle, limit)
        assert with_limit.authority is Authority.PLANE
        assert with_limit.pure_forces.shape == (3, 2)
        assert "too costly but together" in with_limit.reason
        for demand in rng.normal(size=(20, 6)) * [20, 20, 20, 5, 5, 5]:
            asked = with_limit.project_onto_range(demand)
            assert directions.coordinates(asked)[-1] == pytest.approx(0, abs=1e-7)
            assert np.allclose(asked[3:], demand[3:])


def test_by_default_what_costs_ten_times_the_cheapest_is_left_alone_where_the_vehicle_flies_without(vehicle):
    """The CUBE as built without every pair of its thrusters, against the costs that the analysis lists."""
    A = vehicle.actuation_matrix
    length = lever_arm(A, SPATIAL)
    cut = 0
    for lost in combinations(range(8), 2):
        left = np.delete(A, lost, axis=1)
        costs = final_approach(left, length_m=length).costs
        found = capability(left, whole=A)
        dear = costs[costs > DEAR * costs.min()]
        assert capability(left, whole=A, cost_limit=DEAR * costs.min()).authority is found.authority
        assert found.lost_forces.shape == (3, len(dear))
        assert (found.within_cost_limit is None) is (len(dear) == 0)
        cut += len(dear)
    assert cut == 12  # the pairs whose loss takes a direction from the CUBE as drawn


def test_by_default_what_is_dear_is_used_where_the_vehicle_does_not_fly_without():
    """Yaw by two thrusters a centimetre apart: it costs 50 N/N with a lever arm of half a metre."""
    A = np.zeros((6, 4))
    A[0, :2], A[5, :2] = 1.0, [0.01, -0.01]
    A[1, 2], A[2, 3] = 1.0, 1.0
    whole = np.hstack([A, np.vstack([np.zeros((3, 2)), np.eye(3)[:, :2]])])  # pitch and roll for the lever arm
    hold = WaterHold(np.array([0.0, 0.0, 50.0]), np.full(3, 10.0))
    with_yaw = capability(A, whole=whole, hold=hold)
    assert with_yaw.authority is Authority.TRIM
    assert capability(A, whole=whole, hold=hold, cost_limit=20.0).authority is Authority.SAFE


def test_the_limit_decides_alone_and_a_high_one_keeps_what_rank_would_cut(vehicle):
    # T1 and T2 leave a direction at 93.3 N/N, under 1 % of the largest gain.
    health = Health.whole(8).with_thruster(0, 0.0).with_thruster(1, 0.0)
    A, limits = vehicle.actuation_matrix, vehicle.thrusters.limits
    assert remaining_capability(A, limits, health).authority is Authority.PLANE
    assert remaining_capability(A, limits, health, 90.0).authority is Authority.PLANE
    assert remaining_capability(A, limits, health, 100.0).authority is Authority.HOLONOMIC


def test_nothing_costly_is_asked_for_where_no_path_can_be_followed(vehicle):
    A = vehicle.actuation_matrix
    directions = final_approach(A)
    limit = float(directions.costs[2] + directions.costs[3]) / 2.0
    left = capability(A, cost_limit=limit)
    assert left.authority is Authority.SAFE
    demand = np.array([10.0, -5.0, 3.0, 1.0, 2.0, -1.0])
    asked = left.project_onto_range(demand)
    assert np.allclose(directions.coordinates(asked)[3:], 0, atol=1e-9)
    assert np.allclose(directions.coordinates(asked)[:3], directions.coordinates(demand)[:3])
    assert np.array_equal(capability(A[:, :2]).project_onto_range(demand), demand)


def test_a_level_vehicle_that_pushes_sideways_at_a_cost_steers_by_its_heading():
    A = np.zeros((6, 4))
    A[[0, 1, 5]] = [[1, 1, 1, 1], [0.02, -0.02, -0.02, 0.02], [-0.2, 0.2, -0.2, 0.2]]
    assert capability(A).authority is Authority.LEVEL
    assert capability(A, cost_limit=30.0).authority is Authority.LEVEL
    left = capability(A, cost_limit=10.0)
    assert left.authority is Authority.UNICYCLE
    assert left.project_onto_range(np.array([3.0, 2.0, 0.0, 0.0, 0.0, 1.0])) == pytest.approx(
        [3, 0, 0, 0, 0, 1], abs=1e-8
    )


@pytest.mark.flight
def test_within_the_default_limit_the_vehicle_keeps_to_its_path(tmp_path):
    free, limited = (
        cube_sim.run(FLIGHT, SHORT | more, out=tmp_path / name)
        for name, more in (("free", {"control.cost_limit": 100.0}), ("limited", {}))
    )

    def after(run, signal):
        rows = run.signals[signal]
        return rows[rows[:, 0] > 2.0, 1:]

    ways = {name: set(after(run, "health.authority").ravel()) for name, run in (("free", free), ("limited", limited))}
    assert ways == {"free": {Authority.HOLONOMIC}, "limited": {Authority.TRIM}}
    assert np.max(after(limited, "path_error.cross_track")) < 0.25


@pytest.mark.flight
def test_a_whole_vehicle_does_without_what_is_too_costly_from_the_start(tmp_path):
    # Jack's sway costs 1.93 N/N, surge and yaw half a newton.
    changes = {"duration_s": 20.0, "events": [], "checks": FORCES_ONLY, "control.cost_limit": 1.0}
    run = cube_sim.run(SCENARIOS / "jack_lose_two.yaml", changes, out=tmp_path)
    assert set(run.signals["health.authority"][:, 1]) == {Authority.UNICYCLE}
    assert np.max(np.abs(run.signals["wrench.demanded"][:, 2])) < 1e-9
    told = re.compile(r"UNICYCLE: .*\(too costly to push.*\); what costs more than 1 N/N is left alone")
    assert any(told.fullmatch(text) for text in said(run))


def test_the_default_takes_nothing_from_a_whole_cube():
    loaded = load(FLIGHT)
    assert loaded.scenario.control.cost_limit is None
    controller = prepare(loaded).controller
    assert isinstance(controller, PathFollower)
    assert controller.capability.within_cost_limit is None


def test_a_limit_that_leaves_no_way_to_follow_a_path_is_refused_with_the_costs():
    with pytest.raises(ScenarioError, match=r"control\.cost_limit: what is left .* at 0\.1 N/N .* cost 0\.612"):
        prepare(load(FLIGHT, {"control.cost_limit": 0.1}))


def test_the_planar_law_has_no_use_for_it():
    with pytest.raises(ScenarioError, match=r"control\.cost_limit: the planar law has no use for it"):
        prepare(load(SCENARIOS / "infante_line.yaml", {"control.cost_limit": 10.0}))
