"""Path blocks: each kind flies, each mistake is named where it stands."""

from __future__ import annotations

from math import inf
from typing import Literal

import numpy as np
import pytest
from support.scenario_files import MINIMAL, mistakes, write

from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.mission.path import laps_of, make_path, path_of
from cube_sim.scenario import load
from cube_sim.scenario.values import Block

LINE = "{type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}"
SQUARE = "points_m: [[0, 0, -5], [4, 0, -5], [4, 4, -5], [0, 4, -5]]"
KINDS = {
    LINE: 4.0,
    "{type: point, position_m: [1, 2, -5], heading_deg: 30}": 0.0,
    "{type: arc, start_m: [1, 0, 0], through_m: [0, 1, 0], end_m: [-1, 0, 0]}": np.pi,
    "{type: circle, centre_m: [0, 0, 0], radius_m: 2, laps: 3}": 4.0 * np.pi,
    "{type: helix, centre_m: [0, 0, 0], radius_m: 1, pitch_m: 0, turns: 0.5}": np.pi,
    "{type: sinusoid, start_m: [0, 0, 0], amplitude_m: 0, wavelength_m: 4, periods: 2}": 8.0,
    f"{{type: polyline, {SQUARE}, corner_radius_m: 0.5}}": None,
    f"{{type: polyline, {SQUARE}, corner_radius_m: 0.5, closed: true, laps: 2}}": None,
    f"{{type: spline, {SQUARE}}}": None,
    "{type: csv, file: points.csv, closed: true, laps: 1.5}": None,
    "{type: csv, file: points.csv, shape: polyline, corner_radius_m: 0.3}": None,
}
CSV = "station,x_m,y_m,z_m\n# harbour\na,0,0,-5\n\nb,4,0,-5\nc,4,4.5e0,-5\nd,0,4,-6\n"


def scenario(folder, block, csv=CSV):
    (folder / "points.csv").write_bytes(csv if isinstance(csv, bytes) else csv.encode())
    return write(folder, MINIMAL.replace(LINE, block))


@pytest.mark.parametrize("block", KINDS)
def test_every_kind_makes_a_path_and_survives_being_saved(block, tmp_path):
    loaded = load(scenario(tmp_path, block))
    path = path_of(loaded)
    if KINDS[block] is not None:
        assert path.length == pytest.approx(KINDS[block])
    saved = tmp_path / "elsewhere" / "resolved.yaml"
    saved.parent.mkdir()
    saved.write_text(loaded.resolved_yaml())
    again = path_of(load(saved))
    for s in np.linspace(0.0, path.length, 9):
        for mine, theirs in zip(path.at(s), again.at(s), strict=True):
            np.testing.assert_array_equal(mine, theirs)


def test_points_of_a_file_are_read_by_their_columns_names(tmp_path):
    swapped = "z_m, x_m ,y_m\n-5,0,0\n-5,4,0\n-5,4,4.5\n-6,0,4\n"
    block = "{type: csv, file: points.csv}"
    first = path_of(load(scenario(tmp_path, block)))
    second = path_of(load(scenario(tmp_path, block, swapped)))
    np.testing.assert_array_equal(first.at(3.0).position, second.at(3.0).position)
    np.testing.assert_allclose(first.at(first.length).position, [0.0, 4.0, -6.0], atol=1e-12)


def test_laps_are_endless_counted_or_one(tmp_path):
    ring = "{type: circle, centre_m: [0, 0, 0], radius_m: 2, laps: 3}"
    assert laps_of(load(scenario(tmp_path, ring)).scenario.path) == 3.0
    open_path = load(scenario(tmp_path, f"{{type: spline, {SQUARE}}}"))
    path = path_of(open_path)
    target = VirtualTarget(path, 0.5, laps=laps_of(open_path.scenario.path))
    target.advance(1e6, 1.0)
    assert target.arc_length == path.length


