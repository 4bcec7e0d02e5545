"""Bounds of a pass rate: those of Clopper and Pearson, and what they show."""

from __future__ import annotations

import pytest
from scipy.stats import binom, binomtest

from cube_sim.campaign.pass_rate import interval, judged, least_count, lower_bound, upper_bound
from cube_sim.scenario.samples_block import RequiredBlock

COUNTS = [(0, 1), (1, 1), (0, 20), (20, 20), (19, 20), (57, 60), (953, 1000), (1, 1000)]


@pytest.mark.parametrize(("passed", "count"), COUNTS)
def test_the_interval_is_scipys_exact_one(passed, count):
    exact = binomtest(passed, count).proportion_ci(0.95, method="exact")
    assert interval(passed, count)[:2] == (pytest.approx(exact.low), pytest.approx(exact.high))


@pytest.mark.parametrize(("passed", "count"), COUNTS)
@pytest.mark.parametrize("confidence", [0.9, 0.99])
def test_a_bound_is_the_rate_at_which_so_many_are_as_unlikely(passed, count, confidence):
    if passed > 0:
        low = lower_bound(passed, count, confidence)
        assert binom.sf(passed - 1, count, low) == pytest.approx(1.0 - confidence)
    if passed < count:
        high = upper_bound(passed, count, confidence)
        assert binom.cdf(passed, count, high) == pytest.approx(1.0 - confidence)


@pytest.mark.parametrize(
    ("rate", "failed", "count"), [(0.95, 0, 59), (0.99, 0, 299), (0.95, 1, 93), (0.9, 0, 29), (0.999, 0, 2995)]
)
def test_so_many_samples_show_a_rate(rate, failed, count):
    assert least_count(rate, 0.95, failed) == count
    assert lower_bound(count - failed, count, 0.95) >= rate > lower_bound(count - 1 - failed, count - 1, 0.95)


@pytest.mark.parametrize(
    ("counts", "required", "verdict", "said"),
    [
        ((59, 0, 0), 0.95, "PASS", "59 of 59 samples pass: a pass rate above 0.9505 at 0.95 confidence"),
        ((58, 0, 0), 0.95, "ERROR", "too few to show 0.95; 59 samples with no more that fail would"),
        ((58, 0, 1), 0.95, "ERROR", "too few to show 0.95; 93 samples with no more that fail would"),
        ((80, 20, 0), 0.95, "FAIL", "a pass rate below 0.8633 at 0.95 confidence, 0.95 wanted"),
        ((10, 0, 0), None, "PASS", "10 of 10 samples pass, all of them wanted"),
        ((9, 0, 1), None, "ERROR", "9 of 10"),
        ((8, 1, 1), None, "FAIL", "8 of 10"),
        ((0, 0, 0), None, "ERROR", "no sample is flown"),
    ],
)
def test_what_samples_show(counts, required, verdict, said):
    block = None if required is None else RequiredBlock(pass_rate=required)
    result = judged(*counts, block)
    assert result.verdict == verdict
    assert said in result.detail
