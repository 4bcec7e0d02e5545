"""The whole analysis, the design indices and every loss of up to three thrusters."""

from collections import Counter
from itertools import combinations

import numpy as np
import pytest
from support.vehicles import cube

from cube_sim.actuation import Outcome, PathRequirements, analyse, survivability
from cube_sim.actuation.attainable.extents import extent
from cube_sim.actuation.directions.design_indices import indices
from cube_sim.actuation.directions.subspaces import subspaces
from cube_sim.errors import ActuationError

T200 = [-39.91, -0.356, 0.400, 51.44]


def test_cube_indices_are_those_of_its_symmetry():
    # W A (W A)' = 8/3 I with torques divided by the lever arm a sqrt 3.
    found = analyse(cube().actuation_matrix, [-40, 40]).indices
    assert found.manipulability == pytest.approx((8 / 3) ** 3)
    assert found.isotropy == pytest.approx(1)
    assert found.energy == pytest.approx(3 / 8)
    assert found.worst_energy == pytest.approx(3 / 8)
    assert found.reactivity == pytest.approx(3 / 8 * np.sqrt(2))
    assert 0 < found.robustness < 1
    assert found.tolerated_losses == 1


def test_indices_of_a_lost_component_say_so():
    found = analyse([[1, 1, 1, 1], [0, 0, 0, 0], [-1, 1, -1, 1]], T200).indices
    assert (found.manipulability, found.isotropy, found.robustness, found.tolerated_losses) == (0, 0, 0, 0)
    assert found.energy == found.worst_energy == found.reactivity == np.inf
    assert (found.weakest, found.volume) == (0, 0)


def test_energy_index_is_the_mean_over_the_unit_sphere():
    rng = np.random.default_rng(4)
    A = rng.normal(size=(6, 8))
    directions = rng.normal(size=(200_000, 6))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    forces = directions @ np.linalg.pinv(A).T
    found = indices(subspaces(A, length_m=1.0))
    assert found.energy == pytest.approx(np.mean(np.sum(forces**2, axis=1)), rel=0.01)
    assert np.max(np.sum(forces**2, axis=1)) <= found.worst_energy
    assert np.max(np.abs(forces)) <= found.reactivity
    assert found.reactivity == pytest.approx(np.max(np.abs(forces)), rel=0.1)


def test_weakest_wrench_bounds_every_component_alone():
    A = cube().actuation_matrix
    analysis = analyse(A, T200)
    assert analysis.indices.weakest is not None
    assert analysis.extents is not None
    W = analysis.subspaces.axes.scale(analysis.subspaces.length_m)
    reach = [min(-e.isolated[0], e.isolated[1]) * w for e, w in zip(analysis.extents, W, strict=True)]
    assert 0 < analysis.indices.weakest <= min(reach)
    rng = np.random.default_rng(8)
    for direction in rng.normal(size=(10, 6)):
        d = direction / np.linalg.norm(direction)
        assert extent(A, T200, d / W).isolated[1] >= analysis.indices.weakest - 1e-9


def test_lost_thrusters_are_left_out_and_the_length_stays():
    A = cube().actuation_matrix
    intact, damaged = analyse(A, T200), analyse(A, T200, lost=["T4", "T1"])
    assert damaged.lost == ("T1", "T4")
    assert damaged.names == ("T2", "T3", "T5", "T6", "T7", "T8")
    assert damaged.matrix.shape == (6, 6)
    assert damaged.subspaces.length_m == intact.subspaces.length_m
    assert intact.redundancy == 2
    assert damaged.rank + damaged.redundancy == 6
    assert len(damaged.unreachable) == 6 - damaged.rank


def test_analysis_hands_on_the_least_costly_directions():
    analysis = analyse([[1, 1, 1, 1], [1e-4, 0, 0, 0], [-1, 1, -1, 1]], cost_limit=100)
    assert analysis.rank == 2
    assert analysis.component_costs == pytest.approx([0.6124, 14142, 0.6124], rel=1e-4)
    assert analysis.gains == pytest.approx(analysis.directions.gains)
    assert analysis.directions.vectors.shape == (3, 3)
    assert np.allclose(analysis.kept.projector, np.diag([1, 0, 1]), atol=1e-3)
    assert analysis.extents is None
    assert analysis.verdict.outcome is Outcome.STEERED


@pytest.mark.parametrize(
    ("options", "dropped"),
    [
        ({}, ("", "", "rank")),
        ({"cost_limit": 1000}, ("", "", "cost")),
        ({"cost_limit": 2000}, ("", "", "")),
        ({"cost_limit": 2000, "rank_tolerance": 0.01}, ("", "", "rank")),
        ({"rank_tolerance": 0}, ("", "", "")),
    ],
)
def test_a_direction_is_dropped_by_rank_or_by_the_cost_limit_in_its_place(options, dropped):
    analysis = analyse([[1, 1, 1, 1], [1e-3, 0, 0, 0], [-1, 1, -1, 1]], [-40, 40], **options)
    assert analysis.dropped == dropped
    assert analysis.kept.vectors.shape[1] == analysis.rank == dropped.count("")
    assert len(analysis.unreachable) == 3 - analysis.rank
    assert np.allclose(analysis.kept.projector, analysis.subspaces.projector)


