"""Colours on white, told apart also by readers who do not see red and green apart (Okabe and Ito)."""

from __future__ import annotations

BLUE, VERMILION, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#b0487f"
ORANGE, SKY, BROWN, BLACK = "#c98a00", "#3a9bd9", "#7a5230", "#222222"
SERIES = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BROWN, BLACK)

FAINT = "#8a929b"
GOOD, BAD, UNKNOWN = "#1a7f37", "#c4231c", "#9a6700"
OF_VERDICT = {"PASS": GOOD, "FAIL": BAD}


def of_index(index: int) -> str:
    """The colour of the curve of this number; they repeat after eight."""
    return SERIES[index % len(SERIES)]


def of_verdict(verdict: str) -> str:
    """Green, red, or amber for all that is neither."""
    return OF_VERDICT.get(verdict, UNKNOWN)
