"""Finding out what a thruster does from what it was told, when that is plain and when it can be read in two ways."""

from collections.abc import Callable

import numpy as np
import pytest

from cube_sim.allocation import Health
from cube_sim.control.diagnosis import Diagnosis
from cube_sim.control.probing import Probes
from cube_sim.control.window_reading import Evidence, read_at_once

DT, LAG, THRESHOLD, PROBE = 0.02, 0.02, 1.0, 3.0
FULL = 40.0
"""Force of a whole thruster at command 1 [N]; its characteristic is a straight line."""

State = tuple[float, float | None]
"""(efficiency, force held or None) of the true thruster."""
WHOLE, DEAD = (1.0, None), (0.0, None)


class Bench:
    """One thruster, the forces it is told, and a diagnosis in the loop that also believes itself: as it flies."""

    def __init__(self) -> None:
        self.diagnosis = Diagnosis(0.5, THRESHOLD, DT, np.array([PROBE]))
        self.activation = np.zeros(1)
        self.told, self.given = [], []
        self.beliefs: list[tuple[float, Health]] = []

    def run(self, seconds: float, state: State, wanted: Callable[[float], float]) -> Health:
        """Let it work in this state, forces [N] being wanted as a function of the time since its start."""
        diagnosis = self.diagnosis
        for _ in range(round(seconds / DT)):
            t = len(self.told) * DT
            efficiency, held = state
            whole = FULL * self.activation
            given = efficiency * whole if held is None else np.array([held])
            before = diagnosis.health
            health = diagnosis.update(whole, given)
            if not health.equals(before):
                self.beliefs.append((t, health))
            asked = np.zeros(1)
            if health.responsive[0]:
                asked[0] = wanted(t) / health.efficiency[0]
            asked = diagnosis.probed(asked)
            self.activation = asked / FULL + (self.activation - asked / FULL) * np.exp(-DT / LAG)
            self.told.append(float(asked[0]))
            self.given.append(float(given[0]))
        return diagnosis.health


def lively(t: float) -> float:
    return 18.0 * np.sin(2.5 * t) + 7.0 * np.sin(7.1 * t + 1.0)


def constant(t: float) -> float:
    del t
    return 12.0


def creeping(t: float) -> float:
    return 12.0 + 3.0 * np.sin(0.1 * t)


@pytest.mark.parametrize("wanted", [lively, constant, creeping])
@pytest.mark.parametrize(
    ("state", "efficiency", "stuck"),
    [(WHOLE, 1.0, np.nan), (DEAD, 0.0, np.nan), ((0.5, None), 0.5, np.nan), ((0.0, 7.0), 0.0, 7.0)],
)
def test_a_fault_is_found_from_command_and_response(state, efficiency, stuck, wanted):
    bench = Bench()
    assert bench.run(2.0, WHOLE, wanted).equals(Health.whole(1))
    health = bench.run(4.0, state, wanted)
    assert health.efficiency[0] == pytest.approx(efficiency, abs=0.06)
    np.testing.assert_allclose(health.stuck[0], stuck, atol=1e-9)
    if state is not WHOLE:
        assert bench.beliefs[-1][0] <= 2.0 + 1.2


