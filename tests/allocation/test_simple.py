"""The allocators that only try their best, against what their authors promise, and every method in a flight."""

import numpy as np
import pytest
from support.allocation_reference import in_allowed_set
from support.flights import FORCES_ONLY
from support.layouts import cube, jack
from support.places import HELIX

import cube_sim
from cube_sim.allocation import Allocator, Status, make_allocator
from cube_sim.allocation.baselines.compensation import Compensation, common_regime
from cube_sim.allocation.methods import is_exact, methods
from cube_sim.errors import AllocationError

LIMITS = np.array([-40.0, -3.2, 4.0, 50.0])
SIMPLE = [method for method in methods() if not is_exact(method)]
SHORT = {"duration_s": 0.4, "checks": FORCES_ONLY}


def test_pseudo_inverse_is_the_pseudo_inverse_and_says_when_it_is_not_allowed():
    A = cube(direction_noise=0.05, seed=1)
    allocator = make_allocator("pseudo_inverse", A, LIMITS)
    seen = set()
    for wrench in np.random.default_rng(0).normal(size=(60, 6)) * [30, 30, 30, 5, 5, 5]:
        answer = allocator.allocate(wrench)
        assert np.allclose(answer.force, np.linalg.pinv(A) @ wrench)
        inside = in_allowed_set(answer.force, np.tile(LIMITS, (8, 1)), True).all()
        assert answer.status == (Status.EXACT if inside else Status.FORBIDDEN_FORCE)
        seen.add(answer.status)
    assert seen == {Status.EXACT, Status.FORBIDDEN_FORCE}


@pytest.mark.parametrize("method", [m for m in SIMPLE if m != "pseudo_inverse"])
@pytest.mark.parametrize("allow_off", [True, False], ids=["off", "strict"])
@pytest.mark.parametrize("vehicle", [jack(), cube(), cube(direction_noise=0.05, seed=2)[:, :7]], ids=["4", "8", "7"])
def test_forces_stay_allowed_and_status_tells_the_truth(method, allow_off, vehicle):
    n, m = vehicle.shape
    limits = np.tile(LIMITS, (m, 1))
    allocator = make_allocator(method, vehicle, LIMITS, {"allow_off": allow_off})
    rng = np.random.default_rng(3)
    for wrench in [np.zeros(n), *rng.normal(size=(60, n)) * 15, *rng.normal(size=(20, n)) * 200, np.full(n, np.nan)]:
        answer = allocator.allocate(wrench)
        demand = np.where(np.isfinite(wrench), wrench, 0.0)
        assert in_allowed_set(answer.force, limits, allow_off, 1e-9).all()
        assert np.allclose(answer.wrench, vehicle @ answer.force)
        assert np.allclose(answer.wrench_error, demand - answer.wrench)
        if np.isnan(wrench).any():
            assert answer.status == Status.INVALID_WRENCH
        else:
            assert answer.status == (Status.EXACT if answer.residual <= 5e-5 else Status.MISSED)


@pytest.mark.parametrize("size", [1e150, 1e300])
@pytest.mark.parametrize("method", SIMPLE)
def test_a_huge_demand_stays_a_number(method, size):
    answer = make_allocator(method, cube(), LIMITS).allocate([size, -size, 0, 0, 0, size])
    assert np.isfinite(answer.force).all()
    assert np.isfinite(answer.residual)


def test_clipping_cuts_and_rests():
    allocator = make_allocator("clipped_pseudo_inverse", np.diag([1.0, 1.0, 1.0]), [-9, -1, 2, 10])
    assert np.allclose(allocator.allocate([30.0, 1.9, -0.5]).force, [10.0, 0.0, 0.0])
    strict = make_allocator("clipped_pseudo_inverse", np.eye(3), [-9, -1, 2, 10], {"allow_off": False})
    assert np.allclose(strict.allocate([-30.0, 1.9, -0.5]).force, [-9.0, 2.0, -1.0])


def test_contraction_moves_every_force_over_its_dead_zone():
    A = cube()
    allocator = make_allocator("contraction", A, LIMITS)
    for wrench in np.random.default_rng(4).normal(size=(30, 6)) * [10, 10, 10, 2, 2, 2]:
        asked = np.linalg.pinv(A) @ wrench
        assert np.allclose(allocator.allocate(wrench).force, asked + np.where(asked < 0, -3.2, 4.0))
    assert not allocator.allocate(np.zeros(6)).force.any()


