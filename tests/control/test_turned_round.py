"""Beside what is stuck a hull is flown by its forces, in whichever attitude, where its equations say it stays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import yaml
from support.catalogue.known import AHEAD, UP, pair
from support.catalogue.mjcf import Layout, Thruster, box_hull, mjcf
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY, thruster_event
from support.places import MODELS, SCENARIOS

import cube_sim
from cube_sim.commands.stuck_report import Fault, fault_cases
from cube_sim.control.authority import Authority
from cube_sim.control.force_first import TORQUE
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.turned_round import LET_TURN, NEAR_M, drifts_aside, turned_round, wanders_m
from cube_sim.control.yielding import WaterHold
from cube_sim.vehicle.loading import load_model
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.health import Health

TURNED = [("drawn5_0", "T1", -141.4), ("four_with_one_aside", "T2", 25.7), ("torpedo_tunnels", "T3", -23.0)]
"""Vehicles whose attitude would have to point the thrust, which are turned round: there is no attitude to rest in."""

NO_SWAY = Layout(
    replace(
        box_hull(48.0, (1.5, 0.3, 0.3), 0.025),
        added_mass=(4.0, 40.0, 44.0, 0.3, 8.0, 8.0),
        linear_damping=(4.0, 20.0, 22.0, 0.4, 8.0, 8.0),
        quadratic_damping=(12.0, 150.0, 170.0, 1.0, 40.0, 36.0),
    ),
    [*pair(-0.65, 0.2, 0.0, AHEAD), Thruster((0.5, 0.0, 0.0), UP), Thruster((-0.45, 0.0, 0.0), UP)],
    lag_s=0.06,
)
"""A hull that hovers and turns, and that nothing pushes to a side."""


@pytest.fixture
def made(tmp_path):
    def make(name):
        file = tmp_path / f"{name}.xml"
        file.write_text(mjcf(name, NO_SWAY) if name == "no_sway" else catalogue()[name].make())
        return file, Vehicle.from_model(load_model(str(file)))

    return make


def left_beside(hull, thruster, force):
    names = hull.thrusters.names
    health = Health.whole(len(names)).with_thruster(names.index(thruster), 0.0, force)
    hold = WaterHold.of(hull.dynamics, 0.3)
    return remaining_capability(hull.actuation_matrix, hull.thrusters.limits, health, hold=hold)


@pytest.mark.parametrize(("name", "thruster", "force"), TURNED)
def test_where_it_stays_the_force_comes_first_in_any_attitude(made, name, thruster, force):
    hull = made(name)[1]
    left = left_beside(hull, thruster, force)
    assert left.authority is Authority.TURNED
    assert left.turned.wanders_m < NEAR_M
    assert "the force comes first, in whichever attitude what is stuck turns it to" in left.reason
    np.testing.assert_array_equal(left.project_onto_range(np.eye(6)), np.eye(6))


def test_where_it_does_not_the_attitude_points_the_thrust(made):
    """What pushes through the middle turns nothing, and leads away."""
    hull = made("torpedo_tunnels")[1]
    left = left_beside(hull, "T1", 15.0)
    assert left.authority is Authority.PLANE
    assert left.turned is None
    assert turned_round(hull.dynamics, left.budget).wanders_m > 10.0


def test_what_moves_any_way_or_has_nothing_stuck_is_flown_as_before(made):
    hull = made("cube")[1]
    assert left_beside(hull, "T1", 51.4).authority is Authority.HOLONOMIC
    assert left_beside(made("drawn5_0")[1], "T1", np.nan).authority is not Authority.TURNED


@pytest.mark.parametrize(
    ("force", "way"), [(-39.0, Authority.PLANE), (50.3, Authority.PLANE), (-78.0, Authority.TURNED)]
)
def test_where_the_attitude_it_has_points_the_thrust_with_some_to_spare_it_keeps_it(made, force, way):
    """One component is missing. TURNED it is off its line by 0.2 to 0.4 m, so by 0.01 m, but by 6 to 31 m at -78 N."""
    assert left_beside(made("drawn6_3")[1], "T5", force).authority is way


@pytest.mark.parametrize(
    ("name", "thruster", "force", "drifts", "way"),
    [
        ("no_sway", "T4", -5.0, True, Authority.LINE),  # held at rest, tilted: the others are pointed there
        ("six_two_astern_four_up", "T3", -39.9, True, Authority.PLANE),
        ("four_astern_verticals_in_line", "T3", 25.7, True, Authority.TURNED),  # no attitude holds it at rest
        ("drawn6_3", "T3", -78.0, False, Authority.TURNED),  # what is stuck turns it on and on, and so the others
    ],
)
def test_one_that_water_from_a_side_would_carry_along_points_its_thrust_where_it_can(
    made, name, thruster, force, drifts, way
):
    hull = made(name)[1]
    left = left_beside(hull, thruster, force)
    assert left.authority is way
    turned = turned_round(hull.dynamics, left.budget)
    assert turned.wanders_m < NEAR_M  # in still water it would stay
    assert drifts_aside(hull.dynamics, left.budget, turned.torque, 0.3) is drifts


@pytest.mark.flight
def test_across_a_current_it_keeps_its_line_with_a_vertical_thruster_stuck(made):
    """Turned round, with the force first, it was carried along with the water, 15 m in 80 s."""
    scenario = {
        "schema_version": 1,
        "name": "across",
        "model": str(made("no_sway")[0]),
        "duration_s": 70.0,
        "path": {"type": "line", "start_m": [0.0, 0.0, -20.0], "end_m": [60.0, 0.0, -20.0]},
        "initial": {"position_m": [0.0, 0.0, -20.0]},
        "guidance": {"speed_m_s": 0.5},
        "current_m_s": [0.0, 0.2, 0.0],
        "events": [thruster_event(30.0, ["T4"], "stuck", force_N=-5.0)],
        "checks": FORCES_ONLY,
    }
    (flown,) = cube_sim.fly_many(scenario, [{}], signals=["pose.position", "health.authority"])
    place = flown.signals["pose.position"]
    off = place[place[:, 0] >= 30.0, 2:] - np.array([0.0, -20.0])
    assert np.linalg.norm(off, axis=1).max() < 0.3
    assert np.linalg.norm(off[-500:], axis=1).max() < 0.02
    assert flown.signals["health.authority"][-1, 1] == Authority.LINE


def test_it_is_let_turn_where_the_attitude_takes_what_the_force_needs(made):
    hull = made("drawn6_3")[1]
    left = left_beside(hull, "T3", -78.0)
    fought, let = (wanders_m(hull.dynamics, left.budget, torque) for torque in (TORQUE, LET_TURN))
    assert let < 0.5 * fought
    assert (left.turned.wanders_m, left.turned.torque) == (let, LET_TURN)


def test_the_analysis_says_how_far_it_wanders(made):
    hull = made("four_with_one_aside")[1]
    near, far = fault_cases(hull, 0.3, faults=[Fault("T2", 25.7), Fault("T4", 25.7)])
    assert near.authority is far.authority is Authority.TURNED
    assert near.follows
    assert not far.follows
    assert "once what is stuck turns it over it wanders by" in far.reason
    assert "as long as it stays level it is carried off, " in far.reason
    assert "carried off" not in near.transient.reason
    for case in (near, far):
        assert np.isinf(case.transient.bound_m)
        assert 0.0 < case.transient.wanders_m == case.transient_at_rest.wanders_m
        assert f"it wanders by {case.transient.wanders_m:.2g} m" in case.transient.reason
    assert near.rest_m_s == 0.0 < far.rest_m_s


def test_one_whose_force_comes_first_is_not_said_to_be_carried_off(made):
    """No attitude holds it at rest; flown, it is never farther than 0.2 m off its place."""
    (case,) = fault_cases(made("bluerov2_vectored")[1], 0.3, faults=[Fault("T2", -39.9)])
    assert case.authority is Authority.TRIM
    assert case.rest_m_s == 0.0


@pytest.mark.flight
def test_spinning_it_does_not_take_the_lag_of_its_thrusters_for_a_current():
    """Taken for one of 0.5 m/s, it led the CUBE 0.14 m off its helix; 0.2 m with a third thruster stuck at 15 N."""
    scenario = yaml.safe_load((SCENARIOS / "cube_lose_two.yaml").read_text(encoding="utf-8"))
    scenario |= {"model": str(MODELS / "cube.xml"), "checks": FORCES_ONLY}
    scenario["events"] = [thruster_event(40.0, ["T1", "T2"], "stuck", force_N=10.0)]
    wanted = ["path_error.cross_track", "water.estimated", "velocity.angular", "health.authority"]
    (flown,) = cube_sim.fly_many(scenario, [{}], signals=wanted)
    off, water, rates, authority = (flown.signals[name] for name in wanted)
    assert authority[-1, 1] == Authority.TURNED
    late = rates[:, 0] >= 50.0
    assert np.linalg.norm(rates[late, 1:], axis=1).mean() > 1.0
    assert np.abs(water[water[:, 0] >= 40.0, 1:] - [0.1, 0.0, 0.0]).max() < 0.1
    assert np.abs(off[off[:, 0] >= 40.0, 1]).max() < 0.03


@pytest.mark.flight
@pytest.mark.parametrize("moving", [True, False])
@pytest.mark.parametrize(("name", "thruster", "force"), TURNED)
def test_flown_it_stays_within_decimetres_where_pointing_the_thrust_leads_metres_off(
    made, name, thruster, force, moving
):
    """With the thrust pointed these were off by 3 to 15 m; a clipped PID by 0.4 to 2 m."""
    line = {"type": "line", "start_m": [0.0, 0.0, -20.0], "end_m": [60.0, 0.0, -20.0]}
    scenario = {
        "schema_version": 1,
        "name": "turned",
        "model": str(made(name)[0]),
        "duration_s": 40.0,
        "path": line if moving else {"type": "point", "position_m": [0.0, 0.0, -20.0]},
        "initial": {"position_m": [0.0, 0.0, -20.0], "velocity_m_s": [0.3 if moving else 0.0, 0.0, 0.0]},
        "guidance": {"speed_m_s": 0.3},
        "allocation": {"method": "search"},
        "events": [thruster_event(10.0, [thruster], "stuck", force_N=force)],
        "checks": FORCES_ONLY,
    }
    (flown,) = cube_sim.fly_many(scenario, [{}], signals=["pose.position", "health.authority"])
    place = flown.signals["pose.position"]
    off = place[place[:, 0] >= 10.0, 1:] - np.array([0.0, 0.0, -20.0])
    assert np.linalg.norm(off[:, 1:] if moving else off, axis=1).max() < 0.3
    assert flown.signals["health.authority"][-1, 1] == Authority.TURNED
    if moving:
        assert off[-1, 0] > off[0, 0] + 3.0  # it goes on, too