def test_what_is_possible_but_costly_is_not_called_impossible():
    A = np.array([[1, 1, 1, 1], [1e-4, 0, 0, 0], [-1, 1, -1, 1]])
    analysis = analyse(A, [-40, 40])
    (sway,) = analysis.unreachable
    assert sway.text == "too costly to push sideways: Fy = 0, but for 7.1e-05 N per N of thruster force"
    assert sway.gain == pytest.approx(1 / 14142, rel=1e-4)
    assert analysis.extents is not None
    assert 0 < analysis.extents[1].isolated[1] <= 40 * 2 * sway.gain
    assert analyse(A * [[1], [0], [1]]).unreachable[0].text == "cannot push sideways: Fy = 0 always"


def test_lost_and_malformed_thrusters_are_named():
    A = cube().actuation_matrix
    with pytest.raises(ActuationError, match=r"no thruster 'T9'; there are T1, T2, .*T8"):
        analyse(A, lost=["T9"])
    with pytest.raises(ActuationError, match="no thruster is left"):
        analyse(A[:, :2], lost=["T1", "T2"])
    with pytest.raises(ActuationError, match="8 different"):
        analyse(A, names=["port"] * 8)
    with pytest.raises(ActuationError, match="thruster 1"):
        analyse(A, [1, 0, 0, -1], lost=["T1"])


@pytest.mark.flight
def test_every_loss_of_up_to_three_thrusters_is_listed_once_and_the_cube_survives_what_its_rank_promises():
    vehicle = cube()
    table = survivability(
        vehicle.actuation_matrix,
        vehicle.thrusters.limits,
        names=vehicle.thrusters.names,
        hull=vehicle.dynamics,
        requirements=PathRequirements(inclinations_rad=(0.0,)),
    )
    wanted = [set(lost) for k in range(4) for lost in combinations(vehicle.thrusters.names, k)]
    assert [set(case.lost) for case in table.cases] == wanted
    ranks = Counter((len(case.lost), case.rank, case.pure_forces, case.pure_torques) for case in table.cases)
    assert ranks == {
        (0, 6, 3, 3): 1,
        (1, 6, 3, 3): 8,
        (2, 6, 3, 3): 16,
        (2, 5, 2, 2): 12,
        (3, 5, 2, 2): 48,
        (3, 4, 1, 1): 8,
    }
    assert all(case.verdict.follows for case in table.cases if case.rank >= 5)
    assert table.case("T3", "T1") is table.case("T1", "T3")
    intact = table.case()
    for case in table.cases:
        assert case.strongest_force <= intact.strongest_force + 1e-9
        assert case.strongest_torque <= intact.strongest_torque + 1e-9
        assert len(case.unreachable) == 6 - case.rank
        for before, after in zip(intact.extents, case.extents, strict=True):
            assert before.isolated[0] - 1e-9 <= after.isolated[0] <= 0 <= after.isolated[1] <= before.isolated[1] + 1e-9


def test_a_vehicle_never_loses_its_last_thruster():
    table = survivability([[1, 1], [0, 0], [-1, 1]], [-10, 10], most=3)
    assert table.most == 1
    assert [case.lost for case in table.cases] == [(), ("T1",), ("T2",)]
    with pytest.raises(ActuationError, match="no case"):
        table.case("T1", "T2")


@pytest.mark.flight
@pytest.mark.parametrize("m", [1, 2, 5, 8])
@pytest.mark.parametrize("n", [3, 6])
def test_any_matrix_of_finite_numbers_is_analysed(n, m):
    rng = np.random.default_rng((n, m))
    for rank in range(min(n, m) + 1):
        A = rng.normal(size=(n, rank)) @ rng.normal(size=(rank, m))
        analysis = analyse(A, T200, rank_tolerance=1e-9)
        assert analysis.rank == rank
        assert analysis.directions.gains.shape == (rank,)
        assert analysis.verdict.reason
        assert analysis.verdict.follows <= (rank >= 2)


@pytest.mark.flight
def test_losses_are_judged_within_the_cost_limit_and_on_top_of_what_is_lost():
    A = cube().actuation_matrix + 0.01 * np.random.default_rng(1).normal(size=(6, 8))
    free, limited = (survivability(A, T200, most=1, lost=["T1"], cost_limit=limit) for limit in (1e6, 5.0))
    assert free.already == limited.already == ("T1",)
    assert free.names == tuple(f"T{i}" for i in range(2, 9))
    assert {case.rank for case in free.cases} == {6}
    assert [case.lost[0] for case in limited.of(1) if case.rank == 5] == ["T2", "T3", "T4"]
    with pytest.raises(ActuationError, match="no case"):
        free.case("T1", "T2")
    with pytest.raises(ActuationError, match="no thruster 'T9'"):
        survivability(A, T200, lost=["T9"])


def test_a_table_of_too_many_losses_is_refused_before_it_begins():
    A = np.vstack([np.ones(12), np.zeros(12), np.arange(12) - 5.5])
    with pytest.raises(
        ActuationError, match="11 of 12 thrusters are lost in 4095 ways; 2000 are the most: ask for fewer"
    ):
        survivability(A, [-10, 10], most=99)
