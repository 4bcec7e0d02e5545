"""The judgement of a mission's thrusters: asked once at the start, and the same one for everyone."""

import numpy as np
import pytest
from support.places import SCENARIOS

import cube_sim
from cube_sim.control import judged_capability
from cube_sim.control.authority import Authority
from cube_sim.control.path_follower import PathFollower
from cube_sim.mission import ability, prepare
from cube_sim.mission.ability import with_fins
from cube_sim.scenario import load
from cube_sim.vehicle.fin_health import FinHealth
from cube_sim.wrench.health import Health

CUBE = SCENARIOS / "cube_free.yaml"
JACK = SCENARIOS / "jack_lose_two.yaml"
BRIEF = {"duration_s": 0.2, "checks": [{"kind": "allowed_forces"}]}


@pytest.fixture
def asked(monkeypatch):
    """Cost limits the thrusters have been judged for."""
    limits = []

    def judge(A, limits_N, health, cost_limit=None, hold=None):
        limits.append(cost_limit)
        return judged_capability.remaining_capability(A, limits_N, health, cost_limit, hold)

    monkeypatch.setattr(ability, "remaining_capability", judge)
    return limits


def test_a_healthy_flight_asks_for_the_judgement_once(asked, tmp_path):
    cube_sim.run(CUBE, BRIEF, out=tmp_path / "run")
    assert asked == [None]


def test_a_cost_limit_asks_what_there_is_without_it_and_within_it(asked, tmp_path):
    cube_sim.run(CUBE, BRIEF | {"control.cost_limit": 4.5}, out=tmp_path / "run")
    assert asked == [None, 4.5]


@pytest.fixture
def jack():
    """A mission within 1 N/N: its sway costs 1.93, surge and yaw half of one."""
    return prepare(load(JACK, {"control.cost_limit": 1.0}))


def test_what_the_controller_flies_with_is_what_the_mission_holds(jack):
    assert isinstance(jack.controller, PathFollower)
    assert jack.controller.capability is jack.ability.within_limit
    assert jack.ability.whole.authority is Authority.LEVEL
    assert jack.ability.within_limit.authority is Authority.UNICYCLE


def test_a_loss_is_judged_by_the_same_limit_and_water(jack):
    again = jack.ability.left(Health.whole(len(jack.vehicle.thrusters.names)))
    assert again.authority is Authority.UNICYCLE
    assert np.array_equal(again.effort, jack.ability.within_limit.effort)


@pytest.mark.parametrize("name", ["remus100_line", "remus100_propeller", "nps_auv2_line"])
def test_a_fin_that_is_short_of_travel_counts_with_what_is_left_of_it(name):
    """And one that is too short for the path is said to be."""
    mission = prepare(load(SCENARIOS / f"{name}.yaml", {"duration_s": 300}))
    fins = mission.fins.fins
    index = next(i for i, each in enumerate(fins.names) if "rudder" in each or "fin" in each)
    whole, known = Health.whole(len(mission.vehicle.thrusters.names)), FinHealth.whole(len(fins.names))
    A, limits, fin = mission.ability.A, mission.ability.limits, mission.ability.fins
    row = len(limits) + index
    before = with_fins(A, limits, whole, fin, known)[1]
    half = known.with_fin(index, travel=tuple(0.5 * fins.travel[index]))
    after = with_fins(A, limits, whole, fin, half)[1]
    np.testing.assert_allclose(after[row, [0, 3]], 0.5 * before[row, [0, 3]], rtol=0.02)
    np.testing.assert_array_equal(np.delete(after, row, axis=0), np.delete(before, row, axis=0))
    assert mission.ability.left(whole, half).authority is mission.ability.left(whole).authority
    one_sided = known.with_fin(index, travel=(0.01, 0.05))
    jammed = known.with_fin(index, jammed=True, angle=0.03)
    short, stands = (mission.ability.left(whole, each) for each in (one_sided, jammed))
    assert short.authority is stands.authority
    assert not short.by_flow or short.budget is not None
