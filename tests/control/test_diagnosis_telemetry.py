"""Faults found from telemetry whose gain is off and whose readings are noisy: none too many, none missed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from cube_sim.control.diagnosis import Diagnosis
from cube_sim.control.telemetry_gain import TelemetryGain, learn_gains
from cube_sim.spatial import Vector
from cube_sim.wrench.health import Health

DT, LAG, THRESHOLD, FULL, M = 0.02, 0.02, 0.5, 40.0, 8
TOLERANCE = 0.1


class Belief(NamedTuple):
    """A change of belief: when [s], of which thruster, to what."""

    time: float
    thruster: int
    efficiency: float
    stuck: float


class Bench:
    """Eight thrusters that are told to swing about, and a diagnosis that is believed: as it flies."""

    def __init__(self, seed: int, gain: Vector, noise: float) -> None:
        self.random, self.gain, self.noise = np.random.default_rng(seed), gain, noise
        probe = max(3.0 * THRESHOLD, 30.0 * noise / np.sqrt(15.0))
        self.diagnosis = Diagnosis(0.5, THRESHOLD, DT, np.full(M, probe), noise, TOLERANCE)
        draw = self.random.uniform
        self.mean, self.swing = draw(-10.0, 10.0, M), draw(3.0, 12.0, M)
        self.rate, self.phase = draw(0.3, 3.0, M), draw(0.0, 2.0 * np.pi, M)
        self.activation, self.ticks, self.probes = np.zeros(M), 0, 0
        self.beliefs: list[Belief] = []

    def run(self, seconds: float, true: Health) -> list[Belief]:
        """Let them work in this state; returns what came to be believed."""
        start = len(self.beliefs)
        for _ in range(round(seconds / DT)):
            t = self.ticks * DT
            whole = FULL * self.activation
            given = np.where(np.isnan(true.stuck), true.efficiency * whole, true.stuck)
            reading = self.gain * given + self.noise * self.random.normal(size=M)
            before = self.diagnosis.health
            health = self.diagnosis.update(whole, reading)
            for i in range(M):
                now = health.efficiency[i], health.stuck[i]
                if not np.array_equal(now, (before.efficiency[i], before.stuck[i]), equal_nan=True):
                    self.beliefs.append(Belief(t, i, float(now[0]), float(now[1])))
            wanted = self.mean + self.swing * np.sin(self.rate * t + self.phase)
            share = np.where(health.responsive, health.efficiency, np.inf)
            asked = np.clip(wanted / share, -FULL, FULL)
            probed = self.diagnosis.probed(asked)
            self.probes += int(np.any(probed != asked))
            self.activation = probed / FULL + (self.activation - probed / FULL) * np.exp(-DT / LAG)
            self.ticks += 1
        return self.beliefs[start:]


def is_right(belief: Belief, efficiency: float, stuck: float) -> bool:
    """To a tenth of the force, which telemetry leaves open, or to the noise of a window."""
    if np.isnan(stuck):
        return bool(np.isnan(belief.stuck)) and abs(belief.efficiency - efficiency) <= 0.1
    return abs(belief.stuck - stuck) <= 0.05 * abs(stuck) + 1.0


GAINS = [np.full(M, 0.9), np.full(M, 1.1), np.linspace(0.9, 1.1, M)]


@pytest.mark.flight
@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize("gain", GAINS)
def test_a_healthy_thruster_is_left_alone(gain, noise):
    bench = Bench(3, gain, noise)
    assert bench.run(20.0, Health.whole(M)) == []
    assert bench.probes == 0


@pytest.mark.flight
@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize("seed", range(4))
def test_every_fault_is_found_and_none_beside(seed, noise):
    """A dead, a weak and a stuck thruster among five whole ones: what is believed is right, and is so at once."""
    draw = np.random.default_rng(seed)
    dead, weak, stuck = draw.permutation(M)[:3].tolist()
    health = Health.whole(M).with_thruster(dead, 0.0).with_thruster(weak, draw.uniform(0.25, 0.65))
    health = health.with_thruster(stuck, 0.0, draw.choice([-1.0, 1.0]) * draw.uniform(4.0, 30.0))
    bench = Bench(100 + seed, GAINS[seed % 3], noise)
    assert bench.run(10.0, Health.whole(M)) == []
    beliefs = bench.run(12.0, health)
    assert {b.thruster for b in beliefs} == {dead, weak, stuck}
    for b in beliefs:
        assert is_right(b, health.efficiency[b.thruster], health.stuck[b.thruster]), b
    assert max(min(b.time for b in beliefs if b.thruster == i) for i in (dead, weak, stuck)) < 10.0 + 6.0
    bench.run(15.0, Health.whole(M))
    assert bench.diagnosis.health.equals(Health.whole(M))


def test_the_gain_is_learned_so_that_beliefs_are_in_newtons_given():
    gain = np.full(M, 1.1)
    bench = Bench(5, gain, 0.0)
    bench.run(6.0, Health.whole(M))
    (belief,) = bench.run(2.0, Health.whole(M).with_thruster(2, 0.0, 20.0))
    assert belief.stuck == pytest.approx(20.0, abs=0.05)
    assert belief.time <= 6.0 + 0.6


def test_what_lies_beyond_the_tolerance_is_no_gain():
    """A thruster that gives 30 % less from the start is weak, not read low."""
    gain = np.ones(M)
    bench = Bench(6, gain, 0.0)
    (belief,) = bench.run(5.0, Health.whole(M).with_thruster(1, 0.7))
    assert belief[1:3] == (1, pytest.approx(0.7, abs=0.1))


def test_gains_are_known_the_better_the_more_force_was_seen():
    random, true = np.random.default_rng(8), np.array([0.93, 1.0, 1.08])
    gains = TelemetryGain(3, 0.1, 5.0)
    widths = []
    for _ in range(2000):
        x = random.uniform(-10.0, 10.0, 3)
        learn_gains(gains.gains, x, true * x + random.normal(size=3), np.array([True, True, True]), 1.0)
        assert (gains.gains.least <= true).all()
        assert (true <= gains.gains.most).all()
        widths.append(float((gains.gains.most - gains.gains.least).max()))
    np.testing.assert_allclose(gains.gains.gain, true, atol=0.01)
    assert widths[-1] < 0.05 < widths[0]
    before = gains.gains.gain.copy()
    learn_gains(
        gains.gains, np.full(3, 30.0), np.zeros(3), np.zeros(3, dtype=bool), 1.0
    )  # of a thruster that is not whole
    np.testing.assert_array_equal(gains.gains.gain, before)
