"""Legends of plots: every name has room, whatever runs are called."""

from __future__ import annotations

import numpy as np
import pytest

from cube_sim.commands.labels import MOST, labels
from cube_sim.report.drawing import HALF, WIDE, draw
from cube_sim.report.legend import legend_lines, text_width
from cube_sim.report.panel import Curve, Panel, TimeAxis, Zone

TIMES = np.array([0.0, 1.0])


def panel(*names):
    curves = tuple(Curve(name, TIMES, TIMES, "#000", style) for name in names for style in ("solid", "dashed"))
    return Panel("Depth profile: height z", "m", curves, (Zone("dead zone", TIMES, TIMES, TIMES, "#ccc"),))


@pytest.mark.parametrize("count", [1, 3, 12])
@pytest.mark.parametrize("length", [1, 30, 200])
@pytest.mark.parametrize(("taken", "width"), [(0.0, 100.0), (180.0, 456.0), (500.0, 456.0), (180.0, 1004.0)])
def test_every_name_is_in_the_frame_and_no_two_overlap(count, length, taken, width):
    names = [f"{index}{'m' * length}{index}" for index in range(count)]
    lines = legend_lines(panel(*names), taken, width)
    for k, line in enumerate(lines):
        ends = [taken if k == 0 else 0.0, *(entry.x + entry.width for entry in line)]
        assert all(entry.x >= end - 1e-6 for entry, end in zip(line, ends, strict=False))
        assert ends[-1] <= max(width, taken) + 1e-6
        assert all(text_width(entry.label) < entry.width for entry in line)
    said = [entry.label for line in lines for entry in line]
    assert len(said) == count + 1
    assert said[-1] == "dead zone"
    for name, label in zip(names, said, strict=False):
        assert (label[0], label[-1]) == (name[0], name[-1])
        assert label == name or "…" in label


@pytest.mark.parametrize("width", [HALF, WIDE])
def test_a_plot_grows_upwards_by_the_lines_of_its_legend(width):
    axis, heights = TimeAxis(0.0, 1.0), []
    for count in (1, 2, 20):
        svg = draw(panel(*(f"{index} a name of some length" for index in range(count))), axis, width)
        _, top, _, height = map(float, svg.partition('viewBox="')[2].partition('"')[0].split())
        written = [
            float(each.partition('"')[0]) for each in svg.split(' class="l" ')[1:] for each in [each.split('y="')[1]]
        ]
        assert min(written) >= top + 11
        assert max(written) <= 26
        heights.append(height)
    assert heights[0] <= heights[1] < heights[2]


def test_runs_are_called_shortly_and_differently(tmp_path):
    long = "a_folder_of_a_campaign_with_a_long_name_{}_seed_1"
    folders = [tmp_path / "a", tmp_path / long.format(1)]
    for found in (folders, [tmp_path / long.format(k) for k in (1, 2)], [tmp_path / "x", tmp_path / "y" / "x"]):
        for folder in found:
            folder.mkdir(parents=True, exist_ok=True)
        said = labels(found, ["d" * 100, "d" * 100])
        assert said[0] == "a" or found is not folders
        assert len({*said}) == 2
        assert all(len(label) <= MOST + 3 for label in said)
