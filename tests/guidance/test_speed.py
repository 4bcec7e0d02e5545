"""Speed profiles: their bounds, that no faster one obeys them, and their derivative."""

from itertools import pairwise

import numpy as np
import pytest

from cube_sim.guidance.approach import Approach
from cube_sim.guidance.arc import circle
from cube_sim.guidance.line import Line
from cube_sim.guidance.polyline import polyline
from cube_sim.guidance.sinusoid import sinusoid
from cube_sim.guidance.speed import ConstantSpeed, PlannedSpeed
from cube_sim.guidance.spline import spline
from cube_sim.guidance.virtual_target import VirtualTarget

TOP, LATERAL, ALONG = 0.8, 0.1, 0.05
CORNERS = [[0.0, 0.0, 0.0], [12.0, 0.0, 0.0], [12.0, 12.0, -1.0], [0.0, 12.0, 3.0]]
PATHS = {
    "polyline": polyline(CORNERS, 1.0),
    "closed polyline": polyline(CORNERS, 1.0, closed=True),
    "sinusoid": sinusoid([0.0, 0.0, 0.0], 2.0, 15.0, 2.0),
}


@pytest.fixture(params=PATHS.values(), ids=PATHS.keys())
def path(request):
    return request.param


def test_it_keeps_all_three_bounds_everywhere(path):
    profile = PlannedSpeed(path, TOP, LATERAL, ALONG)
    for s in np.linspace(0.0, path.length * (2.0 if path.closed else 1.0), 4001):
        value, slope = profile.at(s)
        assert 0.0 < value <= TOP * (1.0 + 1e-12)
        assert value**2 * np.hypot(*path.at(s).curvature) <= LATERAL * (1.0 + 1e-3)
        assert abs(value * slope) <= ALONG * (1.0 + 1e-9)


def test_a_change_of_curvature_counts_by_the_turning_length(path):
    profile, length = PlannedSpeed(path, TOP, LATERAL, ALONG, turning_length=3.0), 3.0
    shares = []
    for s in np.linspace(0.0, path.length, 2001):
        point = path.at(s)
        counts = np.hypot(*point.curvature) + length * np.hypot(*point.curvature_rate)
        shares.append(profile.at(s).value ** 2 * counts / LATERAL)
    assert 0.9 < max(shares) < 1.02
    assert profile.least < 0.9 * PlannedSpeed(path, TOP, LATERAL, ALONG).least


def test_it_slows_down_and_is_nowhere_slower_than_it_must(path):
    """Everywhere the speed is held down by the top speed, by the curvature, or by braking for a place that is."""
    profile = PlannedSpeed(path, TOP, LATERAL, ALONG)
    stations = np.linspace(0.0, path.length, 801)[1:-1]
    values = np.array([profile.at(s) for s in stations])
    at_top = values[:, 0] > 0.999 * TOP
    bound = np.array([LATERAL / max(np.hypot(*path.at(s).curvature), 1e-9) for s in stations])
    in_curve = values[:, 0] ** 2 > 0.9 * bound  # a grid step's change of curvature away from it
    braking = np.abs(values[:, 0] * values[:, 1]) > 0.999 * ALONG
    valley = ~(at_top | in_curve | braking)
    assert np.count_nonzero(valley) <= 0.01 * len(stations)
    assert at_top.any()
    assert values[:, 0].min() < 0.7 * TOP


def test_the_slope_is_the_derivative(path):
    profile = PlannedSpeed(path, TOP, LATERAL, ALONG)
    h = 1e-7
    agree = 0
    for s in np.linspace(0.1, path.length - 0.1, 201) + 1e-3:
        rate = (profile.at(s + h).value - profile.at(s - h).value) / (2.0 * h)
        agree += abs(rate - profile.at(s).slope) < 1e-6
    assert agree >= 199  # the few others straddle a grid point, where the slope may jump


@pytest.mark.parametrize("leg", [50.0, 5000.0, 90_000.0])
@pytest.mark.parametrize("closed", [False, True])
def test_no_corner_is_missed_between_legs_of_any_length(leg, closed):
    path = polyline([[0.0, 0.0, 0.0], [leg, 0.0, 0.0], [leg, leg, 0.0], [0.0, leg, 0.0]], 1.0, closed)
    profile = PlannedSpeed(path, TOP, LATERAL, ALONG)
    slowest = np.sqrt(LATERAL * 1.0)
    assert profile.least == pytest.approx(slowest, rel=1e-3)
    for first, last in pairwise(path.edges):
        for s in np.linspace(first, last, 41):
            assert profile.at(s).value ** 2 * np.hypot(*path.at(s).curvature) <= LATERAL * (1.0 + 1e-3)
    # it brakes on the last metres of a leg, and not before
    corner = next(s for s in path.edges[1:] if np.hypot(*path.at(s).curvature) > 1e-3)
    braking = (TOP**2 - slowest**2) / (2.0 * ALONG)
    assert profile.at(corner - braking - 1.0) == (TOP, 0.0)
    assert profile.at(corner).value < 0.9 * TOP
    assert len(profile.parts[1]) < 2500  # and its size does not grow with the legs


