"""Colours on white, told apart also by readers who do not see red and green apart (Okabe and Ito)."""

from __future__ import annotations

BLUE, VERMILION, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#b0487f"
ORANGE, SKY, BROWN, BLACK = "#c98a00", "#3a9bd9", "#7a5230", "#222222"
SERIES = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BROWN, BLACK)
_LINES = ("-", "-.")
MOST_CURVES = len(SERIES) * len(_LINES)
"""So many curves in a frame are told apart, by their colours and lines."""

FAINT = "#8a929b"
LOOKED_AT = "#edf3f9"
EVERY_SECOND = "#f4f4f1"
GOOD, BAD, UNKNOWN = "#1a7f37", "#c4231c", "#9a6700"
OF_VERDICT = {"PASS": GOOD, "FAIL": BAD}


def of_index(index: int) -> str:
    """The colour of the curve of this number; they repeat after eight."""
    return SERIES[index % len(SERIES)]


def dash_of_index(index: int) -> str:
    """The line of the curve of this number, in matplotlib's words: another one where the colours begin again."""
    return _LINES[index // len(SERIES) % len(_LINES)]


def of_verdict(verdict: str) -> str:
    """Green, red, or amber for all that is neither."""
    return OF_VERDICT.get(verdict, UNKNOWN)
