"""A thruster stuck at full force: the hull turns to where the others have enough, and follows its path from there."""

from __future__ import annotations

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY, said, thruster_event
from support.places import MODELS, SCENARIOS
from support.vehicles import random_rotation, vehicle

import cube_sim
from cube_sim.control.authority import Authority
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.refuge import KeptMotion, Refuge
from cube_sim.control.roomiest_attitude import TO_BRAKE, excesses, has_enough, roomiest_attitude
from cube_sim.spatial import quaternion_from_rotation
from cube_sim.wrench.health import Health

STUCK_N = 51.4


def budget_of(name, force, thruster=0):
    thrusters, A = vehicle(name).thrusters, vehicle(name).actuation_matrix
    left = remaining_capability(A, thrusters.limits, Health.whole(len(A.T)).with_thruster(thruster, 0.0, force))
    return (left.budget.normals, left.budget.bounds, left.budget.held_shares), left.authority


@pytest.mark.parametrize("name", ["cube", "cube_as_built"])
def test_the_attitude_found_has_enough_and_is_among_the_nearest_of_those(name):
    facets, authority = budget_of(name, STUCK_N)
    assert authority is Authority.HOLONOMIC
    hull, level, rng = vehicle(name).dynamics.record, np.eye(3), np.random.default_rng(5)
    flow = np.array([0.1, 0.0, 0.0])
    assert not has_enough(hull, facets, 1.0, flow, level)
    found = roomiest_attitude(hull, facets, 1.0, flow, level)
    assert has_enough(hull, facets, 1.0, flow, found)
    assert roomiest_attitude(hull, facets, 1.0, flow, found) is None
    drawn = np.array([random_rotation(rng) for _ in range(4000)])
    enough = excesses(hull, *facets, 1.0, flow, drawn) <= -TO_BRAKE * facets[1].mean()
    angles = np.arccos((np.trace(drawn[enough], axis1=1, axis2=2) - 1.0) / 2.0)
    assert np.arccos((np.trace(found) - 1.0) / 2.0) < angles.min() + 0.35


@pytest.mark.parametrize("name", ["cube", "cube_as_built"])
def test_who_turns_back_has_more_to_spare_than_who_turns_away(name):
    facets, _ = budget_of(name, STUCK_N)
    hull, level, still = vehicle(name).dynamics.record, np.eye(3), np.zeros(3)
    rng, refuge = np.random.default_rng(7), Refuge()
    kept = KeptMotion(hull, facets, 1.0, still)
    refuge.seek(kept, level, level)
    taken, shares = refuge.memory.copy(), excesses(hull, *facets, 1.0, still, attitudes := random_rotations(rng))
    for share, wished in zip(shares / -facets[1].mean(), attitudes, strict=True):
        refuge.memory[:] = taken
        assert refuge.look_back(kept, quaternion_from_rotation(wished), short=False) == (share >= TO_BRAKE)
    assert np.any((shares / -facets[1].mean() > 0.02) & (shares / -facets[1].mean() < TO_BRAKE))


def random_rotations(rng, count=300):
    return np.array([random_rotation(rng) for _ in range(count)])


def test_whoever_has_enough_stays():
    facets, _ = budget_of("cube", 5.0)
    assert roomiest_attitude(vehicle("cube").dynamics.record, facets, 1.0, np.zeros(3), np.eye(3)) is None


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "thruster", "force"), [("cube", "T1", STUCK_N), ("cube", "T6", STUCK_N), ("bluerov2_heavy", "T5", 64.0)]
)
def test_the_path_is_followed_and_the_attitude_taken_up_again(name, thruster, force, tmp_path):
    limits = vehicle(name).thrusters.limits
    settings = {
        "model": MODELS / f"{name}.xml",
        "duration_s": 110.0,
        "checks": FORCES_ONLY,
        "events": [
            thruster_event(20.0, [thruster], "stuck", force_N=min(force, float(limits[0, 3]))),
            thruster_event(75.0, [thruster], "recovered"),
        ],
    }
    run = cube_sim.run(SCENARIOS / "cube_lose_one.yaml", settings, tmp_path / "run")
    t, error = run.signals["path_error.cross_track"].T
    assert error[(t > 20.0) & (t < 75.0)].max() < 0.3  # half a second in which nobody knows would make 0.8 m of it
    assert error[(t > 50.0) & (t < 75.0)].max() < 0.1
    assert run.signals["path_error.attitude"][-1, 1] < 0.05
    assert error[t > 100.0].max() < 0.05
    assert not any("given up" in line for line in said(run))


@pytest.mark.flight
@pytest.mark.parametrize("speed", [0.3, 0.53])
def test_a_hull_that_was_spun_round_stays_in_an_attitude_it_comes_by_that_has_enough(speed, tmp_path):
    """Until the fault is found the hull is spun to where others have enough, though its mission's attitude has not."""
    model = tmp_path / "model.xml"
    model.write_text(catalogue()["drawn7_0"].make())
    scenario = {
        "schema_version": 1,
        "name": "spun",
        "description": "A thruster sticks, and turns the hull before it is found.",
        "model": str(model),
        "seed": 676,
        "duration_s": 50.0,
        "path": {"type": "line", "start_m": [0.0, 0.0, -20.0], "end_m": [60.0, 0.0, -20.0]},
        "initial": {"position_m": [0.0, 0.0, -20.0]},
        "guidance": {"speed_m_s": speed},
        "control": {"faults": "diagnosed"},
        "events": [thruster_event(7.125, ["T1"], "stuck", force_N=-6.95)],
        "checks": FORCES_ONLY,
    }
    (flown,) = cube_sim.fly_many(scenario, [{}], signals=["path_error.cross_track", "velocity.angular"])
    assert flown.verdict == "PASS"
    for name, most in (("path_error.cross_track", 0.1), ("velocity.angular", 0.05)):
        t, size = flown.signals[name][:, 0], np.linalg.norm(flown.signals[name][:, 1:], axis=1)
        assert size[t > 40.0].max() < most
