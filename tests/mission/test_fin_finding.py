"""Faults of fins found by where they stand: against servos integrated apart, and never where there is none."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cube_sim.mission.fin_finding import FinFinding, servo_step
from cube_sim.vehicle.fin_health import FinHealth

LAG_S, RATE, TRAVEL, PERIOD_S = 0.1, 0.5, 0.35, 0.02


def fins(k=1, lag=LAG_S, rate=RATE, travel=TRAVEL):
    return SimpleNamespace(
        names=tuple(f"fin{i}" for i in range(k)),
        lag_s=np.full(k, lag),
        rate=np.full(k, rate),
        travel=np.tile([-travel, travel], (k, 1)),
    )


def wishes(rng, seconds, size=0.25):
    """A random wish of a controller: steps, slow waves and quick ones."""
    t = np.arange(0.0, seconds, PERIOD_S)
    steps = np.repeat(rng.uniform(-size, size, len(t) // 150 + 1), 150)[: len(t)]
    wave = rng.uniform(0.0, size) * np.sin(2 * np.pi * t / rng.uniform(0.4, 8.0))
    return np.clip(rng.choice([0.0, 1.0]) * steps + wave, -1.2 * TRAVEL, 1.2 * TRAVEL)


def looked(finding, wished, moves):
    """What is believed after every tick; `moves(stood, wish, tick)` is the fin."""
    stood, said = np.zeros(1), []
    for tick, wish in enumerate(wished):
        finding.look(tick)
        said.append(finding.found)
        low, high = np.clip([-TRAVEL, TRAVEL], *finding.found.travel[0])
        asked = np.clip([wish], low, high) if finding.found.steers[0] else stood.copy()
        finding.note(asked[None], stood[None])
        stood = moves(stood, asked, tick)
    return said


def healthy(lag=LAG_S, rate=RATE, low=-TRAVEL, high=TRAVEL):
    one = np.ones(1)
    return lambda stood, wish, _: servo_step(stood, np.clip(wish, low, high), lag * one, rate * one, PERIOD_S)


@pytest.mark.parametrize("seed", range(5))
def test_a_servo_goes_as_its_equation_integrated_apart(seed):
    rng = np.random.default_rng(seed)
    stood, target, lag, rate = (
        rng.uniform(-0.4, 0.4),
        rng.uniform(-0.4, 0.4),
        rng.uniform(0.05, 0.5),
        rng.uniform(0.1, 1),
    )
    for time in (0.02, 0.3, 2.0):
        solved = solve_ivp(lambda _, d: np.clip((target - d) / lag, -rate, rate), (0, time), [stood],
                           rtol=1e-10, atol=1e-12, max_step=0.01)  # fmt: skip
        told = servo_step(*np.array([[stood], [target], [lag], [rate]]), time)
        assert told[0] == pytest.approx(solved.y[0, -1], abs=1e-7)


@pytest.mark.parametrize("seed", range(60))
def test_a_whole_fin_is_never_doubted_whatever_its_numbers_are_believed_to_be(seed):
    """Lag and rate wrong by up to a factor of two, either way."""
    rng = np.random.default_rng(seed)
    lag, rate = LAG_S * 2.0 ** rng.uniform(-1, 1), RATE * 2.0 ** rng.uniform(-1, 1)
    said = looked(FinFinding(fins(lag=lag, rate=rate), PERIOD_S, FinHealth.whole(1)), wishes(rng, 60.0), healthy())
    assert said[-1] is said[0]
    assert not said[-1].codes.any()


@pytest.mark.parametrize("seed", range(20))
def test_a_jammed_fin_is_found_once_it_is_asked_to_both_sides(seed):
    rng, at_s = np.random.default_rng(seed), 10.0
    whole = healthy()
    finding = FinFinding(fins(), PERIOD_S, FinHealth.whole(1))
    wished = 0.2 * np.sin(2 * np.pi * np.arange(0.0, 40.0, PERIOD_S) / rng.uniform(2.0, 9.0))
    said = looked(finding, wished, lambda d, w, k: d if k * PERIOD_S >= at_s else whole(d, w, k))
    codes = np.array([each.codes[0] for each in said])
    assert not codes[: round(at_s / PERIOD_S)].any()
    assert codes[-1] >= 2.0
    assert np.flatnonzero(codes)[0] * PERIOD_S < at_s + 10.0
    if codes[-1] == 2.0:  # it jammed where it is hardly asked to go beyond: what it does is not known there
        end = said[-1].travel[0][np.isfinite(said[-1].travel[0])]
        assert abs(end).min() > 0.16


@pytest.mark.parametrize("seed", range(10))
def test_less_travel_is_found_at_either_end_and_is_no_jam(seed):
    rng = np.random.default_rng(seed)
    low, high = -rng.uniform(0.03, 0.1), rng.uniform(0.03, 0.1)
    finding = FinFinding(fins(), PERIOD_S, FinHealth.whole(1))
    wished = 0.3 * np.sign(np.sin(2 * np.pi * np.arange(0.0, 60.0, PERIOD_S) / 12.0))
    said = looked(finding, wished, healthy(low=low, high=high))
    assert said[-1].codes[0] == 2.0  # short
    assert said[-1].travel[0] == pytest.approx([low, high], abs=2e-3)


def test_a_fin_that_follows_the_flow_is_loose():
    rng = np.random.default_rng(3)
    flow = 0.03 * np.sin(2 * np.pi * np.arange(0.0, 40.0, PERIOD_S) / 3.0) + rng.normal(0, 1e-4, 2000)
    whole, finding = healthy(), FinFinding(fins(), PERIOD_S, FinHealth.whole(1))
    wished = np.where(np.arange(2000) < 500, 0.0, 0.2)
    said = looked(finding, wished, lambda d, w, k: flow[k : k + 1] if k >= 500 else whole(d, w, k))
    assert said[499].codes[0] == 0.0
    assert said[-1].codes[0] == 4.0


def test_a_fin_that_nobody_moves_is_left_in_peace():
    """Jammed where it is told to be: nothing is known of it, and nothing missed."""
    finding = FinFinding(fins(), PERIOD_S, FinHealth.whole(1))
    said = looked(finding, np.zeros(2000), lambda d, w, k: d)
    assert not said[-1].codes.any()
