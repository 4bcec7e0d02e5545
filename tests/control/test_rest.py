"""What a dead zone swallows is asked for again, until it comes out: on the mean, all of it is made."""

from __future__ import annotations

import numpy as np
import pytest
from support.vehicles import vehicle

from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.judged_capability import capability
from cube_sim.control.loops import MotionLoops
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.safe_mode import SafeMode
from cube_sim.guidance.clocked_target import ClockedTarget
from cube_sim.guidance.point import Point
from cube_sim.guidance.pursuit import Pursuit
from cube_sim.guidance.speed import ConstantSpeed, StoppingSpeed
from cube_sim.spatial import State, quaternion_from_euler, rotation_from_quaternion

DEAD, MOST_REST = 5.0, 15.0
"""Forces below this are not made; the rest that is asked for again, at most [N]."""


def asked_of(thrusters, most_rest, ticks=400, rolled_deg=0.0, torques=False):
    """(ticks, 2) force asked for and made ahead [N], of a CUBE held 2 cm beside its point that tries to get there.

    Rolled by an angle it tries to turn back, too; or (ticks, 3) the torques asked for [N m].
    """
    dynamics, profile = vehicle("cube").dynamics, StoppingSpeed(ConstantSpeed(0.4), 0.0, 2.0)
    follower = PathFollower(
        target=ClockedTarget(Point([0.02, 0.0, 0.0], 0.0), profile),
        approach=Pursuit(profile, 2.0, 0.4),
        attitude=FixedAttitude(np.array([1.0, 0.0, 0.0, 0.0])),
        loops=MotionLoops(dynamics, 1.0, 1.0, 0.3),
        pointing_time=1.0,
        observer=None,
        current_observer=None,
        safe_mode=SafeMode(None, 0.2, 1e3, 1.0),
        most_rest=np.full(2, most_rest),
        capability=capability(np.eye(6)),
    )
    q = quaternion_from_euler(np.radians(rolled_deg), 0.0, 0.0)
    state = State(np.zeros(3), q, rotation_from_quaternion(q), np.zeros(3), np.zeros(3))
    applied, rows = np.zeros(6), []
    for _ in range(ticks):
        asked = follower.decide(state, applied, 0.02).wrench
        applied = thrusters(asked)
        rows.append(asked[3:] if torques else (asked[0], applied[0]))
    return np.array(rows)


def with_dead_zone(wrench):
    return np.where(np.abs(wrench) < DEAD, 0.0, wrench)


def nearest_end(wrench):
    """To the nearer end of the gap, 0 or DEAD, as an allocation does that minimises the error."""
    ends = np.sign(wrench) * np.where(np.abs(wrench) < 0.5 * DEAD, 0.0, DEAD)
    return np.where(np.abs(wrench) < DEAD, ends, wrench)


@pytest.mark.parametrize("thrusters", [with_dead_zone, nearest_end])
def test_the_mean_of_what_is_made_is_what_was_demanded(thrusters):
    (demand, made), *_ = asked_of(thrusters, 0.0, 1)
    assert 0.0 < demand < 0.5 * DEAD
    assert made == 0.0
    assert np.all(asked_of(thrusters, 0.0)[:, 1] == 0.0)  # not asked for again it never comes
    rows = asked_of(thrusters, MOST_REST)
    assert rows[:, 1].mean() == pytest.approx(demand, abs=2.0 * DEAD / len(rows))
    assert np.abs(np.cumsum(rows[:, 1] - demand)).max() <= DEAD  # at no time more than one gap off
    assert np.abs(rows[:, 0] - demand).max() <= MOST_REST


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_thrusters_that_never_make_it_are_not_asked_for_ever_more(share):
    rows = asked_of(lambda wrench: share * wrench, MOST_REST, 2000)
    demand = rows[0, 0]
    assert np.abs(rows[:, 0] - demand).max() <= MOST_REST + 1e-9
    if share == 0.0:
        assert rows[-1, 0] == pytest.approx(demand + MOST_REST)


def test_a_torque_that_is_never_made_does_not_wind_up_beside_a_force_that_is():
    """A hull upside down in roll, whose thrusters make all of its force and a tenth of its torque."""
    asked = asked_of(lambda wrench: wrench * np.repeat([1.0, 0.1], 3), 1.0, 500, rolled_deg=150.0, torques=True)
    assert np.linalg.norm(asked[0]) > 10.0
    assert np.linalg.norm(asked - asked[0], axis=1).max() == pytest.approx(1.0)  # 4,800 N m without a bound
