"""Paths as compiled laws read them: a record for closed forms and a table for the others.

A path that has `parts` is read inside compiled laws. One without, a user's own for instance, is asked by `at`.
"""

from __future__ import annotations

from math import cos, floor, sin, sqrt

import numpy as np

from cube_sim.guidance.bisection import count_up_to
from cube_sim.guidance.path import Path
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Record, Vector
from cube_sim.tuples import cross_tuples

ROUND, HELIX, TABLE = 0, 1, 2
PATH = np.dtype(
    [
        ("kind", np.int64),
        ("closed", np.bool_),
        ("length", np.float64),
        ("holonomy", np.float64),
        ("first", np.float64),
        ("last", np.float64),
        ("angle_per_metre", np.float64),
        ("constant", np.float64, (3, 4)),
        ("cosine", np.float64, (3, 4)),
        ("sine", np.float64, (3, 4)),
        ("straight", np.float64, 3),
        ("curvature", np.float64, 2),
        ("centre", np.float64, 3),
        ("helix", np.float64, 6),
    ]
)
"""A path. ROUND: [p, T, N1, N2] = constant + cosine cos(a) + sine sin(a), a = angle_per_metre x, and p + straight x
besides; x is the arc length held between first and last. HELIX: the numbers of `helix_point` after its centre. TABLE:
see `cube_sim.guidance.tabulated`; the angle holonomy is added with every lap."""
Parts = tuple[Record, Vector, Matrix, Matrix, Matrix]
"""Record, and the table: edges, position, angle, frame."""
NO_TABLE = np.zeros(2), np.zeros((1, 1, 3)), np.zeros((1, 1)), np.zeros((1, 3, 3))


@compiled
def look_up(edges, position, angle, frame, s, cos_lap, sin_lap):
    """The path at s: (16,) = p, R_WF row by row, k1, k2, dk1/ds, dk2/ds.

    With c = T0.T the smallest rotation from T0 to T takes a normal n of T0 to n - (T.n)/(1 + c) (T0 + T). Along the
    curve that frame spins about T at -T0.(T x T')/(1 + c), which the tabulated angle takes back.

    Args:
        edges: as in `Cells`, like the next three.
        position: see there.
        angle: see there.
        frame: see there.
        s: arc length [m]; beyond an end it is taken as the end.
        cos_lap: of the angle by which both normals are turned about T because of laps already run.
        sin_lap: of the same.
    """
    out = np.empty(16)
    s = min(max(s, edges[0]), edges[-1])
    i = min(max(count_up_to(edges, s) - 1, 0), len(edges) - 2)
    half = 0.5 * (edges[i + 1] - edges[i])
    x = (s - edges[i]) / half - 1.0
    T, dT, ddT = np.zeros(3), np.zeros(3), np.zeros(3)
    for axis in range(3):
        p0, p1, p2, p3 = 0.0, 0.0, 0.0, 0.0
        for power in range(position.shape[1] - 1, -1, -1):
            p3 = p3 * x + p2
            p2 = p2 * x + p1
            p1 = p1 * x + p0
            p0 = p0 * x + position[i, power, axis]
        out[axis] = p0
        T[axis], dT[axis], ddT[axis] = p1 / half, 2.0 * p2 / half**2, 6.0 * p3 / half**3
    T /= np.sqrt(T[0] ** 2 + T[1] ** 2 + T[2] ** 2)
    theta = 0.0
    for power in range(angle.shape[1] - 1, -1, -1):
        theta = theta * x + angle[i, power]

    first = frame[i]
    c = first[0, 0] * T[0] + first[1, 0] * T[1] + first[2, 0] * T[2]
    along_1 = (first[0, 1] * T[0] + first[1, 1] * T[1] + first[2, 1] * T[2]) / (1.0 + c)
    along_2 = (first[0, 2] * T[0] + first[1, 2] * T[1] + first[2, 2] * T[2]) / (1.0 + c)
    turn_c = np.cos(theta) * cos_lap - np.sin(theta) * sin_lap
    turn_s = np.sin(theta) * cos_lap + np.cos(theta) * sin_lap
    out[12:] = 0.0
    for axis in range(3):
        U1 = first[axis, 1] - along_1 * (first[axis, 0] + T[axis])
        U2 = first[axis, 2] - along_2 * (first[axis, 0] + T[axis])
        N1, N2 = turn_c * U1 + turn_s * U2, turn_c * U2 - turn_s * U1
        out[3 + 3 * axis], out[4 + 3 * axis], out[5 + 3 * axis] = T[axis], N1, N2
        out[12] += dT[axis] * N1
        out[13] += dT[axis] * N2
        # (T'.N)' = T''.N, as N' is along T and T' square to it
        out[14] += ddT[axis] * N1
        out[15] += ddT[axis] * N2
    return out


