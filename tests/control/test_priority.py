"""The path before the attitude: the split is exact, and in flight the secondary task leaves the path alone."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.places import CUBE
from support.swimmer import accelerations, moving, swimmer

import cube_sim
from cube_sim.allocation import Status
from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.judged_capability import capability
from cube_sim.control.look_at import LookAt
from cube_sim.control.loops import MotionLoops
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.priority import force_with_torque, yield_attitude
from cube_sim.control.safe_mode import SafeMode
from cube_sim.guidance.approach import Approach
from cube_sim.guidance.helix import Helix
from cube_sim.guidance.speed import ConstantSpeed
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.mission import prepare
from cube_sim.scenario import load
from cube_sim.spatial import quaternion_from_euler
from cube_sim.vehicle.state import read_state


@pytest.fixture(scope="module")
def lopsided():
    """Its centre of mass off the origin, too: every row depends on every other."""
    return swimmer(centre_of_mass=(0.02, -0.01, -0.03))


def test_no_share_of_the_secondary_part_moves_the_origin(lopsided):
    model, vehicle = lopsided
    assert np.abs(vehicle.mass_matrix[:3, 3:]).max() > 1.0  # the rows are coupled
    mass = vehicle.mass_matrix + vehicle.added_mass
    rng = np.random.default_rng(1)
    for _ in range(30):
        data, state = moving(rng, model, vehicle)
        wrench = rng.normal(0.0, 30.0, 6)
        secondary = np.empty(6)
        yield_attitude(force_with_torque(mass), wrench, secondary)
        primary = wrench - secondary
        np.testing.assert_allclose(primary + secondary, wrench, atol=1e-12)
        np.testing.assert_array_equal(primary[3:], 0.0)
        whole, turning = accelerations(data, state, wrench)
        for share in (0.0, 0.37, 1.0, -2.0):
            linear, angular = accelerations(data, state, primary + share * secondary)
            np.testing.assert_allclose(linear, whole, atol=1e-9)
            assert share == 1.0 or np.linalg.norm(angular - turning) > 1e-3


def follower(vehicle, attitude) -> PathFollower:
    dynamics = vehicle.dynamics
    path = Helix([0.0, 0.0, 0.0], 2.0, 3.0, 2.0)
    return PathFollower(
        target=VirtualTarget(path, 0.5, arc_length=3.0),
        approach=Approach(ConstantSpeed(0.4), 1.0, 0.5, 2.0),
        attitude=attitude,
        loops=MotionLoops(dynamics, 1.0, 1.0, 0.3),
        pointing_time=1.0,
        observer=None,
        current_observer=None,
        safe_mode=SafeMode(None, 0.2, 1e3, 1.0),
        capability=capability(np.eye(6)),
        path_first=True,
    )


@pytest.fixture(scope="module")
def coupled_by_nothing():
    """The CUBE itself: its mass and its added mass are diagonal."""
    model = cube_sim.load_model(CUBE)
    return model, cube_sim.Vehicle.from_model(model)


@pytest.mark.parametrize("hull", ["coupled_by_nothing", "lopsided"])
def test_whatever_the_attitude_is_asked_to_do_the_path_is_given_the_same_acceleration(hull, request):
    """Looking at points all around, at attitudes wide apart: the primary parts move the origin alike to 1e-9.

    Where the masses couple turning with the path, what the water damps of the turning moves the origin, too:
    M nu' = D(w_wanted) - D(w). The loops leave that to the water. It is taken off before the comparison.
    """
    model, vehicle = request.getfixturevalue(hull)
    dynamics = vehicle.dynamics
    rng = np.random.default_rng(2)
    for _ in range(8):
        data, state = moving(rng, model, vehicle)
        modes = [LookAt(rng.normal(0.0, 2.0, 3), np.array([1.0, 0.0, 0.0]), 0.3, 1.0) for _ in range(3)]
        modes += [FixedAttitude(quaternion_from_euler(*rng.uniform(-3.0, 3.0, 3))) for _ in range(3)]
        found, torques = [], []
        for mode in modes:
            decision = follower(vehicle, mode).decide(state, np.zeros(6), 0.02)
            given = accelerations(data, state, decision.wrench - decision.secondary)[0]
            np.testing.assert_allclose(accelerations(data, state, decision.wrench)[0], given, atol=1e-9)
            turning = np.diag(dynamics.linear_damping)[3:] * (decision.rates - state.rates)
            turning += np.diag(dynamics.quadratic_damping)[3:] * (
                np.abs(decision.rates) * decision.rates - np.abs(state.rates) * state.rates
            )
            swept = np.linalg.solve(dynamics.total_mass, np.append(np.zeros(3), turning))[:3]
            assert hull == "lopsided" or not swept.any()
            found.append(given - state.rotation @ swept)
            torques.append(decision.secondary[3:])
        np.testing.assert_allclose(found, np.tile(found[0], (len(found), 1)), atol=1e-9)
        assert np.ptp(torques, axis=0).max() > 1.0


PASSING = f"""\
schema_version: 1
name: passing
model: {CUBE}
duration_s: 26
initial: {{position_m: [0, 0.2, -5]}}
path: {{type: line, start_m: [0, 0, -5], end_m: [20, 0, -5]}}
guidance: {{speed_m_s: 0.4, wait_for_thrusters: false}}
events:
  - {{kind: thrusters, at_s: 0, thrusters: [T1, T2, T3, T4, T5, T6, T7, T8], state: weak, efficiency: 0.3}}
