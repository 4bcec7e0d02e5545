"""What the thrusters of a mission's vehicle can do, judged once at the start and again as they fail."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from cube_sim.allocation import FaultTolerant
from cube_sim.control.authority import Authority, Capability
from cube_sim.control.badly_pointed import badly_pointed
from cube_sim.control.critical_speed import CriticalSpeed, critical_speed, too_fast
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.loop_times import mean_delay
from cube_sim.control.turning_limit import too_tight
from cube_sim.control.yielding import WaterHold
from cube_sim.guidance.path import Path
from cube_sim.guidance.speed import tightest_radius
from cube_sim.mission.water import fastest_current, initial_currents
from cube_sim.scenario import Scenario
from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.fin_health import FinHealth
from cube_sim.vehicle.fins import FinsAtSpeed
from cube_sim.wrench.health import Health

BACK_M_S = 0.1
"""So fast a vehicle that stays in a place comes back to it, about (a choice)."""
COURSES = 60
"""So many directions of the path are looked at, evenly along it."""
NEED_NO_FINS = (Authority.HOLONOMIC, Authority.TRIM)
"""What thrusters that fly a hull so make at rest too; fins then only spare them power."""


@dataclass(frozen=True)
class Ability:
    """What the vehicle can do while all thrusters work; the answers take up to half a second, so they are kept.

    Attributes:
        A: (6,m) of all thrusters, as the controller believes.
        limits: (m,4) of whole ones, as the allocation keeps them [N].
        hold: what the water holds of the hull.
        speed_m_s: along the path.
        radius_m: of the path's tightest turn; infinite where it has none.
        courses: (n,3) directions of the path, world axes; none at a point.
        fastest_m_s: the largest speed through the water that the path asks for, in the current of the start.
        delay_s: mean delay from state to force: lag of the thrusters and 1.5 control periods.
        cost_limit: `control.cost_limit` [N/N].
        whole: what it can do at any cost that is not `DEAR`.
        within_limit: what it can do within `cost_limit`; `whole` where there is none.
        fins: what the fins do at that speed; None for a vehicle without.
        steered_by: those of them that count while all thrusters work: None where these need no fins.
        critical: the critical speed of `within_limit`, where many flights look at it; None where it is not known yet.
    """

    A: Matrix
    limits: Matrix
    hold: WaterHold
    speed_m_s: float
    radius_m: float
    courses: Matrix
    fastest_m_s: float
    delay_s: float
    cost_limit: float | None
    whole: Capability
    within_limit: Capability
    fins: FinsAtSpeed | None = None
    steered_by: FinsAtSpeed | None = None
    critical: CriticalSpeed | None = None

    @classmethod
    def of(
        cls,
        allocator: FaultTolerant,
        dynamics: Dynamics,
        scenario: Scenario,
        path: Path,
        lag_s: Vector,
        fins: FinsAtSpeed | None = None,
    ) -> Ability:
        """Judge a vehicle.

        Args:
            allocator: over its thrusters.
            dynamics: the equations of motion the controller reckons with.
            scenario: whose speed, current, control period and cost limit count.
            path: whose turns it is asked for.
            lag_s: (m + k,) of its thrusters and of the servos of its fins [s].
            fins: what its k fins do at the scenario's speed.
        """
        A, limits, cost_limit = allocator.A, allocator.limits, scenario.control.cost_limit
        courses = courses_of(path)
        everything, steered_by = Health.whole(A.shape[1]), fins
        alone = WaterHold.of(dynamics, scenario.guidance.speed_m_s if len(courses) else speed_at_a_point(scenario))
        hold = alone if fins is None else with_way_on(alone, scenario.guidance.speed_m_s, courses)
        whole = remaining_capability(*with_fins(A, limits, everything, fins), hold=hold)
        if whole.by_flow and not needs_fins(by_thrusters := remaining_capability(A, limits, everything, hold=alone)):
            steered_by, hold, whole = None, alone, by_thrusters
        judged = with_fins(A, limits, everything, steered_by)
        within = whole if cost_limit is None else remaining_capability(*judged, cost_limit, hold)
        speed, radius = scenario.guidance.speed_m_s, tightest_radius(path)
        delay = mean_delay(lag_s, scenario.control_period_s)
        ability = cls(A, limits, hold, speed, radius, courses, 0.0, delay, cost_limit, whole, within, fins, steered_by)
        return ability.in_currents(initial_currents(scenario))

    def in_currents(self, currents: Matrix) -> Ability:
        """The same in other water, of which currents (n,3) are possible [m/s], world axes."""
        fastest = max(fastest_through_water(self.courses, self.speed_m_s, current) for current in currents)
        return replace(self, fastest_m_s=fastest)

    def left(self, health: Health, known: FinHealth | None = None) -> Capability:
        """What it can do, within the cost limit, with thrusters and fins in the state believed.

        Fins that do not steer count as lost: what a jammed one makes is for the others to make up for, tick by tick.
        One that is short of travel counts with the force that is left of it.

        Args:
            health: of the thrusters.
            known: of the fins; None for whole ones.
        """
        judged = with_fins(self.A, self.limits, health, self.steered_by, known)
        left = remaining_capability(*judged, self.cost_limit, self.hold)
        if self.fins is None or self.steered_by is not None or not needs_fins(left) or self.hold.hull is None:
            return left
        hold = with_way_on(self.hold, self.speed_m_s, self.courses)
        return remaining_capability(*with_fins(self.A, self.limits, health, self.fins, known), self.cost_limit, hold)

    def too_tight(self, left: Capability) -> str | None:
        """Words for turns of the path that are too tight for what is left; None where they are kept."""
        return None if self.hold.hull is None else too_tight(left, self.hold.hull, self.speed_m_s, self.radius_m)

    def badly_pointed(self, left: Capability) -> str | None:
        """Words for a path on which what is left points its thrust well in no attitude; None where it does in one."""
        hull = self.hold.hull
        return None if hull is None or not len(self.courses) else badly_pointed(left, hull, self.speed_m_s)

    def too_fast(self, left: Capability) -> str | None:
        """Words for a speed of the path that is beyond the critical one of what is left; None for one that is not."""
        if self.hold.hull is None:
            return None
        known = self.critical if left is self.within_limit else None
        return too_fast(left, self.hold.hull, self.delay_s, self.fastest_m_s, known)

    def of_many_flights(self) -> Ability:
        """The same, with what each of them would look for again."""
        if self.hold.hull is None:
            return self
        return replace(self, critical=critical_speed(self.within_limit, self.hold.hull, self.delay_s))


def needs_fins(alone: Capability) -> bool:
    """Whether fins count, by what the thrusters can do without: if they hold the hull in a place, they do not.

    A hull that needs none may stop, and go astern: it is not told to keep the way on that fins need.
    """
    return alone.authority not in NEED_NO_FINS


def with_way_on(hold: WaterHold, speed_m_s: float, courses: Matrix) -> WaterHold:
    """What the water holds of a hull that its fins steer at a speed, along courses (n,3), world axes."""
    assert hold.hull is not None
    return WaterHold.of(hold.hull, speed_m_s, inclinations_of(courses))


def with_fins(
    A: Matrix, limits: Matrix, health: Health, fins: FinsAtSpeed | None, known: FinHealth | None = None
) -> tuple[Matrix, Matrix, Health]:
    """Matrix (6,m+k), limits (m+k,4) and health of thrusters and fins.

    Args:
        A: (6,m) of the thrusters.
        limits: (m,4) of them [N].
        health: of them.
        fins: the k fins; None for none.
        known: of them; None for whole ones.
    """
    if fins is None:
        return A, limits, health
    whole, fin_limits = Health.whole(len(fins.limits)), fins.limits
    if known is not None:
        whole.efficiency[~known.steers] = 0.0
        fin_limits = fins.limits_within(known.travel)
    together = Health(*(np.concatenate(pair) for pair in zip(health, whole, strict=True)))
    return np.column_stack([A, fins.matrix]), np.vstack([limits, fin_limits]), together


def courses_of(path: Path) -> Matrix:
    """Directions of a path (n,3), evenly along it, world axes; none at a point."""
    if path.length <= 0.0:
        return np.empty((0, 3))
    return np.array([path.at(s).rotation[:, 0] for s in np.linspace(0.0, path.length, COURSES)])


def inclinations_of(courses: Matrix) -> tuple[float, ...]:
    """The steepest courses (n,3) downwards and upwards, as angles above the horizontal [rad], and the level one."""
    angles = np.arcsin(np.clip(courses[:, 2], -1.0, 1.0))
    ends = float(np.min(angles, initial=0.0)), float(np.max(angles, initial=0.0))
    return tuple(sorted({0.0, *(round(angle, 9) for angle in ends)}))


def speed_at_a_point(scenario: Scenario) -> float:
    """The speed through the water [m/s] at which a vehicle that is to stay in a place is asked what the water holds.

    What it is told to go along a path at does not count there.
    """
    return max(fastest_current(scenario), min(BACK_M_S, scenario.guidance.speed_m_s))


def fastest_through_water(courses: Matrix, speed_m_s: float, current: Vector) -> float:
    """The largest speed through a current (3,) [m/s] on courses (n,3), world axes [m/s]; 0 on none."""
    if not len(courses):
        return 0.0
    return float(np.max(np.linalg.norm(speed_m_s * courses - current, axis=1)))
