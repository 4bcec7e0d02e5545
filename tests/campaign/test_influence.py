"""Rank correlation: scipy's, and blind to what it should be blind to."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import spearmanr

from cube_sim.campaign.influence import parameters_of, rank_correlation
from cube_sim.campaign.rows import joined, table_of
from cube_sim.campaign.sample_flight import FlownSample


@pytest.mark.parametrize("seed", range(5))
def test_it_is_spearmans(seed):
    rng = np.random.default_rng(seed)
    x = rng.integers(0, 10, 50).astype(float)  # with ties
    y = seed * x + rng.normal(0.0, 8.0, 50)
    wanted, found = spearmanr(x, y), rank_correlation(x, y)
    assert found.rho == pytest.approx(wanted.statistic)
    assert found.p == pytest.approx(wanted.pvalue)
    hidden = np.where(np.arange(50) < 5, np.nan, y)
    assert rank_correlation(x, hidden).rho == pytest.approx(spearmanr(x[5:], y[5:]).statistic)


def test_what_only_rises_is_one_and_what_never_changes_is_none():
    x = np.arange(10.0)
    assert rank_correlation(x, np.exp(x)) == (1.0, 0.0)
    assert rank_correlation(x, -(x**3)) == (-1.0, 0.0)
    assert np.isnan(rank_correlation(x, np.ones(10)).rho)
    errors = np.where(x < 2.0, -np.inf, x)  # what could not be judged is worse than all that failed
    assert rank_correlation(x, errors).rho == pytest.approx(spearmanr(x, [-1, -1, *x[2:]]).statistic)


def test_words_and_lost_thrusters_are_parameters_too():
    drawn = [
        {"guidance.speed_m_s": 0.1 * k, "control.faults": ["told", "ignored"][k % 2], "lost_thrusters": lost, "same": 1}
        for k, lost in enumerate(["", "T1", "T1+T3", "T3"])
    ]
    rows = [
        FlownSample({"sample": k, "verdict": "PASS", "reason": "", "seed": k, **d}, 0, 0) for k, d in enumerate(drawn)
    ]
    found = {each.name: each.values.tolist() for each in parameters_of(joined([table_of(rows)]), ["T1", "T2", "T3"])}
    assert found == {
        "control.faults = ignored": [0, 1, 0, 1],
        "control.faults = told": [1, 0, 1, 0],
        "guidance.speed_m_s": pytest.approx([0.0, 0.1, 0.2, 0.3]),
        "number of lost_thrusters": [0, 1, 2, 1],
        "lost_thrusters: T1": [0, 1, 1, 0],
        "lost_thrusters: T3": [0, 0, 1, 1],
    }


def test_of_a_vector_the_length_is_a_parameter_too():
    """A current from any side speaks by its strength alone, which none of its parts tells."""
    rng = np.random.default_rng(4)
    angle, length = rng.uniform(0.0, 2.0 * np.pi, 200), rng.uniform(0.0, 0.8, 200)
    rows = [
        {
            "sample": k,
            "verdict": "PASS",
            "current_m_s.0": float(size * np.cos(turned)),
            "current_m_s.1": float(size * np.sin(turned)),
            "speed": 1.0 + k,
        }
        for k, (turned, size) in enumerate(zip(angle.tolist(), length.tolist(), strict=True))
    ]
    found = {each.name: each for each in parameters_of(table_of([FlownSample(row, 0.1, 0.1) for row in rows]))}
    assert list(found) == ["current_m_s.0", "current_m_s.1", "speed", "length of current_m_s"]
    assert rank_correlation(found["length of current_m_s"].values, -(length**2)).rho == pytest.approx(-1.0)
    assert abs(rank_correlation(found["current_m_s.0"].values, -(length**2)).rho) < 0.2
