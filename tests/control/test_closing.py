"""A large error across the path is run down as fast as the thrusters afford, whatever the speed along it."""

from __future__ import annotations

import numpy as np
import pytest
from support.places import MODELS
from support.vehicles import vehicle

import cube_sim
from cube_sim.control.closing import SHARE, STEEPEST, closing_speed
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.wrench.health import Health

LATERAL_S = 2.0


def affordable(name):
    """The closing speed of a vehicle, and how much of what is attainable it takes at most, to keep and to brake."""
    thrusters, A, dynamics = vehicle(name).thrusters, vehicle(name).actuation_matrix, vehicle(name).dynamics
    left = remaining_capability(A, thrusters.limits, Health.whole(len(A.T)))
    assert left.budget is not None
    speed = closing_speed(left, dynamics, LATERAL_S)
    ways = np.random.default_rng(4).normal(size=(300, 3)) * (1.0, 1.0, not left.level)
    shares = []
    for way in speed * ways / np.linalg.norm(ways, axis=1, keepdims=True):
        for braking in (0.0, STEEPEST / LATERAL_S):
            steady = dynamics.steady_wrenches(way[None], np.array([[0.0, 0.0, 1.0]]))[0]
            wrench = left.project_onto_range(steady + braking * dynamics.total_mass[:, :3] @ way)
            shares.append(np.max(left.budget.normals @ wrench / left.budget.attainable.offsets))
    return speed, max(shares)


@pytest.mark.parametrize("name", ["cube", "cube_as_built", "bluerov2_heavy", "jack"])
def test_half_of_what_is_attainable_goes_into_closing(name):
    speed, share = affordable(name)
    assert speed > 0.3
    assert 0.8 * SHARE < share < 1.02 * SHARE


@pytest.mark.parametrize("name", ["torpedo", "infante"])
def test_a_vehicle_that_has_to_point_its_thrust_closes_no_faster_than_it_follows(name):
    assert affordable(name)[0] == 0.0


SLOW = {
    "schema_version": 1,
    "name": "closing",
    "description": "A slow line, from beside it.",
    "model": "",
    "seed": 1,
    "duration_s": 30.0,
    "path": {"type": "line", "start_m": [0.0, 0.0, -8.0], "end_m": [10.0, 0.0, -8.0]},
    "initial": {"position_m": [0.0, 0.5, -8.0]},
    "guidance": {"speed_m_s": 0.1},
    "checks": [{"kind": "allowed_forces"}],
}


@pytest.mark.flight
@pytest.mark.parametrize("name", ["cube", "bluerov2_heavy", "bluerov2_vectored"])
def test_a_slow_mission_is_joined_quickly_and_without_overshoot(name):
    scenario = SLOW | {"model": str(MODELS / f"{name}.xml")}
    away = [{"initial.position_m": [0.0, y, -8.0]} for y in (0.5, 3.0)]
    unhurried = [away[1] | {"guidance.closing_speed_m_s": 0.1}]
    near, far, slow = cube_sim.fly_many(scenario, away + unhurried, signals=["pose.position"])
    for outcome, within_s in ((near, 6.0), (far, 13.0)):
        assert outcome.verdict == "PASS"
        t, y = outcome.signals["pose.position"][:, [0, 2]].T
        assert np.all(np.abs(y[t > within_s]) < 0.05)
        assert y.min() > -0.002
    t, y = slow.signals["pose.position"][:, [0, 2]].T
    assert y[t <= 20.0].min() > 1.2  # a bound on the closing speed is kept
