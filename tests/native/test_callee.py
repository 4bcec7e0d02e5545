"""What is called by its address is called with the arguments it is for, or not compiled."""

from __future__ import annotations

import numpy as np
import pytest
from numba.core.errors import TypingError

from cube_sim.native.callee import Callee, call_at
from cube_sim.native.compiled import compiled


@compiled
def last_of(matrix):
    return matrix[matrix.shape[0] - 1, 0]


LAST = Callee(last_of, lambda: (np.zeros((1, 1)),), answers=np.float64)


@compiled
def last_at(address, matrix):
    return call_at(LAST, address, (matrix,))


@compiled
def last_of_two(address, matrix):
    return call_at(LAST, address, (matrix, matrix))


def test_it_answers_what_it_answers_when_called():
    matrix = np.arange(12.0).reshape(4, 3)
    assert last_at(LAST.address(), matrix) == 9.0


@pytest.mark.parametrize(
    ("given", "named"),
    [
        (np.zeros((4, 6))[:, ::2], r"array\(float64, 2d, A\), not array\(float64, 2d, C\)"),
        (np.zeros((4, 3)).T, r"array\(float64, 2d, F\), not array\(float64, 2d, C\)"),
        (np.zeros((4, 3), np.int64), r"array\(int64, 2d, C\), not array\(float64, 2d, C\)"),
    ],
    ids=["rows apart", "column by column", "integers"],
)
def test_other_arguments_are_refused_with_both_types(given, named):
    with pytest.raises(TypingError, match=f"last_of is called .* argument 1 is {named}"):
        last_at(LAST.address(), given)


def test_more_arguments_are_refused():
    with pytest.raises(TypingError, match="there are 2 arguments, not 1"):
        last_of_two(LAST.address(), np.zeros((1, 1)))
