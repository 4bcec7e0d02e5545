"""Paths of every kind, drawn for a hull that flies at some speed and turns within some radius."""

from __future__ import annotations

from typing import Any

import numpy as np

Block = dict[str, Any]

PATHS = ("line", "point", "arc", "circle", "helix", "sinusoid", "polyline", "spline", "csv")
CENTRE_M = (0.0, 0.0, -20.0)
"""Where paths start or stand, deep enough for all of them to stay under water."""


def drawn_path(
    rng: np.random.Generator, kind: str, length_m: float, radius_m: float, slope_rad: float
) -> tuple[Block, np.ndarray, float, str]:
    """A path of a kind.

    Args:
        rng: consumed.
        kind: one of `PATHS`.
        length_m: the least it must be long.
        radius_m: the tightest it may bend.
        slope_rad: the steepest it may rise or sink; 0 for a level one.

    Returns:
        The block of the scenario, (3,) where it starts [m], its heading there [rad], and the text of path.csv, if any.
    """
    centre, heading = np.array(CENTRE_M), float(rng.uniform(-np.pi, np.pi))
    slope = float(rng.uniform(-slope_rad, slope_rad))
    if kind == "point":
        return (
            {"type": "point", "position_m": _list(centre), "heading_deg": float(np.degrees(heading))},
            centre,
            0.0,
            "",
        )
    if kind == "line":
        end = centre + length_m * _direction(heading, slope)
        return {"type": "line", "start_m": _list(centre), "end_m": _list(end)}, centre, heading, ""
    if kind == "arc":
        return (*_arc(rng, centre, heading, length_m, radius_m, slope), "")
    if kind == "circle":
        return (*_circle(rng, centre, radius_m, slope_rad), "")
    if kind == "helix":
        return (*_helix(rng, centre, length_m, radius_m, slope), "")
    if kind == "sinusoid":
        return (*_sinusoid(rng, centre, heading, length_m, radius_m), "")
    points = _walk(rng, centre, heading, length_m, radius_m, slope_rad, corners=kind == "polyline")
    if kind == "polyline":
        block = {"type": "polyline", "points_m": [_list(p) for p in points], "corner_radius_m": radius_m}
    elif kind == "spline":
        block = {"type": "spline", "points_m": [_list(p) for p in points]}
    else:
        block = {"type": "csv", "file": "path.csv"}
        rows = "\n".join(",".join(f"{x:.6f}" for x in p) for p in points)
        return block, centre, heading, f"x_m,y_m,z_m\n{rows}\n"
    return block, centre, heading, ""


def _arc(rng, centre, heading, length, radius, slope) -> tuple[Block, np.ndarray, float]:
    """Up to half a circle, in a plane that rises ahead."""
    angle = float(rng.uniform(0.3, 0.95)) * min(np.pi, length / radius)
    r, side = length / angle, float(rng.choice([-1.0, 1.0]))
    turns = np.array([0.0, 0.5, 1.0]) * angle
    ahead, across = r * np.sin(turns), side * r * (1.0 - np.cos(turns))
    level = np.array([-np.sin(heading), np.cos(heading), 0.0])
    points = centre + np.outer(ahead, _direction(heading, slope)) + np.outer(across, level)
    names = ("start_m", "through_m", "end_m")
    return {"type": "arc", **{k: _list(p) for k, p in zip(names, points, strict=True)}}, points[0], heading


def _circle(rng, centre, radius, slope_rad) -> tuple[Block, np.ndarray, float]:
    r, start, left = radius * float(rng.uniform(1.0, 3.0)), float(rng.uniform(-180.0, 180.0)), rng.random() < 0.5
    about, tilt = rng.uniform(-np.pi, np.pi), rng.uniform(0.0, slope_rad)
    axis = np.array([np.sin(tilt) * np.cos(about), np.sin(tilt) * np.sin(about), np.cos(tilt)])
    e1 = np.array([1.0, 0.0, 0.0]) - axis[0] * axis
    e1 /= np.linalg.norm(e1)
    e2, a = np.cross(axis, e1), np.radians(start)
    place = centre + r * (np.cos(a) * e1 + np.sin(a) * e2)
    ahead = (1.0 if left else -1.0) * (np.cos(a) * e2 - np.sin(a) * e1)
    block = {
        "type": "circle",
        "centre_m": _list(centre),
        "radius_m": r,
        "axis": _list(axis),
        "start_angle_deg": start,
        "direction": "left" if left else "right",
    }
    return block, place, float(np.arctan2(ahead[1], ahead[0]))


def _helix(rng, centre, length, radius, slope) -> tuple[Block, np.ndarray, float]:
    r, start, left = radius * float(rng.uniform(1.0, 2.5)), float(rng.uniform(-180.0, 180.0)), rng.random() < 0.5
    pitch = 2.0 * np.pi * r * np.tan(slope)
    block = {
        "type": "helix",
        "centre_m": _list(centre),
        "radius_m": r,
        "pitch_m": float(pitch),
        "turns": float(length / np.hypot(2.0 * np.pi * r, pitch)),
        "start_angle_deg": start,
        "direction": "left" if left else "right",
    }
    a = np.radians(start)
    place = centre + r * np.array([np.cos(a), np.sin(a), 0.0])
    return block, place, float(a + (0.5 * np.pi if left else -0.5 * np.pi))


def _sinusoid(rng, centre, heading, length, radius) -> tuple[Block, np.ndarray, float]:
    wave = float(rng.uniform(5.0, 10.0)) * radius
    amplitude = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.4, 1.0)) * min(
        wave**2 / (4.0 * np.pi**2 * radius), 0.25 * wave
    )
    block = {
        "type": "sinusoid",
        "start_m": _list(centre),
        "heading_deg": float(np.degrees(heading)),
        "amplitude_m": amplitude,
        "wavelength_m": wave,
        "periods": max(length / wave, 0.5),
    }
    return block, centre, heading + float(np.arctan2(2.0 * np.pi * amplitude, wave))


def _walk(rng, start, heading, length, radius, slope_rad, *, corners: bool) -> list[np.ndarray]:
    """Legs of at least four radii, turning by up to 80 degrees at corners and 45 degrees in a smooth curve."""
    points, walked, most = [start], 0.0, np.radians(80.0 if corners else 45.0)
    while walked < length or len(points) < 4:
        leg = radius * float(rng.uniform(4.0, 7.0))
        points.append(points[-1] + leg * _direction(heading, float(rng.uniform(-slope_rad, slope_rad))))
        heading += float(rng.uniform(-most, most))
        walked += leg
    return points


def _direction(heading: float, slope: float) -> np.ndarray:
    return np.array([np.cos(slope) * np.cos(heading), np.cos(slope) * np.sin(heading), np.sin(slope)])


def _list(values: np.ndarray) -> list[float]:
    return [float(x) for x in values]
