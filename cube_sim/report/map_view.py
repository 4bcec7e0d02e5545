"""The run from above: path, track, where it began and ended, and where what happened."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cube_sim.report import colours
from cube_sim.report.decimation import Values, held
from cube_sim.report.drawing import flags, path_data
from cube_sim.report.markup import element, number, text
from cube_sim.report.panel import Mark
from cube_sim.report.scale import nice_step
from cube_sim.report.subject import Subject

_NOWHERE = np.empty((0, 4))
_WIDTH, _HEIGHT, _LEFT, _TOP, _BELOW = 532, 420, 58, 24, 34


def plan_view(subjects: Sequence[Subject], marks: Sequence[Mark]) -> str:
    """Draw x (east) to the right and y (north) up, one scale for both.

    Args:
        subjects: the runs.
        marks: what happened in the first of them, to stand on its track.
    """
    paths = [_path(subject) for subject in subjects]
    # A record that ends before its first row may have no columns either.
    tracks = [subject.rows("pose.position") if subject.has("pose.position") else _NOWHERE for subject in subjects]
    points = np.concatenate([*(path[:, :2] for path in paths), *(track[:, 1:3] for track in tracks)])
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return ""
    low, high = points.min(axis=0), points.max(axis=0)
    wide, tall = _WIDTH - _LEFT - 10, _HEIGHT - _TOP - _BELOW
    metres = float(max((high[0] - low[0]) / wide, (high[1] - low[1]) / tall, 1e-6)) * 1.08
    middle = (low + high) / 2

    def place(at: Values) -> Values:
        x = _LEFT + wide / 2 + (at[:, 0] - middle[0]) / metres
        return np.column_stack([x, _TOP + tall / 2 - (at[:, 1] - middle[1]) / metres])

    parts = ['<text class="h" x="58" y="13">Plan view: x east, y north [m]</text>', *_grid(middle, metres, wide, tall)]
    shown = paths[:1] if _same(paths) else paths
    parts += [_line(place(path[:, :2]), colours.FAINT, "c r") for path in shown if len(path)]
    alone = len(subjects) == 1
    for subject, track in zip(subjects, tracks, strict=True):
        if not len(track):
            continue
        colour = colours.BLUE if alone else subject.colour
        at = place(track[:, 1:3])
        parts.append(_line(at[_few(at)], colour, "c"))
        (x0, y0), (x1, y1) = at[0], at[-1]
        parts.append(f'<circle cx="{x0:.1f}" cy="{y0:.1f}" r="4.5" fill="#fff" stroke="{colour}" stroke-width="2"/>')
        parts.append(f'<rect x="{x1 - 4:.1f}" y="{y1 - 4:.1f}" width="8" height="8" fill="{colour}"/>')
    if len(tracks[0]):
        at = place(held(tracks[0], np.array([mark.t for mark in marks]))[:, :2])
        known = [(mark, (x, y)) for mark, (x, y) in zip(marks, at.tolist(), strict=True) if np.isfinite([x, y]).all()]
        for mark, (x, y) in known:
            parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{mark.colour}"/>')
        for (x, y), mark, flag in flags([mark for mark, _ in known], [where for _, where in known]):
            parts.append(f'<text class="q" x="{x:.1f}" y="{y - 8:.1f}" fill="{mark.colour}">{text(flag)}</text>')
    parts.append(f'<text class="l" x="{_LEFT}" y="{_HEIGHT - 4}">grey: path; circle: start; square: end</text>')
    return element(
        "svg", "".join(parts), viewBox=f"0 0 {_WIDTH} {_HEIGHT}", class_="plan", role="img", aria_label="Plan"
    )


def _path(subject: Subject) -> Values:
    rows = subject.rows("path.points")
    return rows[0, 1:].reshape(-1, 3) if len(rows) and (rows.shape[1] - 1) % 3 == 0 else np.empty((0, 3))


def _same(paths: Sequence[Values]) -> bool:
    return all(np.array_equal(path, paths[0]) for path in paths)


def _grid(middle: Values, metres: float, wide: float, tall: float) -> list[str]:
    parts = []
    step = nice_step(metres * 70)
    for axis, length in ((0, wide), (1, tall)):
        first = np.ceil((middle[axis] - metres * length / 2) / step)
        last = np.floor((middle[axis] + metres * length / 2) / step)
        for index in range(int(first), int(last) + 1):
            offset = (index * step - middle[axis]) / metres
            label = text(number(index * step, 6))
            if axis == 0:
                x = f"{_LEFT + wide / 2 + offset:.1f}"
                parts.append(f'<path class="g" d="M{x} {_TOP}V{_TOP + tall}"/>')
                parts.append(f'<text class="n" x="{x}" y="{_TOP + tall + 13}" text-anchor="middle">{label}</text>')
            else:
                y = _TOP + tall / 2 - offset
                parts.append(f'<path class="g" d="M{_LEFT} {y:.1f}H{_LEFT + wide}"/>')
                parts.append(f'<text class="n" x="{_LEFT - 5}" y="{y + 3.5:.1f}" text-anchor="end">{label}</text>')
    parts.append(f'<rect class="f" x="{_LEFT}" y="{_TOP}" width="{wide}" height="{tall}"/>')
    return parts


def _few(at: Values) -> list[int]:
    """Positions of points half a pixel apart at least, the last one among them."""
    moved = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(np.nan_to_num(at, posinf=0.0, neginf=0.0), axis=0).T))])
    chosen = np.unique(np.floor(moved / 0.5), return_index=True)[1]
    # A line is broken by a point that is none, and goes on from the next.
    none = np.flatnonzero(~np.isfinite(at).all(axis=1))
    ends = np.concatenate([none - 1, none, none + 1])
    return sorted({*chosen.tolist(), *ends[(ends >= 0) & (ends < len(at))].tolist(), len(at) - 1})


def _line(at: Values, colour: str, kind: str) -> str:
    sound = np.isfinite(at).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], sound, [False]]))).reshape(-1, 2)
    d = "".join(path_data(at[a:b, 0], at[a:b, 1]) for a, b in edges.tolist())
    return f'<g transform="scale(.1)"><path class="{kind}" d="{d}" stroke="{colour}"/></g>'