WRONG = {
    "{type: polyline, points_m: [[0, 0, 0]], corner_radius_m: 1}": (
        "mission.yaml:5:34: path.points_m: an open path needs 2 or more points, got 1"
    ),
    "{type: polyline, points_m: [[0, 0, 0], [4, 0, 0], [4, 0, 0]], corner_radius_m: 1}": (
        "mission.yaml:5:57: path.points_m.2: point 2 coincides with point 1"
    ),
    "{type: polyline, points_m: [[0, 0, 0], [4, 0, 0], [4, 4, 0]], corner_radius_m: 9}": (
        "mission.yaml:5:46: path.points_m.1: corners of 9 m radius need 15.6 m of the leg from point 0 to point 1, "
        "which is 4 m long: the largest radius that fits is 2.31 m"
    ),
    "{type: spline, points_m: [[0, 0, 0], [4, 0, .nan]]}": (
        "mission.yaml:5:51: path.points_m.1.2: must be finite, got nan"
    ),
    "{type: spline, points_m: [[0, 0, 0], [4, 0, 1]], laps: 2}": (
        "mission.yaml:5:62: path.laps: an open path has no laps: give closed: true"
    ),
    "{type: circle, centre_m: [0, 0, 0], radius_m: 2}": (
        "mission.yaml:8:12: checks.0.kind: a closed path run without end has no end to reach: give path.laps"
    ),
    "{type: circle, centre_m: [0, 0, 0], radius_m: 2, axis: [0, 0, 0], laps: 1}": (
        "mission.yaml:5:62: path.axis: the axis of a circle needs a direction"
    ),
    "{type: arc, start_m: [1, 0, 0], through_m: [2, 0, 0], end_m: [5, 0, 0]}": (
        "mission.yaml:5:50: path.through_m: the three points of the arc lie on a line"
    ),
    "{type: csv, file: points.csv, shape: polyline}": (
        "mission.yaml:5:1: path.corner_radius_m: a polyline needs corner_radius_m, a spline has no corners"
    ),
    "{type: spline, points_m: [[0, 0, 0], [4, 0, 0], [1, 0, 0]]}": (
        "mission.yaml:5:44: path.points_m.1: the path doubles back at point 1"
    ),
    "{type: line, start_m: [0, 0, 0], end_m: [1.0e+200, 0, 0]}": (
        "mission.yaml:5:48: path.end_m.0: must be at most 100000, got 1e+200"
    ),
    "{type: line, start_m: [0, 0, 0], end_m: [1.0e-9, 0, 0]}": (
        "mission.yaml:5:47: path.end_m: a line is 0.01 m long or longer, this one 1e-09 m"
    ),
    "{type: sinusoid, start_m: [0, 0, 0], amplitude_m: 1.0e+6, wavelength_m: 0.02, periods: 1000}": (
        "mission.yaml:5:57: path.amplitude_m: must be at most 100000, got 1000000.0"
    ),
    "{type: sinusoid, start_m: [0, 0, 0], amplitude_m: 100, wavelength_m: 0.02, periods: 1000}": (
        "mission.yaml:5:57: path.amplitude_m: bends with a radius of 1.01e-07 m, which must be 0.01 m or more"
    ),
    "{type: helix, centre_m: [0, 0, 0], radius_m: 9000, pitch_m: 0, turns: 9000}": (
        "mission.yaml:5:7: path: the path would be some 5.09e+08 m long; 0.01 to 1e+06 m make sense"
    ),
    "{type: circle, centre_m: [0, 0, 0], radius_m: 1.0e-3, laps: 1}": (
        "mission.yaml:5:53: path.radius_m: must be at least 0.01, got 0.001"
    ),
    "{type: csv, file: no.csv}": "mission.yaml:5:25: path.file: no such file: {folder}no.csv",
}


@pytest.mark.parametrize("block", WRONG)
def test_a_wrong_path_is_one_line_at_its_place(block, tmp_path):
    assert mistakes(scenario(tmp_path, block)) == [WRONG[block].replace("{folder}", "")]


WRONG_FILES = {
    "": "points.csv is empty; its first row must name the columns x_m, y_m, z_m",
    "x_m,y_m,z_m\n": "points.csv names its columns but holds no points",
    "0,0,0\n1,1,1\n": "points.csv, row 1: no column x_m, y_m, z_m; it has 0, 0, 0",
    "x_m,y_m,depth\n0,0,0\n": "points.csv, row 1: no column z_m; it has x_m, y_m, depth",
    "x_m,y_m,z_m,x_m\n0,0,0,0\n": "points.csv, row 1: column x_m is there twice",
    "x_m,y_m,z_m\n0,0,0\n1,abc,0\n": "points.csv, row 3: column y_m must be a number, got 'abc'",
    "x_m,y_m,z_m\n0,0,0\n\n1,0\n": "points.csv, row 4: column z_m is empty",
    "x_m,y_m,z_m\n0,0,nan\n1,0,0\n": "points.csv, row 2: column z_m must be finite, got nan",
    "x_m,y_m,z_m\n0,0,0\n1,0,0\n1,0,0\n": "points.csv, row 4 coincides with points.csv, row 3",
    "x_m,y_m,z_m\n0,0,0\n4,0,0\n1,0,0\n": "the path doubles back at points.csv, row 3",
    "x_m,y_m,z_m\n0,0,0\n1e300,1,1\n": ("points.csv, row 3 has a coordinate of 1e+300 m; 100000 m at most make sense"),
    b"x_m,y_m,z_m\n0,0,\xff\n": "points.csv is not UTF-8 text",
}


@pytest.mark.parametrize("csv", WRONG_FILES, ids=repr)
def test_a_wrong_file_of_points_is_named_with_row_and_column(csv, tmp_path):
    path = scenario(tmp_path, "{type: csv, file: points.csv}", csv)
    assert mistakes(path) == [f"mission.yaml:5:25: path.file: {WRONG_FILES[csv]}"]


def test_a_new_kind_runs_its_laps_and_is_missed_where_it_is_not_made():
    class LoopBlock(Block):
        type: Literal["loop"] = "loop"
        laps: float | None = None

    assert (laps_of(LoopBlock(laps=3.0)), laps_of(LoopBlock())) == (3.0, inf)
    with pytest.raises(AssertionError, match="LoopBlock"):
        make_path(LoopBlock())
