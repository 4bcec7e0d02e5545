"""What a mission is asked: the checks that judge it."""

from __future__ import annotations

from typing import Any

LIMIT_M = 0.05
"""Largest error RMS after convergence, of the true state."""

SIGMAS = 3.0
"""The same on the navigation estimate, in standard deviations of its own position; `LIMIT_M` at least."""

LEAST_ADVANCE = 0.5
"""Share of the speed asked for by which the target advances at least: a vehicle that stands still has no error."""


def checks(scenario: dict[str, Any], from_s: float, planar: bool, limit_m: float = LIMIT_M) -> list[dict[str, Any]]:
    """What is judged from a moment on [s], and over all of it.

    A vehicle for the plane is judged in its plane. It has no thrust up or down, and a hull that floats a degree off
    level, or is tilted by its thrusters, leaves its depth by centimetres a second whatever the law. The analysis, too,
    is asked about the plane, of a vehicle that is kept at its depth by other means. Its paths are level, so that the
    first normal of their frame is.
    """
    point = scenario["path"]["type"] == "point"
    error: dict[str, Any] = {"signal": "path_error.cross_track"}
    if point:
        error = {"signal": "pose.position", "minus": "target.position"}
        error |= {"combine": "horizontal"} if planar else {}
    elif planar:
        error = {"signal": "path_error.lateral", "component": 0}
    rms = {**error, "statistic": "rms", "from_s": from_s}
    asked: list[dict[str, Any]] = [{"kind": "signal", "name": "error RMS", **rms, "at_most": limit_m}]
    if "navigation" in scenario:
        sigma = {"signal": "navigation.position_sigma", "statistic": "rms", "from_s": from_s}
        own = {"numerator": rms, "denominator": sigma, "least_denominator": LIMIT_M / SIGMAS}
        asked = [{"kind": "ratio", "name": "error RMS in its own sigmas", **own, "at_most": SIGMAS}]
    if not point:
        least = LEAST_ADVANCE * scenario["guidance"]["speed_m_s"]
        asked.append({"kind": "progress", "from_s": from_s, "at_least_m_s": least})
    return [*asked, {"kind": "false_alarms"}]
