"""Whether a hull is held at rest beside what is stuck is told by the facets, not by how far a search has come."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY, thruster_event

import cube_sim
from cube_sim.control.authority import Authority
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.control.resting import SHARES, nearest_rest
from cube_sim.wrench.health import Health

NAMES = (
    "cube",
    "cube_as_built",
    "bluerov2_heavy",
    "drawn7_0",
    "drawn7_1",
    "drawn7_3",
    "drawn8_0",
    "drawn8_1",
    "drawn8_2",
)
"""Vehicles that have all six components without any one thruster."""


def vehicle(name, folder):
    model = folder / "model.xml"
    model.write_text(catalogue()[name].make())
    return model, cube_sim.Vehicle.from_model(cube_sim.load_model(str(model)))


def share_needed(A, limits, wrench):
    """The smallest share of their limits (2,k) by which thrusters A (6,k) make a wrench, by linear programming."""
    k = A.shape[1]
    above, below = np.c_[np.eye(k), -limits[1]], np.c_[-np.eye(k), limits[0]]
    found = linprog(
        np.r_[np.zeros(k), 1.0],
        A_ub=np.vstack([above, below]),
        b_ub=np.zeros(2 * k),
        A_eq=np.c_[A, np.zeros(6)],
        b_eq=wrench,
        bounds=[(None, None)] * k + [(0.0, None)],
    )
    return found.x[-1] if found.success else np.inf


@pytest.mark.parametrize("name", NAMES)
def test_an_attitude_that_the_others_hold_is_the_nearest_to_itself(name, tmp_path):
    """Held with nine tenths of their force by linear programming, it is found held, whatever thruster is stuck."""
    _, body = vehicle(name, tmp_path)
    A, limits, hull = body.actuation_matrix, body.thrusters.limits, body.dynamics
    seen = 0
    for stuck in range(A.shape[1]):
        for force in (0.5 * limits[stuck, 0], 0.7 * limits[stuck, 3], limits[stuck, 3]):
            working = np.where(np.arange(A.shape[1]) == stuck, 0.0, 1.0)
            health = Health(working, np.where(working == 0.0, force, np.nan))
            left = remaining_capability(A, limits, health)
            if left.authority is not Authority.HOLONOMIC:
                continue
            budget = left.budget
            still = hull.steady_wrenches(np.zeros((1, 3)), np.eye(3)[2:])[0]
            if share_needed(budget.matrix, budget.limits, still - budget.held) < 0.999 * SHARES[0]:
                rest = nearest_rest(hull.record, budget, 1.0, np.zeros(3), np.eye(3))
                assert rest.held
                assert np.allclose(rest.attitude, np.eye(3))
                seen += 1
    assert seen > 0


@pytest.mark.flight
def test_beside_a_stuck_thruster_it_keeps_its_attitude_where_the_others_suffice(tmp_path):
    """Seven tenths of the others hold it; taken for too weak, they let it turn at 5 rad/s, 8 cm beside its circle."""
    model, _ = vehicle("drawn7_1", tmp_path)
    scenario = {
        "schema_version": 1,
        "name": "stuck",
        "model": str(model),
        "duration_s": 50.0,
        "initial": {"position_m": [5.0, 0.3, -20.0], "attitude_deg": [0.0, 0.0, 90.0]},
        "path": {"type": "circle", "centre_m": [0, 0, -20], "radius_m": 5.0},
        "guidance": {"speed_m_s": 0.35},
        "control": {"faults": "told"},
        "events": [thruster_event(10.0, ["T4"], "stuck", force_N=25.2)],
        "checks": FORCES_ONLY,
    }
    run = cube_sim.fly(scenario, record="none")
    t, error = run.signals["path_error.cross_track"].T
    rates = np.linalg.norm(run.signals["velocity.angular"][:, 1:], axis=1)
    assert error[t > 30.0].max() < 0.01
    assert rates[t > 30.0].max() < 0.3
