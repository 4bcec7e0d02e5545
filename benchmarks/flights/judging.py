"""What a flight is worth, and what seems to have gone wrong with it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

LIMIT_M = 0.05
"""Largest cross-track RMS after convergence, of the true state."""

SIGMAS = 3.0
"""The same on the navigation estimate, in standard deviations of its own position; `LIMIT_M` at least."""

LEAST_ADVANCE = 0.5
"""Share of the speed asked for by which the target advances at least: a vehicle that stands still has no error."""

DOUBT_S = 6.0
"""How long a thruster that has recovered may still be doubted."""

LAP_M = 1.0
"""A target that moves farther in one tick has begun another lap."""

Signals = Mapping[str, np.ndarray]


def judged(signals: Signals, scenario: Mapping[str, Any], from_s: float, planar: bool = False) -> dict[str, Any]:
    """Figures of a flight, whether it passes, and a cause when it does not.

    A vehicle for the plane is judged in its plane. It has no thrust up or down, and a hull that floats a degree off
    level, or is tilted by its thrusters, leaves its depth by centimetres a second whatever the law. The analysis, too,
    is asked about the plane, of a vehicle that is kept at its depth by other means. How far it leaves it is a figure of
    its own, `depth_m`.

    Args:
        signals: "channel.field" -> rows, column 0 the time [s].
        scenario: the mission's.
        from_s: start of the window [s].
        planar: whether the vehicle is one for the plane at its depth.
    """
    end_s = float(signals["pose.position"][-1, 0])
    period = scenario.get("control_period_s", 0.02)
    complete = end_s >= scenario["duration_s"] - 1.5 * period
    point = scenario["path"]["type"] == "point"
    error = np.abs(_level_error(signals) if planar else signals["path_error.cross_track"][:, 1:])
    if point:
        error = np.hypot(error, signals["path_error.along"][:, 1:])
    t, error = signals["path_error.cross_track"][:, 0], error[:, 0]
    late = t >= from_s
    figures: dict[str, Any] = {"end_s": end_s, "worst_m": float(error.max()), "limit_m": LIMIT_M}
    figures["false_alarms"] = false_alarms(signals, scenario)
    if not late.any():
        return figures | {"rms_m": None, "passes": False, "cause": f"ended early, at {end_s:.0f} s"}
    late_error = error[late]
    figures["rms_m"] = float(np.sqrt(np.mean(late_error**2)))
    figures["worst_late_m"] = float(late_error.max())
    figures["final_m"] = float(error[-1])
    if "navigation.position_sigma" in signals:
        sigma = signals["navigation.position_sigma"]
        own = np.sqrt(np.mean(np.sum(sigma[sigma[:, 0] >= from_s, 1:] ** 2, axis=1)))
        figures["limit_m"] = max(LIMIT_M, SIGMAS * float(own))
    if planar:
        figures["depth_m"] = float(np.ptp(signals["pose.position"][:, 3]))
    figures["advance"] = 1.0 if point else _advance(signals, scenario, from_s)
    figures["authority"] = [int(code) for code in np.unique(signals["health.authority"][late, 1])]
    status = signals["allocation.status"][late, 1]
    figures["not_exact"] = float(np.mean((status != 0) & (status != 8)))
    figures["attitude_rad"] = float(np.sqrt(np.mean(signals["path_error.attitude"][late, 1] ** 2)))
    figures["highest_m"] = float(signals["pose.position"][:, 3].max())
    cause = _cause(figures, late_error, t[late], complete)
    return figures | {"passes": cause == "", "cause": cause}


def _level_error(signals: Signals) -> np.ndarray:
    """(n,1) the distance [m] across the path in the horizontal plane."""
    y1, z1 = signals["path_error.lateral"][:, 1:].T
    w, x, y, z = signals["target.quaternion"][:, 1:].T
    along_x = 2.0 * (x * y - w * z) * y1 + 2.0 * (x * z + w * y) * z1
    along_y = (1.0 - 2.0 * (x * x + z * z)) * y1 + 2.0 * (y * z - w * x) * z1
    return np.hypot(along_x, along_y)[:, None]


def false_alarms(signals: Signals, scenario: Mapping[str, Any]) -> int:
    """How many thrusters were doubted while they were whole."""
    t = signals["health.believed"][:, 0]
    believed, true = signals["health.believed"][:, 1:], signals["health.efficiency"][:, 1:]
    doubted = (believed < 1.0) & (true >= 1.0)
    for event in scenario.get("events", ()):
        if event.get("state") == "recovered":
            doubted[(t >= event["at_s"]) & (t <= event["at_s"] + DOUBT_S)] = False
    return int(np.sum(doubted.any(axis=0)))


def _advance(signals: Signals, scenario: Mapping[str, Any], from_s: float) -> float:
    """The target's progress in the window as a share of what was asked; 1 once it is at the end of the path."""
    rows, left = signals["target.arc_length"], signals["target.remaining"][-1, 1]
    late = rows[rows[:, 0] >= from_s]
    if left < 0.1 or len(late) < 2:
        return 1.0
    asked = scenario["guidance"]["speed_m_s"] * (late[-1, 0] - late[0, 0])
    steps = np.diff(late[:, 1])
    return float(steps[np.abs(steps) < LAP_M].sum() / asked)


def _cause(figures: Mapping[str, Any], error: np.ndarray, t: np.ndarray, complete: bool) -> str:
    """In one of a few words; empty for a flight that passes."""
    if not complete:
        return f"ended early, at {figures['end_s']:.0f} s"
    if figures["rms_m"] > figures["limit_m"]:
        if 3 in figures["authority"]:
            return "given up"
        if figures["worst_late_m"] > 5.0 and figures["final_m"] > 0.8 * figures["worst_late_m"]:
            return "runs away"
        half = len(error) // 2
        before, after = float(np.mean(error[:half])), float(np.mean(error[half:]))
        if figures["not_exact"] > 0.3:
            return "asks for more than there is"
        if after < 0.4 * before:
            return "slow to converge"
        return "standing error" if np.std(error) < 0.3 * np.mean(error) else "moves about the path"
    if figures["false_alarms"]:
        return "false alarm"
    if figures["advance"] < LEAST_ADVANCE:
        return "does not advance"
    return ""
