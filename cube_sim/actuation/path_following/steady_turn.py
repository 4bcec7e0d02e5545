"""Steady turns: how tightly a vehicle turns while its attitude keeps to its course.

On a level circle of radius r at speed U the velocity turns at U / r. In body axes velocity and angular rate stand
still, and so does the wrench that keeps them: drag, Munk and righting moments, and what hull and added mass ask for to
turn. As on a straight course there is a trim where the thrusters can make it. Where components are missing, that trim
moves as the turn gets tighter, and may come to an end: in a tighter turn what they lack is balanced in no attitude near
it. So the trims of a straight course are followed into ever tighter turns, to either side.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cube_sim.actuation.attainable.attainable_set import AttainableSet
from cube_sim.actuation.path_following.trim import CourseAttitudes, TrimCondition
from cube_sim.spatial import cross, skew
from cube_sim.wrench.axes import Matrix, Vector

WIDEST_M, TIGHTEST_M = 50.0, 0.5
"""Radii between which turns are looked at (choices)."""
TIGHTER = 2.0**-0.5
"""Ratio of a radius to the one before (a choice)."""
SAME_TRIM_RAD = 0.5
"""A trim that is farther than this from that of the turn before is another one: the vehicle would have to jump."""
HEADINGS = 8
"""Angles of the nose from the course at which the search for trims of the straight course begins."""
APART_RAD = 0.2
"""Trims that are nearer to each other are one."""
HELD = 1.0 - 1e-9


@dataclass(frozen=True)
class TurningTrim:
    """A trim of a level straight course, and which turns it goes on into.

    Attributes:
        attitude: (3,3) on the straight course, body axes in those of the course: x ahead, z up.
        radius_m: of the tightest turns to both sides in which it is still there, within the limits; infinite where
            there are none.
    """

    attitude: Matrix
    radius_m: float

    @property
    def heading_rad(self) -> float:
        """Angle of the nose from the course, to the left."""
        return float(np.arctan2(self.attitude[1, 0], self.attitude[0, 0]))


def turning_trim(
    straight: CourseAttitudes,
    attainable: AttainableSet | None,
    known: TrimCondition | None = None,
    radius_m: float = TIGHTEST_M,
    nose_ahead: bool = False,
) -> TurningTrim | None:
    """The first trim that goes on into turns as tight as asked; where none does, that of the tightest turns.

    They are looked for from level attitudes, the nose ahead first, and from a known one at last.

    Args:
        straight: attitudes on the level straight course.
        attainable: the wrenches the thrusters attain; without them limits are not looked at.
        known: a trim of that course.
        radius_m: of the turns asked for; `TIGHTEST_M` at least.
        nose_ahead: whether no other attitude counts, as of a hull that its fins steer.

    Returns:
        None where a level course has no trim within the limits.
    """
    starts = _level(2.0 * np.pi * np.arange(1 if nose_ahead else HEADINGS) / HEADINGS)
    if known is not None:
        ahead = known.velocity / np.linalg.norm(known.velocity)
        starts = np.concatenate([starts, np.array([[ahead, cross(known.up, ahead), known.up]])])
    best: TurningTrim | None = None
    seen = np.empty((0, 3, 3))
    for start in starts:
        R, in_trim = straight.trimmed(start[None])
        if not in_trim[0] or np.any(_angles(seen, R[0]) < APART_RAD) or not _within(straight, R, attainable)[0]:
            continue
        seen = np.concatenate([seen, R])
        radius = tightest_turn(straight, attainable, R[0], max(radius_m, TIGHTEST_M))
        if best is None or radius < best.radius_m:
            best = TurningTrim(R[0], radius)
        if radius <= max(radius_m, TIGHTEST_M):
            break
    return best


def tightest_turn(straight: CourseAttitudes, attainable: AttainableSet | None, R: Matrix, radius_m: float) -> float:
    """The radius [m] of the tightest turns to both sides that a trim R (3,3) goes on into, down to the one asked for.

    Args:
        straight: attitudes on the straight course.
        attainable: the wrenches the thrusters attain; without them limits are not looked at.
        R: in trim there.
        radius_m: tighter turns are not looked at.
    """
    return max(_tightest(straight, attainable, R, side, radius_m) for side in (1.0, -1.0))


def _tightest(
    straight: CourseAttitudes, attainable: AttainableSet | None, R: Matrix, side: float, radius_m: float
) -> float:
    """The same to one side, 1 to the left and -1 to the right."""
    speed, kept, radius = float(np.linalg.norm(straight.velocity)), np.inf, max(WIDEST_M, radius_m)
    while kept > radius_m:
        turning = replace(straight, turning_rad_s=side * speed / radius)
        found, in_trim = turning.trimmed(R[None])
        if not in_trim[0] or _angles(found, R)[0] > SAME_TRIM_RAD or not _within(turning, found, attainable)[0]:
            break
        R, kept, radius = found[0], radius, max(TIGHTER * radius, radius_m)
    return kept


def _within(attitudes: CourseAttitudes, R: Matrix, attainable: AttainableSet | None) -> NDArray[np.bool_]:
    """Whether the thrusters attain the wrenches of attitudes (q,3,3), (q,)."""
    if attainable is None:
        return np.ones(len(R), dtype=bool)
    return attainable.share(attitudes.wrenches(R)) >= HELD


def _level(about_z: Vector) -> Matrix:
    """(q,3,3) level attitudes with the nose at these angles to the left of the course [rad]."""
    c, s, S = np.cos(about_z), np.sin(about_z), skew(np.array([0.0, 0.0, 1.0]))
    return np.eye(3) + s[:, None, None] * S + (1.0 - c)[:, None, None] * (S @ S)


def _angles(R: Matrix, other: Matrix) -> Vector:
    """(q,) angles of the rotations from attitudes (q,3,3) to another (3,3) [rad]."""
    return np.arccos(np.clip(0.5 * (np.einsum("qij,ij->q", R, other) - 1.0), -1.0, 1.0))