control:
  faults: told
  attitude: ATTITUDE
  priority: PRIORITY
checks:
  - {{kind: allowed_forces}}
"""
LOOK = "{mode: look_at, point_m: [4.0, 0.2, -4.0]}"


def written(folder, attitude, priority):
    path = folder / "passing.yaml"
    path.write_text(PASSING.replace("ATTITUDE", attitude).replace("PRIORITY", priority))
    return path


def passing(folder, attitude, priority):
    return cube_sim.run(written(folder, attitude, priority), out=folder / "out").signals


@pytest.mark.flight
def test_looking_at_a_point_close_by_with_weak_thrusters_leaves_the_path_alone(tmp_path):
    """To look up at a point it passes under at 1 m asks for more torque than thrusters at 30 % have beside the path.

    In still water, so that nothing else ties path and attitude together: the estimate of an unknown force is filtered
    in body axes and lags behind while they turn.
    """
    without = passing(tmp_path, "{mode: along_path}", "path")
    looking = passing(tmp_path, LOOK, "path")
    attitude_first = passing(tmp_path, LOOK, "attitude")
    assert np.count_nonzero(looking["allocation.status"][:, 1] == Status.YIELDED) > 100  # the thrusters did saturate
    assert looking["path_error.attitude"][:, 1].max() > 0.15  # and the attitude was what gave way
    assert apart(looking, without, "path_error.lateral") < 0.02
    assert apart(attitude_first, without, "path_error.lateral") > 0.05
    assert apart(looking, without, "pose.position") < 0.008
    assert apart(attitude_first, without, "pose.position") > 0.5


def apart(one, other, signal):
    """Largest distance of two recorded vectors."""
    return np.linalg.norm(one[signal][:, 1:] - other[signal][:, 1:], axis=1).max()


def test_by_default_the_modes_that_are_secondary_tasks_give_way_and_the_others_do_not(tmp_path):
    turned = {"initial.attitude_deg": [5, 10, 15], "initial.rates_deg_s": [3, 2, 1]}
    for attitude, priority, gives_way in [
        (LOOK, "null", True),
        ("{mode: free}", "null", True),
        ("{mode: along_path}", "null", False),
        ("{mode: fixed, attitude_deg: [0, 0, 0]}", "null", False),
        ("{mode: fixed, attitude_deg: [0, 0, 90]}", "path", True),
        (LOOK, "attitude", False),
    ]:
        mission = prepare(load(written(tmp_path, attitude, priority), turned))
        mujoco.mj_forward(mission.model, mission.data)
        state = read_state(mission.vehicle, mission.data)
        for _ in range(3):
            decision = mission.controller.decide(state, np.zeros(6), 0.02)
        assert decision.wrench[3:].any()
        np.testing.assert_array_equal(decision.secondary[3:], decision.wrench[3:] if gives_way else 0.0)