def test_a_profile_of_splines_bends_keeps_the_bound_between_the_places_looked_at():
    path = spline(np.cumsum(np.random.default_rng(0).normal([1.5, 0.0, 0.0], 1.0, (30, 3)), axis=0))
    profile = PlannedSpeed(path, TOP, LATERAL, ALONG)
    for s in np.linspace(0.0, path.length, 20_001):
        assert profile.at(s).value ** 2 * np.hypot(*path.at(s).curvature) <= LATERAL * (1.0 + 1e-3)


def test_straight_on_it_is_the_constant_speed_and_on_a_circle_the_one_that_circle_allows():
    line = PlannedSpeed(Line([0, 0, 0], [10, 0, 0]), TOP, LATERAL, ALONG)
    assert [line.at(s) for s in (-1.0, 0.0, 3.0, 10.0, 11.0)] == [ConstantSpeed(TOP).at(0.0)] * 5
    ring = PlannedSpeed(circle([0, 0, 0], 2.0), TOP, LATERAL, ALONG)
    assert ring.at(1.0).value == pytest.approx(np.sqrt(LATERAL * 2.0))
    assert ring.at(1e4).value == ring.at(-7.0).value == ring.at(0.0).value


def test_the_acceleration_of_the_approach_includes_the_profile(path):
    """By finite differences along the motion, as for a constant speed."""
    law = Approach(PlannedSpeed(path, TOP, LATERAL, ALONG), 1.0, 0.5, stop_time=2.0)
    rng = np.random.default_rng(4)
    h, agree, n = 1e-7, 0, 120
    for _ in range(n):
        s = rng.uniform(0.05, 0.9) * path.length
        position, velocity = path.at(s).position + rng.normal(0.0, 2.0, 3), rng.normal(0.0, 0.4, 3)
        speed = VirtualTarget(path, 0.5, arc_length=s).view(position, velocity).speed

        def motion(t, s=s, position=position, velocity=velocity, speed=speed):
            target = VirtualTarget(path, 0.5, arc_length=s + speed * t)
            return law.motion(target.view(position + velocity * t, velocity))

        rate = (motion(h).velocity - motion(-h).velocity) / (2.0 * h)
        agree += np.abs(motion(0.0).acceleration - rate).max() < 1e-5
    assert agree >= n - 2


def test_without_a_stop_the_vehicle_runs_on_and_with_one_it_rests_at_the_end():
    line = Line([0.0, 0.0, 0.0], [4.0, 0.0, 0.0])
    for stop_time, final in ((2.0, 4.0), (None, 0.4 * 60.0)):
        law, target = Approach(ConstantSpeed(0.4), 1.0, 0.5, stop_time), VirtualTarget(line, 0.5)
        position = np.zeros(3)
        for _ in range(3000):
            view = target.view(position, np.array([0.4, 0.0, 0.0]))
            position = position + 0.02 * law.motion(view).velocity
            target.advance(view.speed, 0.02)
        assert position[0] == pytest.approx(final, abs=0.01)


def test_a_slower_vehicle_stops_and_closes_in_no_less_than_its_time():
    line, time = Line([0.0, 0.0, 0.0], [4.0, 0.0, 0.0]), 5.0
    law = Approach(ConstantSpeed(0.4), 1.0, 0.5, stop_time=2.0)
    for slower in (law.no_faster_than(time), law.no_faster_than(time).no_faster_than(0.1)):
        braking = slower.motion(VirtualTarget(line, 0.5, arc_length=3.0).view(np.array([3.0, 0.0, 0.0]), np.zeros(3)))
        assert braking.velocity[0] == pytest.approx(1.0 / time)
        beside = slower.motion(VirtualTarget(line, 0.5, arc_length=1.0).view(np.array([1.0, 1e-6, 0.0]), np.zeros(3)))
        assert beside.velocity[1] == pytest.approx(-1e-6 / time)
    endless = Approach(ConstantSpeed(0.4), 1.0, 0.5, None).no_faster_than(time)
    there = endless.motion(VirtualTarget(line, 0.5, arc_length=4.0).view(np.array([4.0, 0.0, 0.0]), np.zeros(3)))
    assert there.velocity[0] == pytest.approx(0.4)


def test_the_target_runs_laps_and_ends_after_the_last():
    ring = circle([0.0, 0.0, 0.0], 1.0)
    endless, counted = VirtualTarget(ring, 0.5), VirtualTarget(ring, 0.5, laps=2.5)
    for target in (endless, counted):
        target.advance(100.0, 1.0)
    assert endless.arc_length == 100.0
    assert counted.arc_length == 2.5 * ring.length
    assert endless.view(np.zeros(3), np.zeros(3)).remaining == np.inf
    assert counted.view(np.zeros(3), np.zeros(3)).remaining == 0.0
    endless.advance(-300.0, 1.0)
    assert endless.arc_length == -200.0
    here = endless.view(ring.at(-200.0).position, np.zeros(3))
    np.testing.assert_allclose(here.error, 0.0, atol=1e-12)
