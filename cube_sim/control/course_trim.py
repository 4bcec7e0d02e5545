"""The attitude for a straight course where the one a mission wishes is not held by the water, or steers badly.

A vehicle that points its thrust takes an attitude in which its steady wrench has nothing of what its thrusters lack.
There may be many of them, and not all are alike. In some the Munk moment outgrows the righting one, and the hull leaves
them about an axis that is left to the water. In some the force that is needed hardly changes as the hull turns, so that
a small disturbance asks for a large turn. To go to the nearest to the wish by steps ends in whichever comes first; so
they are looked for from all attitudes, in the axes of the course.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.actuation.path_following.steady_turn import tightest_turn
from cube_sim.actuation.path_following.trim import CourseAttitudes
from cube_sim.control.authority import Authority, Capability
from cube_sim.control.pointing_zero import zero_time
from cube_sim.control.roomiest_attitude import spread_attitudes
from cube_sim.spatial import Matrix, Vector, skew
from cube_sim.vehicle.dynamics import Dynamics

EVERY = 3
"""Of the attitudes spread over all there are, one in so many is a start of the search (a choice)."""
ENOUGH = 1.3
"""Share of the steady wrench that the thrusters attain in a trim that is chosen (a choice). One that is kept may have
less: from what they are short of the search for balance turns away by itself."""
FIRM, HARDLY_FIRM = 0.25, 0.0
"""Share of the righting moment by which a small tilt about an axis left to the water is turned back: in a trim that is
chosen, in one that is kept (choices)."""
SHARP, BLUNT = 2.5, 4.0
"""The turn by which a disturbance is pointed against [rad], per share of the steady force, likewise: 1 for a ball."""
SLOWER = 2.0
"""A force that waits for the attitude is asked for by a velocity loop this many times slower than the attitude's."""
CAUGHT = 0.8
"""By how much a slip that grows by itself may grow in the time of the velocity loop, as a logarithm (a choice): below 1
that loop catches it, see `qualities`."""
BEGINS_AT, BEGINS_IN = 0.125, 12
"""Share of its speed from which a hull has to come to a trim as it speeds up, and in how many steps it is followed."""
GOES_ALONG_RAD = 0.5
"""How far its trim may turn meanwhile (a choice)."""
JUDGED_RAD = 1.2
"""A trim that is farther than this from the wish says little about where the search for balance will end (a choice)."""
FREE_RAD_S = 1e-3
"""A motion that is slower is none: the hull is free to turn so."""
ROUNDING = 1e-8
"""How much of a wrench counts as none, per newton of the largest that comes up."""


def seeks_trim(left: Capability) -> bool:
    """Whether its attitude points the thrust, in all axes; with a thruster stuck its trims are not known."""
    return left.authority in (Authority.PLANE, Authority.LINE) and not bool(np.any(left.held))


