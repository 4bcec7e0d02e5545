"""What every allocator owes to those who ask it, and what it takes to import one."""

import subprocess
import sys
from typing import get_args

import numpy as np
import pytest
from support.layouts import jack

from cube_sim.allocation import Allocation, Allocator, FaultTolerant, Health, Status
from cube_sim.allocation.methods import BASELINES, is_exact, make_allocator, methods
from cube_sim.allocation.options import BaselineMethod
from cube_sim.errors import ActuationError, AllocationError, WrenchError
from cube_sim.scenario.allocation_block import MethodName
from cube_sim.wrench.matrix import actuation_matrix

LIMITS = [-40.0, -3.2, 4.0, 50.0]
PRIMARY, SECONDARY = np.array([5.0, 2.0, 1.0]), np.array([80.0, 0.0, 0.0])


class FirstPartOnly:
    """A user's own allocator: it drops the secondary part, and never mind the limits."""

    def __init__(self, A):
        self.A, self.asked = A, []

    def allocate(self, wrench):
        self.asked.append((np.array(wrench), None))
        return self.answer(wrench, wrench)

    def allocate_by_priority(self, primary, secondary):
        self.asked.append((np.array(primary), np.array(secondary)))
        return self.answer(primary, np.add(primary, secondary))

    def reset(self):
        pass

    def resume(self, previous):
        self.previous = previous

    def answer(self, made, demand):
        force = np.linalg.pinv(self.A) @ made
        error = demand - self.A @ force
        return Allocation(force, self.A @ force, error, float(np.abs(error).max()), 0.0, np.sign(force), Status.YIELDED)


def test_an_own_allocator_is_asked_by_priority():
    built = []

    def build(A, limits, which):
        built.append(FirstPartOnly(A))
        return built[-1]

    allocator = FaultTolerant(jack(), LIMITS, build)
    answer = allocator.allocate(PRIMARY + SECONDARY, SECONDARY)
    (asked,) = built[-1].asked
    np.testing.assert_allclose(asked, (PRIMARY, SECONDARY))
    np.testing.assert_allclose(answer.wrench, PRIMARY, atol=1e-9)
    np.testing.assert_allclose(answer.wrench_error, SECONDARY, atol=1e-9)
    assert answer.status == Status.YIELDED
    assert np.all(allocator.allocate(PRIMARY, np.zeros(3)).wrench_error < 1e-9)
    assert built[-1].asked[-1][1] is None


def test_an_own_allocator_is_not_told_what_a_stuck_thruster_makes():
    A, built = jack(), []
    allocator = FaultTolerant(A, LIMITS, lambda A, limits, which: built.append(FirstPartOnly(A)) or built[-1])
    allocator.set_health(Health.whole(4).with_thruster(1, stuck=6.0))
    answer = allocator.allocate(PRIMARY + SECONDARY, SECONDARY)
    primary, secondary = built[-1].asked[-1]
    np.testing.assert_allclose(primary, PRIMARY - A[:, 1] * 6.0)
    np.testing.assert_allclose(secondary, SECONDARY)
    assert answer.force[1] == 6.0
    np.testing.assert_allclose(answer.wrench, A @ answer.force, atol=1e-9)


@pytest.mark.parametrize("method", [method for method in methods() if not is_exact(method)])
def test_a_baseline_answers_both_parts_as_one_demand(method):
    parts, whole = make_allocator(method, jack(), LIMITS), make_allocator(method, jack(), LIMITS)
    for share in (0.1, 1.0, 5.0):
        answer, expected = (
            parts.allocate_by_priority(PRIMARY, share * SECONDARY),
            whole.allocate(PRIMARY + share * SECONDARY),
        )
        for got, wanted in zip(answer, expected, strict=True):
            np.testing.assert_array_equal(got, wanted)
    assert parts.allocate_by_priority([1e308, 0, 0], [1e308, 0, 0]).status == Status.INVALID_WRENCH
    with pytest.raises(AllocationError, match=r"shape \(2,\); A has 3 rows"):
        parts.allocate_by_priority(PRIMARY, [1.0, 2.0])


def test_every_baseline_has_its_name_and_every_name_its_baseline():
    """See `BaselineMethod` in cube_sim/allocation/options.py and `BASELINES` in cube_sim/allocation/methods.py."""
    assert tuple(BASELINES) == get_args(BaselineMethod)


def test_the_scenario_knows_the_methods_there_are():
    assert get_args(MethodName) == methods()


def test_one_check_of_a_matrix_serves_the_analysis_and_the_allocators():
    for error in (WrenchError, ActuationError, AllocationError):
        with pytest.raises(error, match="nan in row 1, column 1"):
            actuation_matrix(np.full((3, 4), np.nan))
        with pytest.raises(error, match="nan in row 1, column 1"):
            Allocator(np.full((3, 4), np.nan), LIMITS)


LIGHT = "import sys; import {}; print(*sorted({{'numba', 'proxsuite', 'mujoco', 'scipy'}} & set(sys.modules)))"
PLAIN = "arguments allowed_forces axes facets health limits matrix names tolerances zonotope"


@pytest.mark.parametrize(
    "imported",
    [
        "cube_sim.allocation.baselines.pseudo_inverse",
        "cube_sim.allocation.methods; cube_sim.allocation.methods.make_allocator("
        "'pseudo_inverse', [[1, 0], [0, 1], [0, 0]], [-1, 1]).allocate([0.5, 0, 0])",
        "cube_sim.allocation.fault_tolerant",
        ", ".join(f"cube_sim.wrench.{name}" for name in PLAIN.split()),
    ],
    ids=["pseudo_inverse", "make_allocator", "fault_tolerant", "wrench"],
)
def test_nothing_compiled_is_loaded_for_plain_algebra(imported):
    done = subprocess.run([sys.executable, "-c", LIGHT.format(imported)], capture_output=True, text=True)
    assert (done.returncode, done.stdout.strip()) == (0, ""), done.stderr
