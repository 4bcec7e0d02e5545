"""Counting what lies below a number."""

import numpy as np
import pytest

from cube_sim.guidance.bisection import count_up_to


@pytest.mark.parametrize("size", [0, 1, 2, 7, 64])
def test_it_is_the_search_of_numpy_at_between_and_beyond_the_edges(size):
    edges = np.sort(np.round(np.random.default_rng(size).normal(size=size), 1))  # some of them are equal
    for x in [*edges, *(edges + 0.05), -np.inf, -9.0, 9.0, np.inf, np.nan]:
        assert count_up_to(edges, x) == np.searchsorted(edges, x, side="right")
