"""What differs between two runs: bits, times, numbers that are none; within tolerances nothing."""

from __future__ import annotations

import numpy as np
import pytest

from cube_sim.recording.header import RecordedCode, RunHeader
from cube_sim.runs.comparison import InputDifference, differences, other_files, other_settings

T = np.arange(5.0)


def rows(*columns):
    return np.column_stack([T, *columns])


BASE = {"a.x": rows(T), "a.y": rows(T**2, -T), "b.z": rows(np.full(5, np.nan))}


def changed(signal, row, column, value):
    other = {name: table.copy() for name, table in BASE.items()}
    other[signal][row, column] = value
    return other


def test_the_same_signals_do_not_differ():
    assert list(differences(BASE, {name: table.copy() for name, table in BASE.items()})) == []


def test_the_last_bit_counts_and_is_found_where_it_is():
    (found,) = differences(BASE, changed("a.y", 3, 2, np.nextafter(-3.0, 0.0)))
    assert (found.signal, found.first_s, found.largest_s, found.rows) == ("a.y", 3.0, 3.0, 1)
    assert 0.0 < found.largest < 1e-15


def test_a_tolerance_is_what_may_be_reached():
    other = changed("a.x", 2, 1, 2.5)
    assert list(differences(BASE, other, {"a.x": 0.5, "a.y": 0.0, "b.z": 0.0}.__getitem__)) == []
    (found,) = differences(BASE, other, lambda _: 0.499)
    assert found.largest == 0.5


@pytest.mark.parametrize("value", [0.0, np.inf])
def test_no_number_against_a_number_differs_beyond_any_tolerance(value):
    (found,) = differences(BASE, changed("b.z", 1, 1, value), lambda _: 1e9)
    assert (found.largest, found.first_s) == (np.inf, 1.0)


def test_infinite_alike_is_the_same():
    one, other = changed("a.x", 2, 1, np.inf), changed("a.x", 2, 1, np.inf)
    assert list(differences(one, other)) == []
    (found,) = differences(one, changed("a.x", 2, 1, -np.inf))
    assert found.largest == np.inf


def test_what_one_run_has_alone_and_other_times_are_told():
    other = {"a.x": BASE["a.x"][:3], "a.y": BASE["a.y"][:, :2], "c.new": BASE["a.x"]}
    found = {each.signal: each for each in differences(BASE, other)}
    assert list(found) == ["a.x", "a.y", "b.z", "c.new"]
    assert found["a.x"].text == "5 rows against 3, of which 3 at the same times"
    assert found["a.x"].first_s is None
    assert found["a.y"].text == "2 numbers a row against 1"
    assert (found["b.z"].text, found["c.new"].text) == ("only in the first", "only in the second")


def test_where_times_differ_common_ones_are_compared():
    other = changed("a.x", 3, 1, 7.0)
    other["a.x"] = other["a.x"][1:]
    (found,) = differences(BASE, other)
    assert "4 at the same times" in found.text
    assert (found.first_s, found.largest) == (3.0, 4.0)


def test_settings_that_differ_are_named_by_their_dotted_key():
    one = {"seed": 1, "path": {"points_m": [[0, 0], [1, 2]], "type": "line"}, "battery": None, "events": []}
    other = {"seed": 1, "path": {"points_m": [[0, 0], [1, 3]], "type": "line"}, "events": [{"at_s": 2}], "new": True}
    assert other_settings(one, one) == []
    assert other_settings(one, other) == [
        InputDifference("path.points_m.1.1", "2", "3"),
        InputDifference("battery", "null", ""),
        InputDifference("events.0", "", '{"at_s": 2}'),
        InputDifference("new", "", "true"),
    ]


def test_files_that_differ_are_named_by_their_digests():
    one = RunHeader("", "", "model/a.xml", {"model/a.xml": b"a", "model/b.obj": b"b"})
    other = RunHeader("", "", "model/a.xml", {"model/a.xml": b"c"}, (RecordedCode("control.law", "own.py:law", "x"),))
    assert other_files(one, one) == []
    found = {each.key: (each.one[:4], each.other[:4]) for each in other_files(one, other)}
    # of a shell: printf a | sha256sum
    assert found == {"model/a.xml": ("ca97", "2e7d"), "model/b.obj": ("3e23", ""), "control.law/own.py": ("", "2d71")}
