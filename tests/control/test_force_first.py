"""Beside what is stuck the force comes before the torque, and what can be made of both is made."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from support.flights import FORCES_ONLY, thruster_event
from support.places import MODELS
from support.vehicles import vehicle

import cube_sim
from cube_sim.control.force_first import TORQUE, ForceFirst, serve_force_first
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.priority import force_with_torque
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.health import Health
from cube_sim.wrench.matrix import lever_arm

UNCOUPLED = np.zeros((3, 3))
"""A mass whose turning asks for no force."""


def budget_beside(name, thruster, force):
    hull = vehicle(name)
    health = Health.whole(len(hull.thrusters.limits)).with_thruster(thruster, 0.0, force)
    return remaining_capability(hull.actuation_matrix, hull.thrusters.limits, health).budget


def made_of(budget, ratio, wrench, coupling=UNCOUPLED):
    """What is made of a wrench with the force first."""
    made = wrench.copy()
    serve_force_first(ForceFirst.of(budget, coupling), budget.normals, budget.held_shares, ratio, made)
    return made


def test_an_attainable_wrench_is_left_as_it_is():
    budget, rng = budget_beside("cube", 2, 20.0), np.random.default_rng(3)
    for _ in range(20):
        forces = rng.uniform(*(0.9 * budget.limits))
        wrench = budget.matrix @ forces + budget.held
        assert made_of(budget, 1.0, wrench).tobytes() == wrench.tobytes()


@pytest.mark.parametrize("ratio", [1.0, 0.6])
def test_any_other_comes_as_near_as_can_be_by_forces_that_there_are(ratio):
    budget, rng = budget_beside("bluerov2_heavy", 0, 51.4), np.random.default_rng(4)
    scale = SPATIAL.scale(lever_arm(budget.matrix, SPATIAL)) * np.array([1.0] * 3 + [TORQUE] * 3)
    for _ in range(20):
        wrench = rng.normal(size=6) * np.array([60.0] * 3 + [20.0] * 3)
        made = made_of(budget, ratio, wrench)
        best = lsq_linear(
            scale[:, None] * budget.matrix, scale * (wrench - budget.held), bounds=tuple(ratio * budget.limits)
        )
        assert np.linalg.norm(scale * (wrench - made)) <= np.sqrt(2.0 * best.cost) * 1.02 + 1e-3


def test_the_force_that_was_to_come_with_a_turning_is_not_made_without_it():
    """A mass that couples both: the origin of the body goes as it is to, though the hull does not turn as it is to."""
    budget, rng = budget_beside("bluerov2_heavy", 0, 51.4), np.random.default_rng(5)
    mass = vehicle("bluerov2_heavy").dynamics.total_mass.copy()
    arm = mass[0, 0] * np.array([[0.0, 0.05, 0.0], [-0.05, 0.0, 0.02], [0.0, -0.02, 0.0]])
    mass[:3, 3:], mass[3:, :3] = arm, arm.T
    off = {True: [], False: []}
    for _ in range(20):
        wrench = rng.normal(size=6) * np.array([5.0] * 3 + [25.0] * 3)
        for known in off:
            made = made_of(budget, 1.0, wrench, force_with_torque(mass) if known else UNCOUPLED)
            off[known].append(float(np.linalg.norm(np.linalg.solve(mass, wrench - made)[:3])))
    assert np.median(off[True]) < 0.2 * np.median(off[False])


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "thruster", "force", "most"),
    [
        ("bluerov2_heavy", "T6", -39.9, 0.04),  # 3.2 m with the torque first
        ("bluerov2_vectored", "T2", -39.9, 0.2),  # 8.4 m, and given up; 0.46 m with a torque that counts a tenth
        ("bluerov2_vectored", "T1", -39.9, 0.2),  # an attitude to rest in takes all their force: the same
        ("jack", "T2", -25.0, 0.3),  # 4.1 m, and given up
    ],
)
def test_a_thruster_stuck_at_its_limit_throws_a_hull_off_its_place_by_little(name, thruster, force, most):
    scenario = {
        "schema_version": 1,
        "name": "stuck",
        "model": str(MODELS / f"{name}.xml"),
        "duration_s": 45.0,
        "path": {"type": "point", "position_m": [0.0, 0.0, -20.0]},
        "initial": {"position_m": [0.0, 0.0, -20.0]},
        "guidance": {"speed_m_s": 0.3},
        "events": [thruster_event(5.0, [thruster], "stuck", force_N=force)],
        "checks": FORCES_ONLY,
    }
    (flown,) = cube_sim.fly_many(scenario, [{}], signals=["pose.position", "health.authority"])
    place = flown.signals["pose.position"][:, 1:]
    assert float(np.linalg.norm(place - place[0], axis=1).max()) < most
    assert not np.any(flown.signals["health.authority"][:, 1] == 3)
