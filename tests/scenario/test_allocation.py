"""The allocation block of a scenario: what it makes of its keys, and what it refuses."""

from typing import get_args

import numpy as np
import pytest
from support.places import HELIX

import cube_sim
from cube_sim.allocation import Allocator, Health
from cube_sim.allocation.options import BaselineMethod
from cube_sim.errors import ScenarioError
from cube_sim.mission.prepare import prepare
from cube_sim.scenario import load

PLAIN = {"allocation.reversal_penalty_N2": 0.0, "allocation.switching_penalty_N2": 0.0}
TARGET = [9.0, -9.0, 8.0, -8.0, -7.0, 7.0, -6.0, 6.0]
WEIGHTS = [1.0, 50.0, 2.0, 1.0, 70.0, 1.0, 50.0, 3.0]
WRENCH = np.array([30.0, -12.0, 20.0, 1.0, -0.5, 2.0])


@pytest.mark.parametrize("lost", [(), (2,)])
@pytest.mark.parametrize("options", [{"target": TARGET}, {"weights": WEIGHTS}, {"target": TARGET, "weights": WEIGHTS}])
def test_targets_and_weights_are_those_of_the_thrusters_in_their_order(options, lost):
    """Also after a loss, when the others keep theirs."""
    keys = {"target": "allocation.target_N", "weights": "allocation.thruster_weights"}
    changes = PLAIN | {keys[name]: value for name, value in options.items()}
    objective = "target" if "target" in options else "energy"
    allocator = prepare(load(HELIX, {**changes, "allocation.objective": objective})).allocator
    allocator.set_health(Health(np.where(np.isin(np.arange(8), lost), 0.0, 1.0), np.full(8, np.nan)))
    left = np.delete(np.arange(8), lost)
    given = {name: np.array(value)[left] for name, value in options.items()}
    alone = Allocator(allocator.A[:, left], allocator.limits[left], objective=objective, **given).allocate(WRENCH)
    answer = allocator.allocate(WRENCH)
    np.testing.assert_allclose(answer.force[left], alone.force, atol=1e-9)
    assert answer.cost == pytest.approx(alone.cost)
    plain = prepare(load(HELIX, PLAIN)).allocator.allocate(WRENCH)
    assert np.abs(answer.force - plain.force).max() > 0.5


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"objective": "target"}, "allocation.target_N: the objective target needs a preferred force per thruster"),
        ({"target_N": TARGET}, "allocation.target_N: the objective energy has no target; give objective: target"),
        ({"objective": "target", "target_N": [1.0, 2.0]}, "allocation.target_N: 2 numbers for 8 thrusters; .* T1, T2"),
        ({"thruster_weights": [1.0] * 9}, "allocation.thruster_weights: 9 numbers for 8 thrusters"),
        ({"thruster_weights": [1.0] * 7 + [0.0]}, "allocation.thruster_weights.7: must be at least 1e-06"),
        ({"thruster_weights": [1e-6] * 7 + [1e2]}, r"spans 1e-06 to 100; a ratio of 1e\+06 at most is solvable"),
        ({"torque_weight": 1e8}, r"allocation.torque_weight: must be at most 1e"),
        ({"torque_weight": 1e-8}, "allocation.torque_weight: must be at least"),
        ({"reversal_penalty_N2": 1e300}, "allocation.reversal_penalty_N2: must be at most"),
        ({"method": "contraction", "objective": "target", "target_N": TARGET}, "knows no objective but energy"),
    ],
)
def test_a_mistake_is_named_at_its_place(changes, message):
    with pytest.raises(ScenarioError, match=message) as refused:
        prepare(load(HELIX, {f"allocation.{key}": value for key, value in changes.items()}))
    assert len(refused.value.mistakes) == 1


@pytest.mark.flight
def test_a_penalty_is_not_paid_for_again_at_every_tick(tmp_path):
    """At 0.12 m/s the thrusters work near their dead zones, and an arrangement that saves 25 N^2 saves it for long."""
    square, changes = {}, {}
    for penalty in (0.0, 64.0):
        keys = {**dict.fromkeys(PLAIN, penalty), "guidance.speed_m_s": 0.12, "duration_s": 60.0}
        force = cube_sim.run(HELIX, keys, out=tmp_path / f"{penalty:g}").signals["thrusters.force_demanded"]
        settled = force[force[:, 0] > 40.0, 1:]
        square[penalty] = np.mean(np.sum(settled**2, axis=1))
        changes[penalty] = np.count_nonzero(np.diff(np.sign(settled), axis=0)) / (8 * 20.0 / 60.0)
    assert square[64.0] < 1.1 * square[0.0]
    assert changes[64.0] < 0.05 * changes[0.0]


@pytest.mark.parametrize("method", get_args(BaselineMethod))
def test_methods_are_compared_by_one_key(method):
    """The others leave aside what only exact methods know, as the schema says."""
    others = {"change_limit_N": 3.0, "unattainable": "scaled", "torque_weight": 3.0, "thruster_weights": WEIGHTS}
    changes = {f"allocation.{key}": value for key, value in others.items()}
    with_them = prepare(load(HELIX, {**changes, "allocation.method": method})).allocator.allocate(WRENCH)
    without = prepare(load(HELIX, {**PLAIN, "allocation.method": method})).allocator.allocate(WRENCH)
    assert with_them.force.tobytes() == without.force.tobytes()
