"""The side step: closed forms, another linear programme, and what a vehicle that was flown did."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import linprog
from support.vehicles import random_hull, vehicle, weightless

from cube_sim.actuation.directions.subspaces import subspaces
from cube_sim.actuation.path_following.linear_motion import linearise
from cube_sim.actuation.path_following.side_step import SideStepBounds, side_step
from cube_sim.actuation.path_following.trim import trim_conditions
from cube_sim.vehicle.dynamics import Dynamics

FREE = SideStepBounds(horizon_s=8.0, most_turn_rad=1.0, fastest_m_s=100.0, furthest_m=100.0)
AHEAD, UP = np.array([0.4, 0, 0]), np.array([0, 0, 1.0])


def test_side_step_of_a_free_mass_is_full_force_there_and_back():
    # Two newtons one way for 0.6 T and three the other for 0.4 T, in either order: d = 1.2 T^2 / (2 m).
    m, T = 5.0, FREE.horizon_s
    motion = linearise(weightless(m * np.eye(6)), np.array([[1.0, 0], [0, 1], [0, 0]]), AHEAD, UP)
    step = side_step(motion, np.array([-1.0, -2.0]), np.array([1.0, 3.0]), FREE)
    assert step == pytest.approx(1.2 * T**2 / (2 * m))
    assert motion.uncontrolled_modes(1.0, 1.0) == ("yaw",)


def test_side_step_is_bounded_by_the_speed_and_the_furthest_looked_for():
    motion = linearise(weightless(1.0 * np.eye(6)), np.array([[1.0, 0], [0, 1], [0, 0]]), AHEAD, UP)
    low, high = np.full(2, -1e3), np.full(2, 1e3)
    # One step to be at the speed, one to stop.
    assert side_step(motion, low, high, replace(FREE, fastest_m_s=0.5)) == pytest.approx(0.5 * 0.9 * 8.0)
    assert side_step(motion, low, high, replace(FREE, furthest_m=2.0)) == 2.0


def test_side_step_is_zero_when_nothing_pushes_across_or_only_to_one_side():
    motion = linearise(Dynamics.neutral(0.3), np.array([[1.0], [0], [0]]), AHEAD, UP)
    assert side_step(motion, -np.ones(1), np.ones(1), FREE) == 0.0
    sideways = linearise(weightless(1.0 * np.eye(6)), np.array([[0.0], [1], [0]]), AHEAD, UP)
    assert side_step(sideways, np.zeros(1), np.ones(1), FREE) == pytest.approx(0.0, abs=1e-9)


def condensed(motion, low, high, bounds, steps=10):
    """The same programme in the forces alone: every state as the sum of what each force did to it."""
    k, m = motion.B.shape
    step = bounds.horizon_s / steps
    together = expm(np.block([[motion.A, motion.B], [np.zeros((m, k + m))]]) * step)
    A_d, B_d = together[:k, :k], together[:k, k:]
    states = [np.zeros((k, steps * m))]
    for j in range(steps):
        states.append(A_d @ states[-1])
        states[-1][:, j * m : (j + 1) * m] += B_d
    bounded = [i for i, name in enumerate(motion.names) if name in ("roll", "pitch", "yaw") or name.endswith("speed")]
    most = [bounds.fastest_m_s if motion.names[i].endswith("speed") else bounds.most_turn_rad for i in bounded]
    upper = np.vstack([state[bounded] / np.array(most)[:, None] for state in states[1:]])
    upper = np.column_stack([np.vstack([upper, -upper]), np.zeros(2 * len(upper))])
    rates = [i for i, name in enumerate(motion.names) if name.endswith("rate")]
    least = np.inf
    for side in [s * e for e in np.eye(len(motion.C)) for s in (1, -1)]:
        ends = np.vstack([motion.C, motion.C @ motion.A, np.eye(k)[rates]]) @ states[-1]
        ends = np.column_stack([ends, np.r_[-side, np.zeros(len(ends) - len(side))]])
        found = linprog(
            np.r_[np.zeros(steps * m), -1.0],
            A_ub=upper,
            b_ub=np.ones(len(upper)),
            A_eq=ends,
            b_eq=np.zeros(len(ends)),
            bounds=[*zip(np.tile(low, steps), np.tile(high, steps), strict=True), (0, bounds.furthest_m)],
        )
        least = min(least, found.x[-1])
    return least


@pytest.mark.parametrize("seed", range(6))
def test_side_step_is_that_of_the_programme_in_the_forces_alone(seed):
    rng = np.random.default_rng(seed)
    planar = seed % 2 == 0
    A = rng.normal(size=(3 if planar else 6, 4 if planar else 7))
    v0 = np.array([0.3, 0.1, 0.0 if planar else -0.1])
    motion = linearise(random_hull(rng), A, v0, UP)
    low, high = -rng.uniform(0, 1, A.shape[1]), rng.uniform(0, 2, A.shape[1])
    bounds = SideStepBounds(horizon_s=6.0, most_turn_rad=0.5, fastest_m_s=0.4, furthest_m=50.0)
    step = side_step(motion, low, high, bounds)
    assert step == pytest.approx(condensed(motion, low, high, bounds), rel=1e-5, abs=1e-7)
    shorter = replace(bounds, furthest_m=0.7 * step)
    assert side_step(motion, low, high, shorter) == pytest.approx(0.7 * step)


def test_a_thruster_fewer_never_lengthens_it():
    v = vehicle("cube")
    limits = v.thrusters.limits[:, [0, 3]] / 60.0
    motion = linearise(v.dynamics, v.actuation_matrix, np.array([0.3, 0, 0]), UP)
    bounds = SideStepBounds(horizon_s=20.0, most_turn_rad=0.5, fastest_m_s=0.3, furthest_m=100.0)
    whole = side_step(motion, limits[:, 0], limits[:, 1], bounds)
    without_one = {}
    for i in range(8):
        left = np.delete(np.arange(8), i)
        fewer = replace(motion, B=motion.B[:, left])
        without_one[i] = side_step(fewer, limits[left, 0], limits[left, 1], bounds)
        assert without_one[i] <= whole + 1e-6
    left = [1, 2, 3, 5, 6, 7]
    two = side_step(replace(motion, B=motion.B[:, left]), limits[left, 0], limits[left, 1], bounds)
    assert two <= min(without_one[0], without_one[4]) + 1e-6


def test_infante_steps_as_far_as_it_was_flown():
    # scenarios/infante_line.yaml at 0.3 m/s, started 2 m off: 0.31 m are left after 20 s, turned by up to 48 deg.
    v = vehicle("infante")
    A, limits, hull = v.actuation_matrix[[0, 1, 5]], v.thrusters.limits, v.dynamics
    condition = trim_conditions(hull, subspaces(A), 0.3, 0.0)[0]
    swing = 0.03 * np.array([1, 1, 1, 1 / 0.6, 1 / 0.6, 1 / 0.6])
    motion = linearise(hull, A, condition.velocity, condition.up, swing)
    bounds = SideStepBounds(horizon_s=20.0, most_turn_rad=np.radians(48.0), fastest_m_s=0.3, furthest_m=10.0)
    step = side_step(motion, limits[:, 0] - condition.forces, limits[:, 3] - condition.forces, bounds)
    assert step == pytest.approx(2.0 - 0.31, rel=0.05)
