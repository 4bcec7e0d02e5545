"""From which speed on a vehicle's fins steer it, told where it was judged at one at which they do not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from cube_sim.commands.analysis_report import Report

TRIED_M_S = (0.5, 1.0, 1.5, 2.0, 3.0)
"""Speeds looked at, slowest first (a choice)."""


def with_steering_speed(report: Report, judged_at: Callable[[float], Report]) -> Report:
    """The same report; where fins steer at another speed only, its verdict says at which.

    Args:
        report: at the default speed.
        judged_at: the same at another speed [m/s].
    """
    verdict = report.analysis.verdict
    if report.fins is None or verdict.follows:
        return report
    steers = next((speed for speed in TRIED_M_S if judged_at(speed).analysis.verdict.follows), None)
    if steers is None:
        tried = ", ".join(f"{speed:g}" for speed in TRIED_M_S)
        told = f"nor do its fins steer it at {tried} m/s (--speed)"
    else:
        told = f"its fins steer it at {steers:g} m/s: give --speed {steers:g}"
    told = replace(verdict, reason=f"{verdict.reason}; {told}")
    return replace(report, analysis=replace(report.analysis, verdict=told))