@dataclass(frozen=True)
class CourseTrims:
    """Trims of a vehicle on a course, and how good they are.

    Attributes:
        left: what the thrusters can still do; it points their thrust, and none is stuck.
        attitudes: those on the course.
        torques: which of the directions that yield are torques, (k,).
        righting: size of the righting moment [N m].
        time: of the loop that points the thrust [s]; 0 where any trim is steered slowly enough.
    """

    left: Capability
    attitudes: CourseAttitudes
    torques: NDArray[np.bool_]
    righting: float
    time: float = 0.0

    @staticmethod
    def of(
        left: Capability, hull: Dynamics, speed_m_s: float, inclination_rad: float, time_s: float = 0.0
    ) -> CourseTrims | None:
        """On a course at this speed through the water and angle above the horizontal; None where no trim is sought."""
        if not seeks_trim(left) or not speed_m_s > 0.0:
            return None
        velocity = speed_m_s * np.array([np.cos(inclination_rad), 0.0, np.sin(inclination_rad)])
        righting = float(np.linalg.norm(hull.righting_moment))
        level = float(np.linalg.norm(hull.steady_wrenches(velocity[None], np.eye(3)[2:])))
        rounding = ROUNDING * max(1.0, level, righting)
        lost = np.ascontiguousarray(left.lost.T)
        attitudes = CourseAttitudes(hull, velocity, tuple(range(6)), np.eye(3), lost, rounding)
        torques = np.linalg.norm(left.yielding[3:], axis=0) > 0.0
        return CourseTrims(left, attitudes, torques, righting, time_s if np.any(left.dragged_force) else 0.0)

    def nearest(self, wish: Matrix, before: Matrix | None = None, radius_m: float = inf) -> Matrix | None:
        """The trim (3,3) to wish for instead; None where the one next to the wish will do, and where there is none.

        One that is hastened, steered faster than it allows, is left for one that is not, where there is such.
        Where no trim is near a wish along the course, the search for balance ends in any of them. Then one is wished
        for if the path turns: not all go on into its turns. A wish across the course is another one as the path turns.
        With one line of force there is hardly a choice.

        Args:
            wish: the attitude (3,3) the mission asks for, body axes in those of the course.
            before: the trim wished for until now, in those of its course; it is kept as long as it will do.
            radius_m: of the tightest turn of the path; infinite where it has none.
        """
        R, found, far = self.next_to(wish)
        hastened = False
        along = _near(np.eye(3), wish)
        searched = far and along and self.left.authority is Authority.PLANE
        turning = searched and np.isfinite(radius_m)
        if found[0] and self.good(R, kept=before is None and not turning)[0]:
            hastened = self.hastened(R[0])
            if not hastened and (not turning or self._turns(R[0], radius_m)):
                return None
        elif before is None and far and not turning and not (searched and found[0] and self.sways(R)[0]):
            return None
        if before is not None:
            R, found = self.attitudes.trimmed(before[None])
            if found[0] and self.good(R, kept=True)[0]:
                return R[0]
        R, found = self.attitudes.trimmed(spread_attitudes()[::EVERY])
        R = R[found]
        R = R[self.good(R)]
        for i in np.argsort(-np.einsum("kij,ij->k", R, wish), kind="stable"):
            if self._turns(R[i], radius_m) and not (hastened and self.hastened(R[i])):
                return R[i]
        return None

    def slowest_elsewhere_rad_s(self, wish: Matrix, radius_m: float) -> float | None:
        """How slowly it must be steered in the trim it takes for a path that turns; None where one is near the wish.

        See `nearest` for the arguments, `slowest_rad_s` for the answer.
        """
        _, _, far = self.next_to(wish)
        trim = self.nearest(wish, None, radius_m) if far else None
        return None if trim is None else self.slowest_rad_s(trim)

    def hastened(self, R: Matrix) -> bool:
        """Whether the loop that points the thrust is faster than the motion of a trim (3,3) with the place held."""
        return self.time > 0.0 and self.slowest_rad_s(R) * self.time < 1.0

    def is_sure(self, wish: Matrix) -> bool:
        """Whether the trim next to a wish (3,3) is near, good, not hastened, and come to from rest."""
        R, _, far = self.next_to(wish)
        return not far and bool(self.good(R)[0]) and not self.hastened(R[0]) and self.begins(R[0])

    def begins(self, R: Matrix) -> bool:
        """Whether a trim (3,3) is come to from slow motion, the hull turning little as it speeds up.

        One that the Munk moment balances against a torque that comes with a force is not there at rest.
        """
        at = R
        for share in np.geomspace(1.0, BEGINS_AT, BEGINS_IN + 1)[1:]:
            slower = replace(self.attitudes, velocity=share * self.attitudes.velocity)
            trimmed, found = slower.trimmed(at[None])
            if not found[0] or _apart(trimmed[0], R) > GOES_ALONG_RAD:
                return False
            at = trimmed[0]
        return True

    def slowest_rad_s(self, R: Matrix) -> float:
        """The slowest motion of the attitude about a trim (3,3) while the hull's place is held [rad/s], or infinity.

        With the place held, forces follow from the attitude, and the torques they bring along turn it: N' W = 0 is
        P theta'' + Q theta' + S theta = 0. These are the zeros from a pointed force to the place. The loop that points
        it has to be slower: what it does faster than that moves the hull by turning it, not by the force it points.
        """
        hull, lost = self.attitudes.hull, self.left.lost
        J = lost.T @ self.attitudes.slopes(R[None])[0]
        axes = np.linalg.svd(J)[2][: len(J)].T
        v = self.attitudes.velocity @ R
        turned = np.concatenate([np.zeros((3, axes.shape[1])), axes])
        slips = np.concatenate([skew(v) @ axes, np.zeros((3, axes.shape[1]))])
        slope = hull.steady_wrench_slope(np.pad(v, (0, 3)))
        P, Q, S = lost.T @ hull.total_mass @ turned, lost.T @ (hull.total_mass @ slips + slope @ turned), J @ axes
        k = len(P)
        motion = np.block([[np.zeros((k, k)), np.eye(k)], [-np.linalg.pinv(P) @ S, -np.linalg.pinv(P) @ Q]])
        rates = np.abs(np.linalg.eigvals(motion))
        return float(np.min(rates[rates > FREE_RAD_S], initial=np.inf))

    def next_to(self, wish: Matrix) -> tuple[Matrix, NDArray[np.bool_], bool]:
        """Where Newton's method leads from a wish, (1,3,3), whether that is a trim, and whether none is near."""
        R, found = self.attitudes.trimmed(wish[None])
        return R, found, not (found[0] and _near(wish, R[0]))

    def _turns(self, R: Matrix, radius_m: float) -> bool:
        """Whether a trim (3,3) goes on into turns of this radius to both sides; any does where the path is straight."""
        if np.isinf(radius_m):
            return True
        attainable = None if self.left.budget is None else self.left.budget.attainable
        return tightest_turn(self.attitudes, attainable, R, radius_m) <= radius_m

    def good(self, R: Matrix, kept: bool = False) -> NDArray[np.bool_]:
        """Whether attitudes (q,3,3) in trim are within the limits, held by the water and steered well, (q,)."""
        share, stiffness, turn, decay = self.qualities(R)
        if kept:
            return ~self.sways(R) & (decay * self.velocity_times(R) > -CAUGHT)
        return (share >= ENOUGH) & (stiffness > FIRM * self.righting) & (turn <= SHARP) & (decay > 0.0)

    def sways(self, R: Matrix) -> NDArray[np.bool_]:
        """Whether in attitudes (q,3,3) in trim the water does not hold it, or a little force asks for a large turn."""
        _, stiffness, turn, _ = self.qualities(R)
        return (stiffness <= HARDLY_FIRM * self.righting) | (turn > BLUNT)

    def velocity_times(self, R: Matrix) -> Vector:
        """How slow the velocity loop is in attitudes (q,3,3) in trim, (q,) [s]."""
        motions = ((each.T @ self.attitudes.velocity, each[2]) for each in R)
        zeros = [zero_time(self.left, self.attitudes.hull, *motion) for motion in motions]
        return np.maximum(np.array(zeros), SLOWER * self.time)

    def qualities(self, R: Matrix) -> tuple[Vector, Vector, Vector, Vector]:
        """Of attitudes (q,3,3) in trim, each (q,).

        The share that the thrusters attain; the stiffness about the axes left to the water [N m/rad]; the turn that
        points against a disturbance [rad]; and the rate at which a slip that is not pushed against decays while the
        thrusters hold the attitude, with the force that this torque brings along [1/s].
        """
        wrenches, slopes = self.attitudes.wrenches(R), self.attitudes.slopes(R)
        shares = np.full(len(R), np.inf)
        if self.left.budget is not None:
            used = wrenches @ self.left.budget.normals.T / np.maximum(self.left.budget.bounds, np.finfo(float).tiny)
            shares = 1.0 / np.maximum(np.max(used, axis=1, initial=0.0), np.finfo(float).tiny)
        lost, yielding = self.left.lost, self.left.yielding
        # What is missing, in terms of what yields: its size along each direction of length 1.
        missing = np.linalg.solve(lost.T @ yielding, lost.T) * np.linalg.norm(yielding, axis=0)[:, None]
        stiffness = np.full(len(R), np.inf)
        if np.any(self.torques):
            axes = yielding[3:, self.torques] / np.linalg.norm(yielding[3:, self.torques], axis=0)
            stiffness = np.min(np.linalg.eigvals(missing[self.torques] @ slopes @ axes).real, axis=1)
        turns, decays = np.zeros(len(R)), np.zeros(len(R))
        if not len(R):
            return shares, stiffness, turns, decays
        turning = np.linalg.pinv(lost.T @ slopes) @ lost[:3].T
        turns = np.linalg.norm(wrenches[:, :3], axis=1) * np.linalg.norm(turning, ord=2, axis=(1, 2))
        hull, pointed = self.attitudes.hull, ~self.torques
        slips, inertia = yielding[:3, pointed], missing[pointed] @ hull.total_mass[:, :3]
        nu = np.pad(self.attitudes.velocity @ R, ((0, 0), (0, 3)))
        damping = np.array([missing[pointed] @ hull.steady_wrench_slope(x)[:, :3] @ slips for x in nu])
        decays = np.min(np.linalg.eigvals(np.linalg.solve(inertia @ slips, damping)).real, axis=1)
        return shares, stiffness, turns, decays


