"""Energy that thrusters put into a drift that they fight, where the attitude has to point them: bounded by the turn."""

from __future__ import annotations

import pytest
from closed_loop.condition import NOMINAL
from closed_loop.drift import pointed_drift
from closed_loop.flown_loop import FlownLoop
from closed_loop.linear_loop import SETTLED, linearised
from closed_loop.survey import STEERED, THIRDS, speed_of
from flights.forecast import forecast
from support.catalogue.vehicles import catalogue

from cube_sim.errors import ScenarioError

NONE = 1e-6
"""Share of the force that carries the hull away, or of what it does, which counts as none."""
PUSHED_BY_TURNING = ("torpedo", "bluerov2_vectored-T1T2", "jack-T1T2")
PUSHED_BY_NOTHING = ("four_astern_verticals_abeam", "four_all_astern", "cube-T1T3T5T7")


def drifts(name, share, folder):
    """Whether turning pushes a vehicle, and its drifts along three axes; None where it is not flown so."""
    entry = catalogue()[name]
    speed = speed_of(entry, share)
    if not speed:
        return None
    try:
        flown = FlownLoop(entry, speed, NOMINAL, folder)
    except (TypeError, ScenarioError):
        return None  # the planar law
    if flown.authority not in STEERED:
        return None
    asked = {"lost": entry.lost, "weak": {}, "stuck": {}, "speed_m_s": speed, "planar": entry.planar}
    if not forecast(folder / "model.xml", **asked).flies:
        return None
    loop = linearised(flown)
    if loop.drift > SETTLED or loop.spectral_radius >= 1.0:
        return None
    return flown.controller.dragged, [pointed_drift(flown, loop, axis) for axis in range(3)]


def assert_bounded(pushed, found):
    for drift in found:
        assert drift.put_in <= drift.most_put_in + NONE
        if not pushed:
            assert drift.helped < NONE
            assert drift.put_in < NONE


@pytest.mark.flight
@pytest.mark.parametrize("name", PUSHED_BY_NOTHING)
def test_where_turning_does_not_push_a_hull_its_thrusters_never_help_a_drift(name, tmp_path):
    pushed, found = drifts(name, THIRDS[3], tmp_path)
    assert not pushed
    assert_bounded(pushed, found)
    assert min(drift.work for drift in found) < -0.5


@pytest.mark.flight
@pytest.mark.parametrize("name", PUSHED_BY_TURNING)
def test_where_it_does_they_put_in_no_more_than_the_impulse_of_the_turn_times_the_speed_of_the_drift(name, tmp_path):
    pushed, found = drifts(name, THIRDS[3], tmp_path)
    assert pushed
    assert_bounded(pushed, found)
    worst = max(found, key=lambda drift: drift.put_in)
    assert 0.005 < worst.put_in < 0.5  # it does happen
    assert worst.most_put_in < 20.0 * worst.put_in  # and the bound is near
    assert all(drift.work < 0.0 for drift in found)  # in all they take out more


@pytest.mark.campaign
@pytest.mark.parametrize("name", list(catalogue()))
def test_so_it_is_of_every_vehicle_that_points_its_thrust(name, tmp_path):
    for share in THIRDS[1:]:
        folder = tmp_path / f"{share:.2f}"
        folder.mkdir()
        if (found := drifts(name, share, folder)) is not None:
            assert_bounded(*found)
