"""What the planar law reckons with of the water: the current, known or estimated, and what the model leaves."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from cube_sim.control.planar.current_filter import CurrentFilter
from cube_sim.control.planar.dynamic import Water
from cube_sim.control.planar.model import PlanarCurrent, PlanarModel, PlanarMotion
from cube_sim.control.planar.unexplained import UnexplainedAcceleration
from cube_sim.spatial import Vector


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
        self._model, self._known = model, np.array(current, dtype=float)
        self._filter, self._unexplained = current_filter, unexplained
        self._inertia = np.array([model.m_u, model.m_v, model.m_r])
        self._before: Vector | None = None

    @property
    def current(self) -> Vector:
        """The current reckoned with (2,) [m/s], world axes."""
        return self._known if self._filter is None else self._filter.current

    def update(self, psi_B: float, motion: PlanarMotion, applied: Vector, dt: float) -> Water:
        """What the law is to reckon with after a tick.

        Args:
            psi_B: heading [rad].
            motion: over ground, at the end of the tick.
            applied: force ahead, force to the left and torque (3,) [N, N, N m] over the tick.
            dt: length of the tick [s].
        """
        nu, pushed, current = np.array(motion), applied / self._inertia, self.in_body(psi_B)
        explained = pushed + self._acceleration(motion, current)
        if self._filter is not None and self._before is not None:
            found = (nu - self._before) / dt
            self._filter.update(psi_B, motion.through(current), found - explained, (found, pushed), dt)
        self._before = nu
        if self._unexplained is None:
            return Water(self.in_body(psi_B))
        left = self._unexplained.update(nu, explained, dt)
        return Water(self.in_body(psi_B), *left.tolist())

    def in_body(self, psi_B: float) -> PlanarCurrent:
        """The current in the axes of a hull at heading psi_B [rad]."""
        c, s = cos(psi_B), sin(psi_B)
        x, y = self.current.tolist()
        return PlanarCurrent(c * x + s * y, c * y - s * x)

    def _acceleration(self, motion: PlanarMotion, current: PlanarCurrent) -> Vector:
        """(u', v', r') over ground by the model, without thrusters (3,) [m/s^2, m/s^2, rad/s^2]."""
        model, through = self._model, motion.through(current)
        return np.array(
            [
                motion.r * current.v - model.d_u(through) / model.m_u,
                model.sway_acceleration(through) - motion.r * current.u,
                -model.d_r(through) / model.m_r,
            ]
        )