@pytest.mark.flight
@pytest.mark.parametrize("rate", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("held", [6.0, 10.0, 14.0])
def test_a_stuck_motor_is_never_taken_for_a_weak_one_however_slowly_it_is_told_something_else(held, rate):
    """Its force fits y = e x for any x that stands still, and nearly for one that creeps."""
    bench = Bench()
    bench.run(2.0, WHOLE, lambda _: held)
    bench.run(0.6, (0.0, held), lambda _: held)  # it sticks where it is and nothing shows
    assert not bench.beliefs
    health = bench.run(12.0 / rate, (0.0, held), lambda t: held + rate * (t - 2.6))
    assert health.stuck[0] == pytest.approx(held)
    assert len(bench.beliefs) == 1
    assert rate * (bench.beliefs[0][0] - 2.6) < max(2.0, 0.2 * held) + rate  # before it matters much


def test_a_motor_believed_weak_that_has_stuck_is_found_out():
    bench = Bench()
    bench.run(2.0, WHOLE, lively)
    assert bench.run(3.0, (0.6, None), lively).efficiency[0] == pytest.approx(0.6, abs=0.03)
    bench.run(3.0, (0.6, None), lambda _: 9.0)
    health = bench.run(12.0, (0.0, 9.0), lambda t: 9.0 + 0.5 * (t - 8.0))
    assert health.stuck[0] == pytest.approx(9.0)


@pytest.mark.parametrize("state", [DEAD, (0.0, 20.0), (0.5, None), (0.0, -6.0)])
@pytest.mark.parametrize("wanted", [lively, constant])
def test_a_motor_that_recovers_is_found_whole_within_a_period_of_the_probes(state, wanted):
    bench = Bench()
    bench.run(2.0, WHOLE, wanted)
    assert not bench.run(7.3, state, wanted).equals(Health.whole(1))
    assert bench.run(6.0, WHOLE, wanted).equals(Health.whole(1))


def test_what_a_lost_motor_does_instead_is_found_out():
    bench = Bench()
    bench.run(2.0, WHOLE, lively)
    assert bench.run(2.0, (0.0, 20.0), lively).stuck[0] == 20.0
    assert bench.run(1.0, (0.0, 30.0), lively).stuck[0] == 30.0
    health = bench.run(1.0, DEAD, lively)
    assert (health.efficiency[0], np.isnan(health.stuck[0])) == (0.0, True)
    assert bench.run(1.0, (0.0, -8.0), lively).stuck[0] == -8.0
    bench.run(1.0, DEAD, lively)
    assert bench.run(11.0, (0.6, None), lively).efficiency[0] == pytest.approx(0.6, abs=0.05)


def test_a_healthy_motor_is_left_alone_through_rests_and_jumps():
    rng = np.random.default_rng(4)
    jumps = rng.choice([0.0, 0.0, 2.0, -9.0, 15.0, 30.0, -25.0], size=200)
    bench = Bench()
    bench.run(60.0, WHOLE, lambda t: jumps[int(t / 0.3)])
    assert not bench.beliefs
    assert bench.told == [jumps[int(k * DT / 0.3)] for k in range(len(bench.told))]  # and never probed


def test_a_characteristic_known_to_a_few_percent_is_whole():
    bench = Bench()
    bench.run(20.0, (0.93, None), lively)
    bench.run(20.0, (0.93, None), lambda _: 38.0)
    assert not bench.beliefs
    assert max(bench.told[1200:]) == min(bench.told[1200:]) == 38.0


def test_dead_motors_are_probed_in_turn_and_briefly():
    probes = Probes(np.array([3.0, -3.0, 3.0]), DT, period_s=5.0, length_s=0.3)
    health = Health(np.array([0.0, 0.0, 1.0]), np.full(3, np.nan))
    asked = np.array(
        [probes.with_probe(np.array([0.0, 0.0, 8.0]), health, np.zeros(3, dtype=bool)) for _ in range(1000)]
    )
    assert set(asked[:, 0]) == {0.0, 3.0}
    assert set(asked[:, 1]) == {0.0, -3.0}
    assert set(asked[:, 2]) == {8.0}
    assert not np.any((asked[:, 0] != 0.0) & (asked[:, 1] != 0.0))
    for thruster in (0, 1):
        on = np.flatnonzero(asked[:, thruster])
        starts = on[np.diff(on, prepend=-10) > 1]
        assert len(on) == 15 * len(starts)
        assert starts[0] * DT >= 5.0 - DT  # it has only just been found dead
        np.testing.assert_array_equal(np.diff(starts), 250)


def test_a_probe_ends_when_its_motor_has_answered():
    bench = Bench()
    bench.run(2.0, WHOLE, constant)
    bench.run(4.0, DEAD, constant)
    told = len(bench.told)
    bench.run(6.0, WHOLE, constant)
    probe = np.array(bench.told[told:]) == PROBE
    assert 1 <= np.count_nonzero(probe) <= 8  # of the 15 control periods it may take


@pytest.mark.parametrize("before", [0.6, 0.98, 4.0, 12.0])
@pytest.mark.parametrize("after", [1.3, 1.5, 2.0, 14.0])
def test_a_motor_that_dies_is_not_called_weak_on_the_way(before, after):
    """While the window holds what was before and what is, a line may fit both a little."""
    bench = Bench()
    bench.run(2.0, WHOLE, lambda _: before)
    bench.run(3.0, DEAD, lambda _: after)
    assert [health.efficiency[0] for _, health in bench.beliefs] == [0.0]


@pytest.mark.parametrize("held", [-14.0, -40.0, 31.0, 40.0])
@pytest.mark.parametrize("wanted", [lively, constant, creeping])
def test_a_motor_that_sticks_far_from_what_it_is_told_is_known_after_a_few_readings(held, wanted):
    bench = Bench()
    bench.run(3.0, WHOLE, wanted)
    bench.run(0.12, (0.0, held), lambda t: wanted(t + 3.0))
    (t, health), *_ = bench.beliefs
    assert t <= 3.1
    assert health.stuck[0] == held
    bench.run(10.0, (0.0, held), lambda t: wanted(t + 3.12))
    assert len(bench.beliefs) == 1


@pytest.mark.parametrize("efficiency", [1.0, 0.4, 0.0])
@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_nothing_that_works_is_taken_for_stuck_at_once(efficiency, noise):
    rng = np.random.default_rng(3)
    evidence = Evidence(THRESHOLD, noise, (0.8, 1.25))
    for _ in range(4000):
        x = rng.uniform(-FULL, FULL) + rng.choice([0.0, 0.1, 5.0]) * rng.standard_normal(5)
        y = rng.uniform(0.8, 1.25) * efficiency * x + noise * rng.standard_normal(5)
        assert read_at_once(x, y, evidence) is None
