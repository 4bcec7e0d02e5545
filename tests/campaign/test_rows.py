"""Rows as tables: a type for each column, whatever comes when, and one order."""

from __future__ import annotations

import pyarrow as pa

from cube_sim.campaign.rows import joined, table_of, times_alone, without_times
from cube_sim.campaign.sample_flight import FlownSample


def flown(k, **more):
    row = {"sample": k, "verdict": "PASS", "reason": "", "seed": 2**62 + k, **more}
    return FlownSample(row, 0.1 * k, 0.2 * k)


def test_parts_join_in_the_order_of_the_samples_whoever_was_faster():
    rows = [flown(k, **{"guidance.speed_m_s": 0.1 * k, "check.b.value": 1.0, "check.a.value": 2.0}) for k in range(6)]
    ways = ([rows[:2], rows[2:]], [[rows[5], rows[0]], [rows[3]], [rows[1], rows[2], rows[4]]], [rows[::-1]])
    tables = [joined(map(table_of, parts), checks=["b", "a"]) for parts in ways]
    assert tables[0].column_names == [
        "sample", "verdict", "reason", "seed", "guidance.speed_m_s", "check.b.value", "check.a.value", "flight_s",
        "wall_s",
    ]  # fmt: skip
    assert tables[0]["sample"].to_pylist() == list(range(6))
    assert tables[0].equals(tables[1])
    assert tables[0].equals(tables[2])


def test_a_sample_that_was_written_twice_is_one():
    table = joined([table_of([flown(3), flown(1)]), table_of([flown(1), flown(2)])])
    assert table["sample"].to_pylist() == [1, 2, 3]


def test_a_column_has_one_type_whatever_comes_first():
    parts = [[flown(0, x=1, word="a", odd=None)], [flown(1, x=0.5, word=None, odd=2)], [flown(2, odd="b", late=True)]]
    for order in (parts, parts[::-1]):
        table = joined(map(table_of, order))
        assert table["x"].to_pylist() == [1.0, 0.5, None]
        assert table["word"].to_pylist() == ["a", None, None]
        assert table["odd"].to_pylist() == [None, "2", "b"]
        assert table["late"].to_pylist() == [None, None, True]
        assert table.schema.field("seed").type == pa.int64()
    assert table["seed"].to_pylist() == [2**62, 2**62 + 1, 2**62 + 2]


def test_the_clock_is_kept_apart():
    table = joined([table_of([flown(1, x=0.5)])])
    assert "wall_s" not in without_times(table).column_names
    assert times_alone(table).to_pylist() == [{"sample": 1, "flight_s": 0.1, "wall_s": 0.2}]


def test_no_rows_are_a_table_too():
    assert joined([]).num_rows == 0
    assert without_times(joined([])).column_names[:2] == ["sample", "verdict"]
