"""What was missing of the demanded wrenches in a stretch of ticks: how much, where to, and why."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from cube_sim.allocation import Status
from cube_sim.flight.rows import TickRows
from cube_sim.spatial import Matrix, Vector, rotation_from_quaternion
from cube_sim.vehicle.floating import Buoyancy
from cube_sim.wrench.axes import SPATIAL

FORWARD_PORT_UP = (("forward", "backward"), ("to port", "to starboard"), ("up", "down"))
"""Words for forces along and against the body's axes."""
TURNS = ("of roll", "of pitch", "of yaw")
WORTH_TELLING = 0.3
"""Components are told that miss at least this share of what the worst one misses (a choice)."""
AT_LIMIT = 0.98
"""A thruster at this share of its largest force counts as one at its limit: the optimum keeps off it by rounding."""
MOSTLY = 0.5
"""A stretch of which less is missed is said to be so for that share of it (a choice)."""
WORTH_A_WORD = 0.01
"""Share of a hull that is out of the water from which on that is told (a choice)."""
OUT_OF_RANGE = 1e-3
"""A missing wrench of which the thrusters make less than this share, in whatever direction, is none of theirs."""


class Thrust(NamedTuple):
    """What the words need to know of the thrusters.

    Attributes:
        names: (m,).
        A: (6,m).
        limits: (m,4) of whole ones [F_max-, F_DZ-, F_DZ+, F_max+] [N].
        length_m: their rms lever arm, which makes torques and forces comparable.
        fins: names of the k fins that servos turn.
        per_newton: (6,k) wrench of a newton of each at the speed of the mission [1, m].
        travel: (k,2) least and largest deflection [rad].
        afloat: the hull at the surface; None in endless water.
    """

    names: Sequence[str]
    A: Matrix
    limits: Matrix
    length_m: float
    fins: Sequence[str] = ()
    per_newton: Matrix = np.zeros((6, 0))
    travel: Matrix = np.zeros((0, 2))
    afloat: Afloat | None = None


class Afloat(NamedTuple):
    """A hull at the surface.

    Attributes:
        buoyancy: how the water carries it.
        surface: its height [m], world axes.
    """

    buoyancy: Buoyancy
    surface: float

    def out_of_water(self, height: float, quaternion: Vector) -> str:
        """Words for the lift that is missing where a part of the hull is out of the water; "" where none is.

        Args:
            height: of its origin [m], world axes.
            quaternion: its attitude (4,).
        """
        there = self.surface - height, rotation_from_quaternion(quaternion)[2]
        share, missing = self.buoyancy.share(*there), self.buoyancy.weight - self.buoyancy.carried(*there)
        if share > 1.0 - WORTH_A_WORD or missing <= 0.0:
            return ""
        out = _number(100.0 - 100.0 * share)
        return f"{_number(missing)} N of lift missing because the hull is {out} % out of the water"