def _near(R: Matrix, other: Matrix) -> bool:
    """Whether attitudes (3,3) differ by less than `JUDGED_RAD`."""
    return _apart(R, other) <= JUDGED_RAD


def _apart(R: Matrix, other: Matrix) -> float:
    """The angle between attitudes (3,3) [rad]."""
    return float(np.arccos(np.clip((np.trace(R.T @ other) - 1.0) / 2.0, -1.0, 1.0)))


class LevelMotion(NamedTuple):
    """The steady motion of a level course in the trim that is taken.

    Attributes:
        velocity: through the water (3,) [m/s], body axes.
        up: (3,) world up in body axes.
    """

    velocity: Vector
    up: Vector


def level_motion(
    left: Capability, hull: Dynamics, speed_m_s: float, time_s: float = 0.0, radius_m: float = inf
) -> LevelMotion | None:
    """The motion whose zeros say how slow the loops have to be; None where no trim is sought, or there is none.

    Args:
        left: what the thrusters can do.
        hull: the body.
        speed_m_s: of the course, through the water.
        time_s: of the loop that points the thrust, for the trim that is taken; see `CourseTrims`.
        radius_m: of the tightest turn of the path, for that trim, too; infinite where it has none.
    """
    trims = CourseTrims.of(left, hull, speed_m_s, 0.0, time_s)
    if trims is None:
        return None
    trim = trims.nearest(np.eye(3), radius_m=radius_m)
    R, found = trims.attitudes.trimmed((np.eye(3) if trim is None else trim)[None])
    return LevelMotion(R[0].T @ trims.attitudes.velocity, R[0, 2]) if found[0] else None