def test_compensation_of_the_jack_is_exact_where_the_rule_says():
    """Room for the common regime (1, 1, 1, 1): max - min of A^+ F against F_max+ - F_DZ+, mirrored for reverse."""
    A, limits = jack(), [-30.0, -4.0, 4.0, 30.0]
    allocator = Compensation(A, limits)
    assert np.allclose(allocator.regime, np.full(4, allocator.regime[0]), rtol=0.02)
    pinv, outcomes = np.linalg.pinv(A), []
    for wrench in np.random.default_rng(5).normal(size=(200, 3)) * [30, 10, 6]:
        allocator.reset()
        answer, asked = allocator.allocate(wrench), pinv @ wrench
        spread = np.ptp(asked)
        if abs(spread - 26.0) > 0.5:  # this kernel is (1, 1, 1, 1) to 1 %
            assert (answer.status == Status.EXACT) == (spread <= 26.0)
            outcomes.append(answer.status == Status.EXACT)
            if outcomes[-1]:
                assert np.all(answer.force >= 4.0 - 1e-9)
                assert np.min(answer.force) == pytest.approx(4.0)
    assert 20 < sum(outcomes) < 180


def test_regime_of_the_cube():
    """Its kernel contains (1, -1, 1, -1, -1, 1, -1, 1) and a twin: nothing moves every thruster by 1 N with less."""
    A = cube()
    regime = common_regime(Compensation(A, LIMITS)._model.kernel)
    assert np.allclose(np.abs(regime), 1.0)
    assert np.allclose(A @ regime, 0.0)


def test_compensation_keeps_its_direction_while_there_is_room():
    A = cube()
    allocator = Compensation(A, LIMITS)
    signs = {tuple(np.sign(allocator.allocate(w).force)) for w in np.random.default_rng(6).normal(size=(100, 6)) * 3}
    assert len(signs) == 1


def test_compensation_without_a_kernel_rests_in_the_dead_zone():
    allocator = Compensation(np.eye(6)[:, :4], LIMITS)
    assert not allocator.regime.any()
    assert np.allclose(allocator.allocate([10, 1, -20, -3, 0, 0]).force, [10, 0, -20, 0])


def test_an_option_of_another_method_is_named():
    with pytest.raises(AllocationError, match="contraction knows no reversal_penalty; it takes allow_off"):
        make_allocator("contraction", jack(), LIMITS, {"reversal_penalty": 3.0})
    with pytest.raises(AllocationError, match=r"no method 'magic'; there are search\+proxqp, search"):
        make_allocator("magic", jack(), LIMITS)
    assert isinstance(make_allocator("search", jack(), LIMITS, {"reversal_penalty": 3.0}), Allocator)


@pytest.mark.parametrize("method", [m for m in methods() if not is_exact(m)])
@pytest.mark.parametrize("size", [1e100, 1e250, 1e300])
def test_a_huge_demand_is_missed_by_what_it_exceeds_the_forces(method, size):
    answer = make_allocator(method, cube(), LIMITS).allocate([size, 0, 0, 0, 0, -size])
    assert answer.status in (Status.MISSED, Status.FORBIDDEN_FORCE)
    np.testing.assert_allclose(answer.wrench + answer.wrench_error, [size, 0, 0, 0, 0, -size], rtol=1e-12)
    np.testing.assert_allclose(answer.wrench, cube() @ answer.force, rtol=1e-9, atol=1e-9 * np.abs(answer.force).max())
    assert np.isfinite([answer.residual, answer.cost]).all()


@pytest.mark.flight
@pytest.mark.parametrize("method", [m for m in methods() if not m.startswith("enumerate")])
def test_every_method_flies(method, tmp_path):
    run = cube_sim.run(HELIX, {**SHORT, "allocation.method": method}, out=tmp_path / "run")
    force, wrench = run.signals["thrusters.force_demanded"][:, 1:], run.signals["wrench.allocated"][:, 1:]
    assert np.isfinite(force).all()
    assert np.abs(wrench).max() > 1.0


@pytest.mark.flight
@pytest.mark.parametrize("objective", ["reactivity", "reactivity_by_side"])
def test_objectives_fly_with_the_models_reactivity_points(objective, tmp_path):
    changes = {**SHORT, "allocation.objective": objective, "allocation.change_limit_N": 15.0}
    force = cube_sim.run(HELIX, changes, out=tmp_path / "run").signals["thrusters.force_demanded"][:, 1:]
    assert np.abs(force).mean() > 15.0
