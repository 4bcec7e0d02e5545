"""What a balanced attitude takes for more than there is: what the thrusters are to make counts, not all asked for."""

from __future__ import annotations

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue

from cube_sim import Vehicle, load_model
from cube_sim.control.attitude_mode import Situation
from cube_sim.control.authority import Authority
from cube_sim.control.balanced_attitude import BalancedAttitude
from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.wrench.health import Health

UPRIGHT = FixedAttitude(np.array([1.0, 0.0, 0.0, 0.0]))


@pytest.fixture(scope="module")
def dear_sideways(tmp_path_factory):
    """Six thrusters whose push to the side costs 169 N/N: no way of moving, but a thin side of what is attainable."""
    path = tmp_path_factory.mktemp("drawn") / "drawn6_3.xml"
    path.write_text(catalogue()["drawn6_3"].make())
    return Vehicle.from_model(load_model(path))


@pytest.mark.parametrize(("force", "short"), [([19.0, 3.0, 1.0], False), ([250.0, 0.0, 1.0], True)])
def test_a_force_that_is_balanced_and_not_made_is_no_shortage(dear_sideways, force, short):
    A, limits = dear_sideways.actuation_matrix, dear_sideways.thrusters.limits
    left = remaining_capability(A, limits, Health.whole(6))
    assert left.authority is Authority.PLANE
    excess = left.budget.normals @ np.array([*force, 0.0, 0.0, 0.0]) - left.budget.bounds
    assert excess.max() > 0.0
    law = BalancedAttitude(left, dear_sideways.dynamics, np.eye(3), 0.5, UPRIGHT)
    law.attitude(Situation(None, np.eye(3), np.array(force), np.zeros(3), np.zeros(3), left.effort), 0.02)
    assert law.short is short
