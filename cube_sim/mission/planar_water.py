"""What the planar law knows of the water, and how it learns the rest."""

from __future__ import annotations

import numpy as np

from cube_sim.control.planar.current_filter import CurrentFilter
from cube_sim.control.planar.model import PlanarModel
from cube_sim.control.planar.observer import PlanarObserver
from cube_sim.control.planar.unexplained import UnexplainedAcceleration
from cube_sim.scenario import Scenario

LARGEST = 0.75
"""Share of the speed wanted beyond which no current is looked for."""


def planar_observer(scenario: Scenario, knowledge: PlanarModel, speed: float) -> PlanarObserver:
    """The observer of a scenario; without `control.disturbance_time_s` it reckons with what is known and no more.

    The three poles of `UnexplainedAcceleration` settle within 5 % in the same time as one at twice their time constant,
    which is how `disturbance_time_s` is meant.

    Args:
        scenario: whose control and knowledge blocks say how.
        knowledge: the controller's model of the hull.
        speed: lowest one wanted [m/s]; see `LARGEST`.
    """
    known = np.array(scenario.knowledge.current_m_s[:2])
    time, flow = scenario.control.disturbance_time_s, scenario.control.current_time_s
    if time is None:
        return PlanarObserver(knowledge, known, None, None)
    bound = max(LARGEST * speed, float(np.hypot(*known)))
    current_filter = None if flow is None else CurrentFilter(knowledge, flow, known, speed, bound)
    return PlanarObserver(knowledge, known, current_filter, UnexplainedAcceleration(0.5 * time))
