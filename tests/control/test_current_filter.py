"""The filter that reads the current out of how a hull moves over ground."""

import numpy as np
import pytest
from support.planar_flight import INFANTE, acceleration, in_body

from cube_sim.control.planar.current_filter import USUAL_CURRENT, CurrentFilter
from cube_sim.control.planar.model import PlanarModel, PlanarMotion
from cube_sim.control.planar.observer import PlanarObserver
from cube_sim.control.planar.unexplained import UnexplainedAcceleration

CURRENT = np.array([-0.1, 0.25])


def drift(torque, seconds, believed=INFANTE, current=CURRENT, known=(0.0, 0.0), bound=1.5):
    """The observer along a hull that runs ahead under one force and a torque (t) -> [N m], from 10 Hz."""
    observer = PlanarObserver(
        believed,
        np.array(known),
        CurrentFilter(believed, 5.0, np.array(known), 1.5, bound),
        UnexplainedAcceleration(0.5),
    )
    psi, nu, dt, track = 0.4, np.array([1.5, 0.0, 0.0]), 0.05, []
    for k in range(round(seconds / dt)):
        F, Gamma = 80.0, torque(k * dt)
        for _ in range(5):
            nu = nu + dt / 5 * acceleration(PlanarMotion(*nu), in_body(current, psi), F, Gamma)
            psi += dt / 5 * nu[2]
        observer.update(psi, PlanarMotion(*nu), np.array([F, 0.0, Gamma]), dt)
        track.append(observer.current)
    return np.array(track)


def test_turning_it_finds_the_current():
    found = drift(lambda t: 60.0, 60.0)
    assert np.hypot(*(found[-1] - CURRENT)) < 0.02


def test_on_a_straight_line_it_finds_what_crosses_the_hull():
    found = drift(lambda t: 0.0, 60.0, current=np.array([0.0, 0.3]))
    across = np.array([-np.sin(0.4), np.cos(0.4)])
    assert (found[-1] - [0.0, 0.3]) @ across == pytest.approx(0.0, abs=0.04)


def test_a_wrong_drag_turns_with_the_hull_and_is_told_apart_by_it():
    fields = {name: 1.3 * getattr(INFANTE, name) for name in ("D_uu", "D_vv", "D_uv", "K_rr", "K_vv", "K_ur")}
    wrong: PlanarModel = INFANTE._replace(**fields)
    found = drift(lambda t: 60.0, 150.0, believed=wrong)
    assert np.hypot(*(found[-600:].mean(axis=0) - CURRENT)) < 0.05


def test_still_water_is_left_still_and_a_known_current_kept():
    np.testing.assert_allclose(drift(lambda t: 60.0, 20.0, current=np.zeros(2))[-1], 0.0, atol=5e-3)
    np.testing.assert_allclose(drift(lambda t: 60.0, 20.0, known=CURRENT)[-1], CURRENT, atol=5e-3)


def test_the_estimate_keeps_within_its_bound():
    found = drift(lambda t: 60.0, 40.0, current=np.array([0.0, 0.6]), bound=0.2)
    speeds = np.hypot(*found.T)
    assert speeds.max() == pytest.approx(0.2)
    assert found[-1, 1] > 0.15


def test_with_nothing_to_see_it_expects_what_it_expected_at_first():
    """At rest in the water no current shows; what was learnt fades, the spread never grows beyond the first one."""
    known = np.array([0.1, 0.0])
    current_filter = CurrentFilter(INFANTE, 5.0, known, 1.5, 1.0)
    for _ in range(200):
        current_filter.update(0.0, PlanarMotion(0.0, 0.0, 0.0), np.ones(3), (np.zeros(3), np.zeros(3)), 1.0)
    assert current_filter.current == pytest.approx(known)
    assert current_filter.spread == pytest.approx([USUAL_CURRENT, USUAL_CURRENT])
