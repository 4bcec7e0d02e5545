"""Axes: all numbers are on them, and ticks are where people expect them."""

from __future__ import annotations

import numpy as np
import pytest

from cube_sim.report.markup import number, seconds, text
from cube_sim.report.scale import nice_step, scale_for


@pytest.mark.parametrize(("rough", "nice"), [(1.0, 1.0), (1.1, 2.0), (0.03, 0.05), (6.0, 10.0), (2e-9, 2e-9)])
def test_steps_are_one_two_or_five(rough, nice):
    assert nice_step(rough) == pytest.approx(nice)


@pytest.mark.parametrize(("low", "high"), [(0.0, 120.0), (-39.9, 51.4), (5.0, 5.0), (0.0, 0.0), (-1e-14, 3e-9)])
def test_the_axis_holds_its_numbers_and_some_ticks(low, high):
    scale = scale_for(low, high, 150.0)
    pixels = scale.to_pixels(np.array([low, high]))
    assert 0.0 <= pixels[0] <= pixels[1] <= 150.0
    ticks = [place for place, _ in scale.ticks(5)]
    assert 2 <= len(ticks) <= 6
    assert all(scale.low <= place * (1 + 1e-9) + 1e-30 for place in ticks)


def test_a_logarithmic_axis_has_decades_and_an_end_below():
    scale = scale_for(1e-30, 4.0, 150.0, logarithmic=True)
    assert scale.logarithmic
    assert scale.at(0.0) == scale.at(1e-30) == 0.0
    assert scale.at(1.0) - scale.at(0.1) == pytest.approx(scale.at(0.1) - scale.at(0.01))
    assert {label for _, label in scale.ticks(5)} & {"1", "0.1", "0.01", "0.001", "1e−5"}
    assert not scale_for(-1.0, -0.5, 150.0, logarithmic=True).logarithmic


def test_nothing_to_show_is_an_axis_all_the_same():
    assert scale_for(float("nan"), float("nan"), 100.0).ticks(4)


def test_numbers_for_readers():
    assert [number(x) for x in (None, float("nan"), -0.5, 1e-14, 0.0, -0.0)] == ["–", "–", "−0.5", "1e−14", "0", "0"]
    assert [seconds(x) for x in (62.0, 40.480000000000004, 0.0)] == ["62 s", "40.48 s", "0 s"]
    assert text('<a href="x">&\x00') == "&lt;a href=&quot;x&quot;&gt;&amp;\ufffd"
