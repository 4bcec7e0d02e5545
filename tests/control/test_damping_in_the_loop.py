"""Damping is a friend: what the water damps stays in the loop, whatever is believed of the current.

The wrench on the hull is tau(nu) less what the water asks for. Its derivative by nu holds the gains, the turning of the
body axes, and the damping. What the loops make with the true current and a cancelled damping holds the first two alone.
The difference is what the damping, and the belief of it, do to a disturbed motion.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.places import MODEL_FILES
from support.vehicles import random_hull, random_rotation, vehicle

from cube_sim.control.attitude_mode import DesiredAttitude
from cube_sim.control.loops import MotionLoops
from cube_sim.guidance.law import DesiredMotion
from cube_sim.spatial import State, quaternion_from_rotation


def slope(function, nu, h=1e-6):
    """(6,6) derivative by nu."""
    return np.column_stack([(function(nu + h * e) - function(nu - h * e)) / (2.0 * h) for e in np.eye(6)])


def net_wrench(loops, R, motion, attitude, current, believed, cancelled):
    """nu -> (6,) the wrench on the hull that is left, with the damping cancelled at the measured velocity or kept."""
    hull, q = loops.dynamics, quaternion_from_rotation(R)

    def wrench(nu):
        state = State(np.zeros(3), q, R, nu[:3], nu[3:])
        tau, reference = loops.wrench(state, motion, attitude, believed)
        if cancelled:
            flow = np.append(believed @ R, np.zeros(3))
            wanted = np.append(reference.velocity, reference.rates)
            tau = tau + hull.damping(nu - flow) - hull.damping(wanted - flow)
        return tau - hull.wrench(R, nu, np.zeros(6), current)

    return wrench


def growth(matrix):
    """The largest eigenvalue of the symmetric part: how fast energy can come in, per |nu|^2 / 2."""
    return float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).max())


def test_no_belief_of_the_current_makes_the_damping_less_than_that_of_still_water():
    rng = np.random.default_rng(21)
    pushed = 0
    for _ in range(60):
        hull = random_hull(rng)
        hull = replace(hull, added_mass=np.zeros((6, 6)))  # its lift in a flow that is not there is no damping
        loops = MotionLoops(hull, 0.5, 0.5, 0.15)
        R, nu = random_rotation(rng), rng.normal(0.0, 0.5, 6)
        motion = DesiredMotion(rng.normal(0.0, 0.5, 3), rng.normal(0.0, 0.1, 3))
        attitude = DesiredAttitude(quaternion_from_rotation(random_rotation(rng)), np.zeros(3))
        current, believed = rng.normal(0.0, 0.3, 3), rng.normal(0.0, 0.5, 3)
        rest = slope(net_wrench(loops, R, motion, attitude, current, current, True), nu)
        kept = slope(net_wrench(loops, R, motion, attitude, current, believed, False), nu) - rest
        cancelled = slope(net_wrench(loops, R, motion, attitude, current, believed, True), nu) - rest
        still_water = -float(np.diag(hull.linear_damping).min())
        assert growth(kept) <= still_water + 1e-5
        pushed += growth(cancelled) > 0.1
    assert pushed > 40  # cancelled where the hull is measured to be, a wrong belief feeds the motion


@pytest.mark.parametrize("path", MODEL_FILES, ids=lambda path: path.stem)
def test_at_rest_every_vehicle_is_damped_with_the_current_believed_half_a_metre_a_second_wrong(path):
    """With lift and Munk moment of the flow that is not there, too."""
    hull = vehicle(path.stem).dynamics
    loops = MotionLoops(hull, 0.5, 0.5, 0.15)
    rng = np.random.default_rng(22)
    still = DesiredMotion(np.zeros(3), np.zeros(3))
    scale = np.sqrt(np.diag(hull.total_mass))  # metres and radians by energy
    for _ in range(10):
        R = random_rotation(rng)
        attitude = DesiredAttitude(quaternion_from_rotation(R), np.zeros(3))
        current, off = rng.normal(0.0, 0.3, 3), rng.normal(size=3)
        believed = current + 0.5 * off / np.linalg.norm(off)
        matrix = slope(net_wrench(loops, R, still, attitude, current, believed, False), np.zeros(6))
        assert growth(matrix / np.outer(scale, scale)) < 0.0
