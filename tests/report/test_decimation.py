"""What is drawn of a curve has its peaks, its ends and its gaps."""

from __future__ import annotations

import numpy as np
import pytest

from cube_sim.report.decimation import decimated, held, stepped

RNG = np.random.default_rng(5)


@pytest.mark.parametrize("n", [1, 2, 7, 1000, 50_000])
@pytest.mark.parametrize("tolerance", [0.0, 0.5])
def test_every_column_keeps_its_extremes(n, tolerance):
    places = np.sort(RNG.uniform(0, 200, n))
    values = np.cumsum(RNG.normal(size=n))
    values[n // 2] += 1e3
    (chosen,) = decimated(places, values, 200, tolerance)
    assert np.all(np.diff(chosen) > 0)
    assert {0, n - 1, int(np.argmax(values)), int(np.argmin(values))} <= set(chosen.tolist())
    assert len(chosen) <= 4 * 200 + 4
    for column in np.unique(np.floor(places)):
        whole, drawn = values[np.floor(places) == column], values[chosen][np.floor(places[chosen]) == column]
        assert drawn.max() == whole.max()
        assert drawn.min() <= whole.min() + tolerance


def test_one_sample_that_stands_out_of_a_million_is_drawn():
    values = np.zeros(1_000_000)
    values[654_321] = -3.0
    (chosen,) = decimated(np.linspace(0, 1000, len(values)), values, 1000)
    assert 654_321 in chosen


def test_what_is_no_number_is_a_gap():
    values = np.array([1.0, 2.0, np.nan, 3.0, np.inf, -np.inf, 4.0, 5.0])
    stretches = [part.tolist() for part in decimated(np.arange(8.0), values, 8)]
    assert stretches == [[0, 1], [3], [6, 7]]
    assert list(decimated(np.arange(3.0), np.full(3, np.nan), 3)) == []


def test_what_lies_outside_the_axis_is_left_out():
    (chosen,) = decimated(np.array([-1.0, 0.0, 5.0, 10.0, 11.0]), np.arange(5.0), 10)
    assert chosen.tolist() == [1, 2, 3]


def test_a_row_holds_until_the_next():
    rows = np.array([[1.0, 10.0], [3.0, 30.0]])
    assert held(rows, np.array([0.5, 1.0, 2.9, 3.0, 9.0]))[:, 0].tolist()[1:] == [10.0, 10.0, 30.0, 30.0]
    assert np.isnan(held(rows, np.array([0.5]))[0, 0])
    times, values = stepped(rows[:, 0], rows[:, 1], 9.0)
    assert (times.tolist(), values.tolist()) == ([1.0, 3.0, 3.0, 9.0], [10.0, 10.0, 30.0, 30.0])
