"""What a demand beyond the thrusters becomes, and the flights that hang on it."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from support.flights import FORCES_ONLY
from support.places import SCENARIOS

import cube_sim
from cube_sim.control.planar.attainable_set import PlanarAttainableSet, range_left

CIRCLE = SCENARIOS / "infante_circle.yaml"


def hull(rng, thrusters):
    """Columns (6, m) and limits (m, 2) of a random hull that can push ahead and turn."""
    A = rng.normal(size=(6, thrusters)) * np.array([[1.0], [1.0], [1.0], [1.0], [1.0], [0.4]])
    return A, np.column_stack([-rng.uniform(5.0, 50.0, thrusters), rng.uniform(5.0, 50.0, thrusters)])


@pytest.mark.flight
@pytest.mark.parametrize("thrusters", [2, 3, 5])
def test_what_thrusters_can_make_is_left_as_it_is_and_what_they_cannot_comes_within_reach(thrusters):
    rng = np.random.default_rng(thrusters)
    for _ in range(20):
        A, limits = hull(rng, thrusters)
        attainable = PlanarAttainableSet.of(A, limits)
        # every edge is touched by a corner of the box of forces, none is passed
        corners = np.array([A[[0, 5]] @ force for force in product(*limits)])
        np.testing.assert_allclose((corners @ attainable.normals.T).max(axis=0), attainable.sizes, rtol=1e-12)
        for force in rng.uniform(limits[:, 0], limits[:, 1], (20, thrusters)):
            F, Gamma = (A[[0, 5]] @ force).tolist()
            assert attainable.saturate(F, Gamma) == (F, Gamma)
        for demand in rng.normal(size=(20, 2)) * 10.0 ** rng.uniform(2.0, 6.0, (20, 1)):
            cut = np.array(attainable.saturate(*demand.tolist()))
            assert (attainable.normals @ cut <= attainable.sizes * (1.0 + 1e-9)).all()


@pytest.mark.flight
@pytest.mark.parametrize("pairs", [1, 2, 3])
def test_a_hull_with_two_like_sides_gives_all_it_has(pairs):
    """A demand beyond reach ends on the edge, with no sign turned, and half of the torque or all it asked."""
    rng = np.random.default_rng(pairs)
    for _ in range(20):
        A, limits = hull(rng, pairs)
        A = np.hstack([A, A * np.array([[1.0], [-1.0], [1.0], [-1.0], [1.0], [-1.0]])])
        attainable = PlanarAttainableSet.of(A, np.vstack([limits, limits]))
        most = range_left(*attainable, 1, 0.0)[1]
        for demand in rng.normal(size=(20, 2)) * 10.0 ** rng.uniform(2.0, 6.0, (20, 1)):
            cut = np.array(attainable.saturate(*demand.tolist()))
            assert (attainable.normals @ cut >= attainable.sizes * (1.0 - 1e-9)).any() or np.allclose(cut, demand)
            assert cut[1] * demand[1] >= 0.0
            assert abs(cut[1]) >= min(0.5 * most, abs(demand[1])) * (1.0 - 1e-9)


def test_two_stern_thrusters_share_between_pushing_and_turning():
    """|F| + |Gamma| / b <= 2 L: half of it for each, and what one leaves for the other."""
    A = np.zeros((6, 2))
    A[0], A[5] = 1.0, [-0.6, 0.6]
    attainable = PlanarAttainableSet.of(A, np.array([[-800.0, 800.0]] * 2))
    assert attainable.saturate(1e5, 1e6) == pytest.approx((800.0, 480.0))
    assert attainable.saturate(-1e5, 1e6) == pytest.approx((-800.0, 480.0))
    assert attainable.saturate(1e5, -60.0) == pytest.approx((1500.0, -60.0))
    assert attainable.saturate(100.0, 1e6) == pytest.approx((100.0, 900.0))
    assert attainable.saturate(100.0, 900.0) == (100.0, 900.0)
    assert attainable.saturate(-600.0, 850.0) == pytest.approx((-600.0, 600.0))
    assert attainable.saturate(-600.0, 850.0, torque_share=0.9) == pytest.approx((850.0 / 0.6 - 1600.0, 850.0))
    assert attainable.saturate(-600.0, 990.0, torque_share=1.0) == pytest.approx((0.0, 960.0))


@pytest.mark.flight
@pytest.mark.parametrize("velocity", [[0.0, 0.0, 0.0], [-1.0, 0.5, 0.0]], ids=["at rest", "astern and sideways"])
def test_the_law_gathers_speed_and_converges_though_it_first_asks_for_a_hundred_times_the_torque(velocity, tmp_path):
    checks = {"checks": FORCES_ONLY, "duration_s": 30}
    run = cube_sim.run(CIRCLE, out=tmp_path / "out", overrides={"initial.velocity_m_s": velocity, **checks})
    late = run.signals["path_error.cross_track"][:, 0] > 25.0
    assert run.signals["path_error.cross_track"][late, 1].max() < 0.05
    assert np.abs(run.signals["velocity.linear"][late, 1] - 1.5).max() < 0.01
    # nothing asked for was missed by more than the dead zones take
    asked, given = (run.signals[f"wrench.{name}"][:, 1:] for name in ("demanded", "allocated"))
    assert np.abs(asked - given)[:, 0].max() <= 16.0
