"""A hull that points its thrust slows down for what it is short of only as far as that helps."""

from __future__ import annotations

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.catalogue.wrong import buoyancy_moved
from support.flights import FORCES_ONLY

import cube_sim
from cube_sim import Vehicle, load_model
from cube_sim.control.authority import Authority
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.pace import LEAST_PACE, PaceDemand, in_range, is_allowed, largest_share, share_while_it_helps
from cube_sim.control.pace import wrench_at_pace as at_pace
from cube_sim.wrench.health import Health

LEVEL = (0.0, 0.0, 1.0)
ASIDE_M = [(-0.0091, -0.0029, -0.0029), (0.0077, 0.0059, -0.0026)]
"""By how much its centre of buoyancy is moved: 1 cm, aft or ahead, to one side or the other."""


@pytest.fixture(scope="module")
def torpedo(tmp_path_factory):
    """A propeller and four thrusters in place of fins at its stern: what is left, and the hull."""
    path = tmp_path_factory.mktemp("torpedo") / "model.xml"
    path.write_text(catalogue()["torpedo_four_fins"].make())
    vehicle = Vehicle.from_model(load_model(path))
    left = remaining_capability(vehicle.actuation_matrix, vehicle.thrusters.limits, Health.whole(5))
    assert left.authority is Authority.LINE
    return left, vehicle.dynamics


def asked(torpedo, demand, share, *more):
    left, hull = torpedo
    budget = left.budget
    facets = budget.normals, budget.bounds, budget.held_shares, 1.0
    return share(hull.record, left.record(hull.total_mass), *facets, demand, *more)


def allowed(torpedo, demand, pace):
    left, hull = torpedo
    budget = left.budget
    wrench = in_range(left.record(hull.total_mass), at_pace(hull.record, demand, pace))
    return is_allowed(budget.normals, budget.bounds, budget.held_shares, 1.0, wrench)


def demand_of(speed_m_s, rest, rising_m_s=0.0):
    """To go ahead through the water at a speed, and up in its own axes, with a wrench beside that of this motion."""
    return PaceDemand((speed_m_s, 0.0, rising_m_s), (speed_m_s, 0.0, 0.0), (0.0, 0.0, 0.0), rest, LEVEL)


def test_a_speed_that_is_too_much_falls_to_what_there_is(torpedo):
    """Drag of 4 m/s is more than twice the thrust: the share is the one that any vehicle takes."""
    demand = demand_of(4.0, (0.0,) * 6)
    share = asked(torpedo, demand, share_while_it_helps)
    assert 0.3 < share < 0.9
    assert share == asked(torpedo, demand, largest_share, -1.0)
    assert allowed(torpedo, demand, share)
    assert not allowed(torpedo, demand, share + 0.01)


def test_what_no_speed_makes_good_leaves_the_speed(torpedo):
    """More roll than its fins have: at no pace is it allowed, and to stand would not help."""
    demand = demand_of(0.5, (0.0, 0.0, 0.0, 2.0, 0.0, 0.0))
    assert asked(torpedo, demand, largest_share, -1.0) == -2.0
    assert asked(torpedo, demand, share_while_it_helps) == 1.0


def test_it_keeps_the_way_on_that_the_water_holds_it_by(torpedo):
    """The Munk moment of its slip makes good most of a torque that its fins have not; it lessens with the speed."""
    up = demand_of(0.5, (0.0, 0.0, 0.0, 0.0, -9.0, 0.0), rising_m_s=-0.06)
    assert not any(allowed(torpedo, up, pace) for pace in np.linspace(-1.0, 1.0, 33))
    assert asked(torpedo, up, largest_share, -1.0) == -2.0
    assert asked(torpedo, up, share_while_it_helps) == 1.0


def test_it_is_not_told_to_go_back(torpedo):
    """Back at 0.84 of its speed the Munk moment would make good that torque, if its attitude pointed it there."""
    down = demand_of(0.5, (0.0, 0.0, 0.0, 0.0, -8.0, 0.0), rising_m_s=0.06)
    assert asked(torpedo, down, largest_share, -1.0) < -0.8
    assert asked(torpedo, down, share_while_it_helps) == LEAST_PACE


def test_against_a_current_too_strong_it_asks_for_the_least(torpedo):
    demand = PaceDemand((6.0, 0.0, 0.0), (0.5, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0,) * 6, LEVEL)
    assert asked(torpedo, demand, share_while_it_helps) == LEAST_PACE


@pytest.mark.flight
@pytest.mark.parametrize("aside", ASIDE_M)
def test_a_torpedo_that_needs_nine_tenths_of_its_roll_keeps_its_helix(aside, tmp_path):
    """It was told to go back as soon as 5 % of it was left over, lost its trim and swung metres beside its path."""
    model = tmp_path / "model.xml"
    model.write_text(buoyancy_moved(catalogue()["torpedo_four_fins"].make(), list(aside)))
    scenario = {
        "schema_version": 1,
        "name": "aside",
        "model": str(model),
        "duration_s": 90.0,
        "initial": {"position_m": [5.8, 0.3, -19.4], "attitude_deg": [60.0, -20.0, -150.0]},
        "path": {"type": "helix", "centre_m": [0, 0, -20], "radius_m": 6.4, "pitch_m": 6.3, "turns": 1.9},
        "guidance": {"speed_m_s": 0.52},
        "checks": FORCES_ONLY,
    }
    run = cube_sim.fly(scenario, record="none")
    t, error = run.signals["path_error.cross_track"].T
    assert t[-1] > 89.9
    assert error[t > 60.0].max() < 0.05