class Shortfall:
    """A stretch of ticks whose demands were not made.

    Attributes:
        since_s: time of the first [s].
        until_s: time of the last so far [s].
        status: of the worst.
        believed: (m,) the efficiencies that are believed in it.
        off_m: how much further the vehicle was from its target than at the beginning, at most [m].
    """

    def __init__(self, since_s: float, distance_m: float, believed: Vector) -> None:
        self.believed = believed
        self.since_s = self.until_s = since_s
        self.status, self.off_m = Status.EXACT, 0.0
        self._distance, self._residual, self._at = distance_m, -1.0, since_s
        self._demanded, self._missing = np.zeros(6), np.zeros(6)
        self._seen = self._missed = self._spanned = 0
        self._force, self._share, self._wanted = np.zeros(0), np.zeros(0), np.zeros(0)
        self._height, self._quaternion = 0.0, np.array([1.0, 0.0, 0.0, 0.0])

    def take(self, t: float, rows: TickRows, k: int, status: Status, force_ratio: float) -> None:
        """Take in a tick whose demand was not made.

        Args:
            t: its time [s].
            rows: of the flight.
            k: which of them.
            status: of its allocation.
            force_ratio: share of their force that the supply leaves the thrusters.
        """
        self.until_s = t
        self._missed, self._spanned = self._missed + 1, self._seen
        residual = float(rows.allocation[k, 1])
        if residual > self._residual:
            m = len(self.believed)
            self._residual, self._at, self.status = residual, t, status
            self._demanded = rows.wrench[k, 1:7].copy()
            self._missing = self._demanded - rows.wrench[k, 7:13]
            self._force = rows.thrusters[k, 1 : 1 + m].copy()
            self._share = believed_efficiency(rows, k) * force_ratio
            self._wanted = rows.fins[k, 1:].copy()
            self._height, self._quaternion = float(rows.pose[k, 3]), rows.pose[k, 4:8].copy()

    def go_on(self, times: Sequence[float], rows: TickRows, start: int, end: int, force_ratio: Vector) -> None:
        """Take in and watch many ticks at once, whose demands were not made, with what is believed in the stretch.

        Args:
            times: of all rows [s].
            rows: of the flight.
            start: the first of them.
            end: behind the last.
            force_ratio: of `take`, of all rows.
        """
        seen, missed = self._seen + end - start, self._missed + end - start
        residuals = rows.allocation[start:end, 1]
        worse = np.where(residuals > self._residual, residuals, -np.inf)
        k = start + int(np.argmax(worse))
        if worse[k - start] > self._residual:
            self.take(times[k], rows, k, Status(int(rows.allocation[k, 3])), float(force_ratio[k]))
        self.until_s = times[end - 1]
        self.watch(float(np.fmax.reduce(distance_from_target(rows, slice(start, end)))))
        self._seen, self._missed, self._spanned = seen, missed, seen

    def watch(self, distance_m: float) -> None:
        """Take in how far from its target the vehicle is, at any tick of the stretch and a little after [m]."""
        self._seen += 1
        self.off_m = max(self.off_m, distance_m - self._distance)

    @property
    def when(self) -> str:
        """From when to when, and for how much of that where it is not most of it."""
        share = self._missed / max(self._spanned, 1)
        part = "" if share > MOSTLY else f"for {_number(max(100.0 * share, 1.0))} % of the time "
        return f"{part}from {self.since_s:.2f} s to {self.until_s:.2f} s"

    def told(self, thrust: Thrust) -> str:
        """How much was missing when most was, and why.

        E.g. ``at worst, at 1.20 s, 4.1 of 52 N forward missing: T1 and T3 at their limits``.
        """
        scaled = SPATIAL.scale(thrust.length_m) * self._missing
        worth = np.flatnonzero(np.abs(scaled) >= WORTH_TELLING * np.max(np.abs(scaled), initial=0.0))
        parts = [self._component(i) for i in worth.tolist() if scaled[i] != 0.0]
        cause = self._cause(thrust, scaled)
        out = "" if thrust.afloat is None else thrust.afloat.out_of_water(self._height, self._quaternion)
        why = "; ".join(filter(None, (cause, out)))
        return f"at worst, at {self._at:.2f} s, {', '.join(parts)}{f': {why}' if why else ''}"

    def _component(self, i: int) -> str:
        asked, missing = float(self._demanded[i]), float(self._missing[i])
        unit, more = (
            "N" if i < 3 else "N m",
            asked * missing <= 0.0,
        )  # more is made, or something where nothing is asked
        size = _number(missing) if more else f"{_number(missing)} of {_number(asked)}"
        where = TURNS[i - 3] if i >= 3 else FORWARD_PORT_UP[i][int((missing < 0.0) != more)]
        if not more and abs(missing) > abs(asked) and _number(missing) != _number(asked):
            beside = f"{_number(missing - asked)} {unit} made the other way"
            return f"all {_number(asked)} {unit} {where} missing and {beside}"
        if not more and abs(missing) < abs(asked) and _number(missing) == _number(asked):
            size = f"all but {_number(asked - missing)} of {_number(asked)}"
        return f"{size} {unit} {where} {'too much' if more else 'missing'}"

    def _cause(self, thrust: Thrust, scaled: Vector) -> str:
        whole, force = self._share > 0.0, self._force
        low, high = thrust.limits[:, 0] * self._share, thrust.limits[:, 3] * self._share
        full = whole & (((force < 0.0) & (force <= AT_LIMIT * low)) | ((force > 0.0) & (force >= AT_LIMIT * high)))
        names = [name for name, one in zip(thrust.names, full, strict=True) if one]
        names += [name for name, one in zip(thrust.fins, self._fins_at_their_ends(thrust), strict=True) if one]
        if names:
            return f"{listed(names)} at {'its limit' if len(names) == 1 else 'their limits'}"
        if not _make_any(thrust.A[:, whole], thrust.length_m, scaled):
            if _make_any(thrust.per_newton, thrust.length_m, scaled):
                return "only fins make any of it, as much as their servos and the flow let them"
            return f"no thruster that works{' and no fin' * bool(thrust.fins)} makes any of it"
        if np.any(thrust.limits[:, 1] < thrust.limits[:, 2]):
            return "less than the thrusters' dead zones leave"
        return ""

    def _fins_at_their_ends(self, thrust: Thrust) -> Vector:
        wanted, (low, high) = self._wanted[: len(thrust.fins)], thrust.travel.T
        return ((wanted < 0.0) & (wanted <= AT_LIMIT * low)) | ((wanted > 0.0) & (wanted >= AT_LIMIT * high))


def _make_any(A: Matrix, length_m: float, scaled: Vector) -> bool:
    """Whether columns of A (6,n) make any of a wrench (6,) whose torques are divided by a length [m]."""
    columns = SPATIAL.scale(length_m)[:, None] * A
    sizes = np.linalg.norm(columns, axis=0) * np.linalg.norm(scaled)
    return bool(np.any(np.abs(columns.T @ scaled) > OUT_OF_RANGE * sizes))


def _number(value: float) -> str:
    """Its size to two digits."""
    return f"{float(f'{abs(value):.2g}'):g}"


def distance_from_target(rows: TickRows, at: int | slice) -> Any:
    """How far the vehicle is from its target at a tick of the flight, or at many [m]."""
    along, cross = rows.path_error[at, 1], rows.path_error[at, 4]
    return np.sqrt(along * along + cross * cross)


def believed_efficiency(rows: TickRows, k: int) -> Vector:
    """(m,) the efficiencies that are believed at a tick of the flight, a row of its own."""
    m = (rows.health.shape[1] - 2) // 2
    return rows.health[k, 1 + m : 1 + 2 * m].copy()


def listed(names: Sequence[str]) -> str:
    """Names as a sentence has them: ``T1, T2 and T3``."""
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
