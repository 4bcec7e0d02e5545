"""What the planar law reckons with of the water: the current, known or estimated, and what the model leaves."""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

import numpy as np

from cube_sim.control.planar.current_filter import FILTER, FILTERED, CurrentFilter, filter_current
from cube_sim.control.planar.dynamic import Water
from cube_sim.control.planar.model import (
    PlanarCurrent,
    PlanarModel,
    PlanarMotion,
    surge_resistance,
    sway_acceleration,
    through,
    yaw_resistance,
)
from cube_sim.control.planar.unexplained import UNEXPLAINED, UnexplainedAcceleration, observe_unexplained
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record, Vector

SETTINGS = np.dtype([("filters", np.bool_), ("unexplained_time", np.float64)])
"""Whether the current is estimated, and the time of what the model leaves [s], 0 for none."""
BEFORE = np.dtype([("started", np.bool_), ("nu", np.float64, 3)])
"""Whether there was a tick before, and (u, v, r) at it."""


class ObserverParts(NamedTuple):
    """What a tick of the observer reads and moves on.

    Attributes:
        settings: record `SETTINGS`.
        hull: record of `cube_sim.control.planar.model.HULL`.
        filter: record of `cube_sim.control.planar.current_filter.FILTER`; read where the current is estimated.
        filtered: memory of it, moved on where it is; its current is the one reckoned with in any case.
        unexplained: memory of `observe_unexplained`, moved on where there is a time.
        before: record `BEFORE`, moved on.
    """

    settings: Record
    hull: Record
    filter: Record
    filtered: Record
    unexplained: Record
    before: Record


class PlanarObserver:
    """Compares how the hull moves over ground with equation (2), tick by tick.

    Two estimates of one difference: slowly, the current that would explain it; quickly, whatever is left of it.

    Args:
        model: the controller's knowledge of the hull.
        current: what is known of the current (2,) [m/s], world axes.
        current_filter: estimates it; None to keep what is known.
        unexplained: estimates what the model leaves; None to take it to be nothing.
    """

    def __init__(
        self,
        model: PlanarModel,
        current: Vector,
        current_filter: CurrentFilter | None,
        unexplained: UnexplainedAcceleration | None,
    ) -> None:
        known = np.zeros(1, FILTERED)
        known["current"] = current
        time = 0.0 if unexplained is None else unexplained.time
        self.parts = ObserverParts(
            settings=np.array([(current_filter is not None, time)], SETTINGS),
            hull=model.record,
            filter=np.zeros(1, FILTER) if current_filter is None else current_filter.parameters,
            filtered=known if current_filter is None else current_filter.memory,
            unexplained=np.zeros(1, UNEXPLAINED) if unexplained is None else unexplained.memory,
            before=np.zeros(1, BEFORE),
        )

    def expect(self, other: PlanarObserver) -> None:
        """Look for the current as another observer of the same hull would, from what is known by now."""
        self.parts = self.parts._replace(filter=other.parts.filter)

    @property
    def current(self) -> Vector:
        """The current reckoned with (2,) [m/s], world axes."""
        return self.parts.filtered["current"][0].copy()

    def update(self, psi_B: float, motion: PlanarMotion, applied: Vector, dt: float) -> Water:
        """What the law is to reckon with after a tick, see `observe_water`."""
        return observe_water(self.parts, psi_B, motion, *applied.tolist(), dt)

    def in_body(self, psi_B: float) -> PlanarCurrent:
        """The current in the axes of a hull at heading psi_B [rad]."""
        return in_body(self.current, psi_B)


@compiled
def in_body(current, psi_B):
    """The `PlanarCurrent` of a current (2,) [m/s], world axes, in the axes of a hull at heading psi_B [rad]."""
    c, s = cos(psi_B), sin(psi_B)
    return PlanarCurrent(c * current[0] + s * current[1], c * current[1] - s * current[0])


@compiled
def observe_water(parts, psi_B, motion, F, side, Gamma, dt):
    """The `Water` that the law is to reckon with after a tick.

    Args:
        parts: `ObserverParts`.
        psi_B: heading [rad].
        motion: `PlanarMotion` over ground, at the end of the tick.
        F: force ahead over the tick [N].
        side: force to the left over the tick [N].
        Gamma: torque over the tick [N m].
        dt: length of the tick [s].
    """
    p, s, hull, nu, before = parts, parts.settings[0], parts.hull[0], motion, parts.before[0]
    current = in_body(p.filtered[0].current, psi_B)
    relative = through(motion, current)
    pushed = F / hull.m_u, side / hull.m_v, Gamma / hull.m_r
    explained = (
        pushed[0] + (motion.r * current.v - surge_resistance(hull, relative) / hull.m_u),
        pushed[1] + (sway_acceleration(hull, relative) - motion.r * current.u),
        pushed[2] - yaw_resistance(hull, relative) / hull.m_r,
    )
    if s.filters and before.started:
        moved = (nu.u - before.nu[0]) / dt, (nu.v - before.nu[1]) / dt, (nu.r - before.nu[2]) / dt
        left = moved[0] - explained[0], moved[1] - explained[1], moved[2] - explained[2]
        filter_current(p.filter, p.filtered, hull, psi_B, relative, left, moved, pushed, dt)
    before.started = True
    before.nu[0], before.nu[1], before.nu[2] = nu.u, nu.v, nu.r
    current = in_body(p.filtered[0].current, psi_B)
    if s.unexplained_time == 0.0:
        return Water(current, 0.0, 0.0, 0.0)
    observe_unexplained(s.unexplained_time, p.unexplained, (nu.u, nu.v, nu.r), explained, dt)
    w = p.unexplained[0].w
    return Water(current, w[0], w[1], w[2])
