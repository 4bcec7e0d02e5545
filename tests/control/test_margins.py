"""The whole loop, linearised about steady motion: margins, and that the tool which reads them off is right."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest
from closed_loop.condition import NOMINAL, Condition
from closed_loop.flown_loop import NOTHING, FlownLoop
from closed_loop.linear_loop import linearised
from closed_loop.stability import all_margins, frequencies, margins_of, one_by_one, responses
from closed_loop.survey import BEYOND, THIRDS, surveyed
from support.catalogue.drawn import drawn_layout
from support.catalogue.mjcf import mjcf
from support.catalogue.vehicles import Entry, catalogue

GAIN_DB, PHASE_DEG = 6.0, 40.0
OURS = ("cube", "cube_as_built", "bluerov2_heavy")
WHOLE = [name for name, entry in catalogue().items() if not entry.lost and not re.fullmatch(r"drawn\d_[1-9]", name)]
"""Of the drawn layouts one for each number of thrusters; the campaign looks at all of them, at every speed."""
UNSEEN = [(3, 31), (4, 32), (5, 33), (6, 34), (8, 35)]
"""Thrusters and seeds of drawn layouts that the catalogue does not have."""
LESS = {"cube_as_built-T1T2T3": 5.5}
"""Its gain margin [dB]: two of its axes are left to the water."""
UNSTEADY = ("bluerov2_heavy-T1T2T3", "eight_on_a_ball-T1T2", "rexrov-T5T8")
"""At some speed they are not stable, or no steady motion is found about which to look."""
ALL_WRONG = Condition(drag=0.7, added_mass=1.3, thrust=1.3, believed=(0.5, 0.0, 0.0))


def misses(rows):
    """Of the rows looked at, and not beyond the critical speed, those with less than they ought to have."""
    looked_at = [row for row in rows if row.why in ("", "no steady motion") and not row.beyond]
    return [
        row
        for row in looked_at
        if not row.stable or row.gain_db < LESS.get(row.vehicle, GAIN_DB) or row.phase_deg < PHASE_DEG
    ]


@cache
def cube_loop(tmp):
    return linearised(FlownLoop(catalogue()["cube"], 0.4, NOMINAL, tmp))


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    return cube_loop(tmp_path_factory.mktemp("cube"))


@pytest.mark.flight
@pytest.mark.parametrize("name", WHOLE)
def test_a_vehicle_keeps_its_margins_up_to_its_critical_speed(name):
    assert not misses(surveyed(catalogue()[name], THIRDS[3], [NOMINAL]))


@pytest.mark.flight
@pytest.mark.parametrize(("thrusters", "seed"), UNSEEN)
def test_so_does_one_that_nobody_has_looked_at(thrusters, seed):
    name = f"unseen{thrusters}_{seed}"
    assert not misses(surveyed(Entry(name, lambda: mjcf(name, drawn_layout(seed, thrusters))), THIRDS[3], [NOMINAL]))


@pytest.mark.flight
@pytest.mark.parametrize("name", ["bluerov2_vectored", "drawn6_0", "drawn7_0"])
def test_beyond_it_there_is_less(name):
    """Or the speed would not be critical: held by the water (two), and by thrusters that lag."""
    (row,) = surveyed(catalogue()[name], BEYOND, [NOMINAL])
    assert row.beyond
    assert not row.stable or row.gain_db < GAIN_DB


@pytest.mark.flight
@pytest.mark.parametrize("share", THIRDS[1:])
def test_one_whose_heading_points_its_thrust_does_so_slowly_enough(share):
    """With heading and force asked for 2.5 times as quickly it had 7 to 39 degrees, or was not stable."""
    assert not misses(surveyed(catalogue()["jack-T1T2"], share, [NOMINAL]))


@pytest.mark.flight
@pytest.mark.parametrize("share", THIRDS)
@pytest.mark.parametrize("name", OURS)
def test_our_vehicles_keep_them_when_they_know_themselves_wrongly(name, share):
    rows = surveyed(catalogue()[name], share, [NOMINAL, Condition(thrust=0.7), ALL_WRONG])
    assert len(rows) == 3
    assert not misses(rows)


@pytest.mark.campaign
@pytest.mark.parametrize("name", [name for name in catalogue() if name not in UNSTEADY])
def test_every_vehicle_keeps_them_at_every_speed(name):
    assert not misses([row for share in THIRDS for row in surveyed(catalogue()[name], share, [NOMINAL])])


@pytest.mark.flight
@pytest.mark.parametrize("believed", [None, (0.5, 0.0, 0.0), (0.0, -0.5, 0.0), (0.0, 0.0, 0.5)])
def test_no_thruster_helps_a_force_that_carries_the_hull_away(believed):
    """Whatever current is believed: none of its share of the damping is turned into a push."""
    rows = surveyed(catalogue()["bluerov2_heavy"], 0.0, [Condition(drag=1.3, believed=believed)])
    assert rows[0].helped == pytest.approx(0.0, abs=1e-9)


@pytest.mark.flight
def test_the_linear_loop_is_the_loop_for_small_steps(tmp_path):
    flown = FlownLoop(catalogue()["bluerov2_heavy"], 0.3, NOMINAL, tmp_path)
    linear = linearised(flown)
    point, rng = linear.point, np.random.default_rng(3)
    step = 1e-6 * rng.normal(size=len(linear.closed))
    now, expected = point.moved(step), step
    for _ in range(25):
        now, expected = flown.tick(now, NOTHING)[0], linear.closed @ expected
    rest = point
    for _ in range(25):
        rest = flown.tick(rest, NOTHING)[0]
    np.testing.assert_allclose(now.step_from(rest), expected, atol=1e-3 * np.abs(expected).max())


@pytest.mark.flight
@pytest.mark.parametrize("axis", range(6))
def test_at_its_gain_margin_a_loop_is_at_the_edge_of_stability(loop, axis):
    """By the eigenvalues, which know nothing of Nyquist's curve."""
    margins = all_margins(loop)[axis]
    edge = margins.more
    assert 1.0 < edge < np.inf
    row = np.eye(6)[axis]

    def radius(gain):
        more = (gain - 1.0) * np.outer(loop.push[:, axis], row @ loop.demand)
        return np.abs(np.linalg.eigvals(loop.closed + more)).max()

    assert radius(0.97 * edge) < 1.0 < radius(1.03 * edge)


@pytest.mark.flight
def test_one_loop_with_the_others_closed_is_the_loop_with_only_that_one_open(loop):
    at = frequencies(loop)[::50]
    alone = one_by_one(responses(loop, at))
    for axis in range(6):
        opened = loop.closed - np.outer(loop.push[:, axis], loop.demand[axis])
        for w, expected in zip(at, alone[:, axis], strict=True):
            z = np.exp(1j * w * loop.period)
            found = -loop.demand[axis] @ np.linalg.solve(z * np.eye(len(opened)) - opened, loop.push[:, axis])
            assert found == pytest.approx(expected, rel=1e-5)


def test_margins_of_an_integrator_with_a_delay_are_those_of_the_textbook():
    """L = k exp(-j w d) / (j w): phase margin 90 deg - k d, gain margin pi / (2 k d)."""
    k, d = 2.0, 0.1
    at = np.geomspace(1e-3, 100.0, 2000)
    margins = margins_of(k * np.exp(-1j * at * d) / (1j * at), at)
    assert margins.phase_deg == pytest.approx(90.0 - np.degrees(k * d), abs=0.1)
    assert margins.more == pytest.approx(np.pi / (2.0 * k * d), rel=1e-3)
    assert margins.at_rad_s == pytest.approx(k, rel=1e-3)
