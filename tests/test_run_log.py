"""A log told in few lines: what repeats is counted, what differs is told."""

from __future__ import annotations

from cube_sim.commands.account import log_lines
from cube_sim.run_log import ALIKE, LogLine, gathered


def warned(t, text, level="WARNING"):
    return LogLine(t, level, text)


def test_what_is_said_again_is_one_entry_with_count_and_last_time():
    lines = [warned(t, text) for t in (1.0, 2.0, 3.5) for text in ("lost", "found")]
    first, second = gathered(lines)
    assert (first.first, first.count, first.last_s) == (warned(1.0, "lost"), 3, 3.5)
    assert (second.first.text, second.count, second.last_s) == ("found", 3, 3.5)
    assert str(first) == "1.00 s  WARNING  lost (+2 more like this, the last at 3.50 s)"


def test_sentences_that_differ_in_their_numbers_are_told_a_few_times():
    lines = [warned(float(k), f"off by -{k}.5e-3 m") for k in range(50)]
    entries = gathered(lines)
    assert [entry.first for entry in entries] == lines[:ALIKE]
    assert [entry.count for entry in entries] == [*[1] * (ALIKE - 1), 50 - ALIKE + 1]
    assert entries[-1].last_s == 49.0


def test_one_sentence_among_many_with_other_numbers_counts_as_itself():
    texts = ["at 1 m", "at 2 m", "at 1 m", "at 3 m", "at 4 m", "at 2 m"]
    entries = gathered(warned(float(k), text) for k, text in enumerate(texts))
    assert [(entry.first.text, entry.count) for entry in entries] == [("at 1 m", 2), ("at 2 m", 2), ("at 3 m", 2)]


def test_a_number_in_a_name_and_the_level_tell_sentences_apart():
    lines = [warned(float(k), f"T{k}: dead") for k in range(9)]
    assert [entry.first for entry in gathered(lines)] == lines
    assert len(gathered([warned(0.0, "x"), warned(0.0, "x", "ERROR")])) == 2


def test_a_line_is_one_line_whatever_was_said():
    assert str(*gathered([warned(0.02, "one\n  two\n")])) == "0.02 s  WARNING  one two"


def test_too_many_sentences_are_cut_and_errors_are_not():
    names = [f"thruster {chr(97 + k // 26)}{chr(97 + k % 26)} is dead" for k in range(100)]
    log = (*(warned(float(k), name) for k, name in enumerate(names)), warned(99.0, "over", "ERROR"))
    lines = log_lines(log, most=5)
    assert lines[:5] == [f"{k}.00 s  WARNING  {names[k]}" for k in range(5)]
    assert lines[5:] == ["99.00 s  ERROR  over", "... and 95 more, in the recording's log"]
    assert log_lines(log[:5], most=5) == lines[:5]
    assert log_lines(()) == []
