"""The share of the speed wanted that is given up for want of torque."""

import pytest

from cube_sim.control.planar.short_of_torque import FALL, LEAST_SHARE, RISE, ShortOfTorque, torque_share


def test_it_falls_while_torque_is_short_and_rises_at_half_that_rate_after():
    short = ShortOfTorque()
    for _ in range(50):
        short.update(2.0, 2.0, 900.0, 400.0, 0.02)
    assert short.share == pytest.approx(1.0 - FALL)
    for _ in range(50):
        short.update(2.0, 2.0, -300.0, -300.0, 0.02)
    assert short.share == pytest.approx(1.0 - FALL + RISE)
    assert pytest.approx(0.5 * FALL) == RISE


def test_it_stays_between_its_least_and_the_whole():
    short = ShortOfTorque()
    short.update(2.0, 2.0, 0.0, 0.0, 100.0)
    assert short.share == 1.0
    short.update(2.0, 2.0, 900.0, 400.0, 100.0)
    assert short.share == LEAST_SHARE


def test_a_hull_that_is_slow_already_gives_up_nothing():
    short = ShortOfTorque()
    short.update(0.4, 2.0, 9000.0, 400.0, 1.0)
    assert short.share == 1.0


def test_the_torque_comes_first_at_speed_and_leaves_half_to_gather_it():
    assert torque_share(-0.5, 1.5) == torque_share(0.75, 1.5) == LEAST_SHARE
    assert torque_share(1.2, 1.5) == pytest.approx(0.8)
    assert torque_share(1.5, 1.5) == torque_share(2.0, 1.5) == 1.0
