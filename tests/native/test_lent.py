"""Arguments are lent to compiled functions: nothing is freed too early, nothing never, and little is translated."""

import re
import sys
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from cube_sim.native.compiled import compiled
from cube_sim.native.lent import LendingCompiler

pytestmark = pytest.mark.flight


class Inner(NamedTuple):
    first: Any
    second: Any
    factor: float


class Outer(NamedTuple):
    inner: Inner
    third: Any
    pair: tuple[Any, Any]


def numbers(start=0.0):
    return np.arange(start, start + 1000.0)


def outer(start=0.0):
    return Outer(Inner(numbers(start), numbers(1.0), 2.0), numbers(2.0), (numbers(3.0), numbers(4.0)))


@compiled
def piece(parts, at):
    return parts.inner.first[at:]


@compiled
def kept_after_its_owner(n):
    found = np.zeros(1)
    for k in range(n):
        view = piece(Outer(Inner(np.full(1000, 7.0), np.zeros(1), 1.0), np.zeros(1), (np.zeros(1), np.zeros(1))), k)
        np.full(1000, 3.0)[0] = 1.0  # would lie where the first lay, were it freed
        found = view
    return found


@compiled
def either(parts, other, second):
    chosen = parts
    if second:
        chosen = other
    inner = chosen.inner
    return inner.first[0] * inner.factor


@compiled
def early(parts, n):
    inner, pair = parts.inner, parts.pair
    for k in range(n):
        if inner.first[k] > 3.0:
            return inner.second
        if pair[1][k] > 100.0:
            return parts.third
    last = pair[0]
    return last


@compiled
def replaced(array, n):
    for _ in range(n):
        array = array + 1.0
    return array


def test_a_piece_of_what_is_lent_outlives_whoever_held_it():
    assert kept_after_its_owner(5).sum() == 7.0 * 996
    view = piece(outer(10.0), 4)
    other = numbers(-1000.0)  # takes the place of what is freed
    assert (view[0], other[0]) == (14.0, -1000.0)


def test_what_is_returned_is_the_array_itself_and_counted_like_any_other():
    parts = outer()
    assert early(parts, 10) is not None
    before = [array.copy() for array in (parts.inner.second, parts.pair[0])]
    results = [early(parts, n) for n in (10, 3)]
    assert np.shares_memory(results[0], parts.inner.second)
    assert np.shares_memory(results[1], parts.pair[0])
    del parts
    for result, was in zip(results, before, strict=True):
        assert np.array_equal(result, was)


def test_names_for_one_of_two_and_names_given_again_are_what_they_are_in_python():
    first, second = outer(1.0), outer(5.0)
    for which in (False, True):
        assert either(first, second, which) == either.py_func(first, second, which)
    array = numbers()
    assert np.array_equal(replaced(array, 3), replaced.py_func(array, 3))
    assert np.shares_memory(replaced(array, 0), array)
    assert array[1] == 1.0


def test_nothing_is_left_behind():
    parts = outer()

    def call():
        early(parts, 10), early(parts, 3), either(parts, parts, True), piece(parts, 1), kept_after_its_owner(3)
        replaced(parts.third, 2), replaced(parts.third, 0)

    call()
    _nrt_python.memsys_enable_stats()
    held = sys.getrefcount(parts.inner.second), sys.getrefcount(parts.third)
    before = rtsys.get_allocation_stats()
    for _ in range(20):
        call()
    after = rtsys.get_allocation_stats()
    _nrt_python.memsys_disable_stats()
    assert (sys.getrefcount(parts.inner.second), sys.getrefcount(parts.third)) == held
    assert after.alloc - before.alloc == after.free - before.free > 0


def test_less_is_counted_than_by_numba():
    counted = []
    for function in (numba.njit(early.py_func, pipeline_class=LendingCompiler), numba.njit(early.py_func)):
        assert np.array_equal(function(outer(), 3), numbers(3.0))
        [code] = function.inspect_llvm().values()
        counted.append(len(re.findall(r"call void @NRT_(?:de|in)cref", code)))
    assert counted[0] < counted[1]