@compiled
def helix_point(centre, radius, rise, sense, start_angle, kappa, tau, along):
    """The helix at one arc length, a row (16,).

    Args:
        centre: (3,) [m].
        radius: R [m].
        rise: b [m].
        sense: 1 to the left, -1 to the right.
        start_angle: [rad].
        kappa: curvature [1/m].
        tau: torsion [1/m].
        along: arc length [m].
    """
    metre_per_radian = sqrt(radius * radius + rise * rise)
    turned = along / metre_per_radian
    angle = start_angle + sense * turned
    c, s = cos(angle), sin(angle)
    across, up = sense * radius / metre_per_radian, rise / metre_per_radian
    T, normal = (-across * s, across * c, up), (-c, -s, 0.0)
    binormal = cross_tuples(T, normal)
    back = tau * along
    cb, sb = cos(back), sin(back)
    row = np.empty(16)
    row[0], row[1], row[2] = centre[0] + radius * c, centre[1] + radius * s, centre[2] + rise * turned
    for i in range(3):
        row[3 + 3 * i] = T[i]
        row[4 + 3 * i] = cb * normal[i] - sb * binormal[i]
        row[5 + 3 * i] = sb * normal[i] + cb * binormal[i]
    row[12], row[13], row[14], row[15] = kappa * cb, kappa * sb, -kappa * tau * sb, kappa * tau * cb
    return row


@compiled
def path_row(path, edges, position, angle, frame, s):
    """The path at arc length s [m], a row (16,): p, R_WF row by row, k1, k2, dk1/ds, dk2/ds.

    Args:
        path: record `PATH`.
        edges: of the table, like the next three.
        position: of it.
        angle: of it.
        frame: of it.
        s: see `Path.at`.
    """
    p = path[0]
    if p.kind == TABLE:
        turned = 0.0
        if p.closed:
            lap = floor(s / p.length)
            s, turned = s - lap * p.length, lap * p.holonomy
        return look_up(edges, position, angle, frame, s, cos(turned), sin(turned))
    if p.kind == HELIX:
        h = p.helix
        return helix_point(p.centre, h[0], h[1], h[2], h[3], h[4], h[5], min(max(s, p.first), p.last))
    x = min(max(s, p.first), p.last)
    c, sn = cos(p.angle_per_metre * x), sin(p.angle_per_metre * x)
    row = np.zeros(16)
    for i in range(3):
        row[i] = p.constant[i, 0] + c * p.cosine[i, 0] + sn * p.sine[i, 0] + x * p.straight[i]
        for j in range(3):
            row[3 + 3 * i + j] = p.constant[i, 1 + j] + c * p.cosine[i, 1 + j] + sn * p.sine[i, 1 + j]
    row[12], row[13] = p.curvature[0], p.curvature[1]
    return row


def path_numbers(path: Path, s: float) -> Vector:
    """`path_row` of any path."""
    parts: Parts | None = getattr(path, "parts", None)
    if parts is not None:
        return path_row(*parts, s)
    point = path.at(s)
    return np.concatenate([point.position, np.ravel(point.rotation), point.curvature, point.curvature_rate])
