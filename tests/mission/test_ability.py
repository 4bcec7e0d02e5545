"""The judgement of a mission's thrusters: asked once at the start, and the same one for everyone."""

import numpy as np
import pytest
from support.places import SCENARIOS

import cube_sim
from cube_sim.control import authority
from cube_sim.control.authority import Authority
from cube_sim.control.path_follower import PathFollower
from cube_sim.mission import ability, prepare
from cube_sim.scenario import load
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
        return authority.remaining_capability(A, limits_N, health, cost_limit, hold)

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
