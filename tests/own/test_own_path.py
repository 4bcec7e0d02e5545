"""A path of the user's own: flown as ours are, and refused where it is none."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.command_line import call
from support.flights import thruster_event
from support.own_code import scenario_with
from support.places import HELIX

import cube_sim
from cube_sim.errors import OwnCodeError, ScenarioError
from cube_sim.guidance.arc import circle
from cube_sim.guidance.line import Line
from cube_sim.guidance.sinusoid import sinusoid
from cube_sim.guidance.tabulation import Piece, tabulate

SHORT = {"duration_s": 2.0, "checks": [{"kind": "allowed_forces"}]}
NAMED = {"type": "sinusoid", "start_m": [0, 0, -8], "amplitude_m": 1.0, "wavelength_m": 12.0, "periods": 1.0}

STRAIGHT = """\
import numpy as np


class Straight:
    length, closed, edges = 4.0, False, (0.0, 4.0)

    def __init__(self, depth=5.0):
        self.depth = depth

    def at(self, s):
        s = min(max(s, 0.0), self.length)
        return np.array([s, 0.0, -self.depth]), np.eye(3), (0.0, 0.0), (0.0, 0.0)
"""


def wave(amplitude=1.0):
    """A sine wave as a function of its abscissa."""
    k, ahead, left = np.pi / 6.0, np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    return tabulate([0, 0, -8], [Piece(lambda x: ahead + np.outer(amplitude * k * np.cos(k * x), left), 12.0)])


def flown(flight):
    """All signals of a flight to its end."""
    while not flight.over:
        flight.step()
    return flight.signals


@pytest.mark.flight
def test_a_path_of_ones_own_is_followed_as_ours_is():
    named = flown(cube_sim.Flight(HELIX, {**SHORT, "path": NAMED}))
    one = sinusoid([0, 0, -8], 1.0, 12.0, 1.0)
    same = flown(cube_sim.Flight(HELIX, SHORT, path=one))
    assert [name for name, rows in named.items() if rows.tobytes() != same[name].tobytes()] == []
    made = flown(cube_sim.Flight(HELIX, SHORT, path=wave))
    np.testing.assert_allclose(made["pose.position"], named["pose.position"], atol=1e-5)
    wider = flown(cube_sim.Flight(HELIX, {**SHORT, "path.options.amplitude": 2.0}, path=wave))
    assert np.abs(wider["pose.position"] - named["pose.position"]).max() > 1e-3


@pytest.mark.flight
def test_a_path_of_a_file_is_recorded_and_reached(tmp_path):
    path = scenario_with(tmp_path, STRAIGHT)
    block = {"type": "python", "python": "own.py:Straight", "options": {"depth": 5.0}}
    ours, own = tmp_path / "ours", tmp_path / "own"
    first = cube_sim.run(path, {"duration_s": 2.0}, ours)
    run = cube_sim.run(path, {"duration_s": 2.0, "path": block}, own)
    for name, rows in first.signals.items():
        np.testing.assert_allclose(run.signals[name], rows, atol=1e-9, err_msg=name)
    again = cube_sim.run(own / "resolved.yaml", out=tmp_path / "again")
    assert all(again.signals[name].tobytes() == rows.tobytes() for name, rows in run.signals.items())


def test_laps_go_with_a_closed_path():
    ring = circle([0, 0, -8], 3.0, [0, 0, 1], 0.0)
    end = {"checks": [{"kind": "path_end", "reach_m": 0.5}]}
    with pytest.raises(ScenarioError, match=r"checks\.0\.kind: a closed path run without end has no end to reach"):
        cube_sim.Flight(HELIX, {**SHORT, **end}, path=ring)
    cube_sim.Flight(HELIX, {**SHORT, **end, "path.laps": 2}, path=ring)
    line = Line([0, 0, -8], [4, 0, -8])
    cube_sim.Flight(HELIX, {**SHORT, **end}, path=line)
    with pytest.raises(ScenarioError, match=r"path\.laps: an open path has no laps"):
        cube_sim.Flight(HELIX, {**SHORT, "path.laps": 2}, path=line)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("class Straight", "class Other"), "own.py has no Straight; it has Other"),
        (("depth=5.0", "deep=5.0"), "own.py:8: NameError"),
        (("def at", "def point"), "own.py:Straight makes a Straight without at; it takes a Path"),
        (("length, closed, edges = 4.0", "length, closed, edges = 'long'"), "answers the length 'long'; it takes"),
        (("(0.0, 4.0)\n", "(0.0, 3.0)\n"), "has its last edge at 3 m, its length is 4 m"),
        (("(0.0, 4.0)\n", "(0.0, 5.0, 4.0)\n"), "these rise from 0 to the length"),
        (("return np.array([s,", "return np.array([2 * s,"), "goes 2 m in a metre at s = 0 m"),
        (("np.eye(3)", "np.eye(3)[[1, 0, 2]]"), "has at s = 0 m a frame that is no rotation"),
        (("np.eye(3)", "2 * np.eye(3)"), "has at s = 0 m a frame that is no rotation"),
        (("np.eye(3)", "np.eye(2)"), "answers at s = 0 m the rotation of shape (2, 2); it takes 3 x 3 numbers"),
        (("(0.0, 0.0), (0.0, 0.0)", "0.0, 0.0"), "answers at s = 0 m the curvature of shape (); it takes 2 numbers"),
        ((", (0.0, 0.0)\n", "\n"), "answers a tuple at s = 0 m; it takes a PathPoint"),
        (("-self.depth", "np.nan * s"), "every number must be finite"),
        (("return np", "1 / (s < 3)\n        return np"), "own.py:12: ZeroDivisionError: division by zero"),
    ],
)
def test_what_is_no_path_is_one_line(change, told, tmp_path, monkeypatch, capsys):
    path = scenario_with(tmp_path, STRAIGHT.replace(*change))
    text = path.read_text()
    block = "path: {type: python, python: 'own.py:Straight'}"
    path.write_text("\n".join(block if line.startswith("path:") else line for line in text.splitlines()))
    code, out, err = call(monkeypatch, capsys, "run", path, "--out", tmp_path / "out", "--quiet")
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert err.startswith(f"{path}:5:30: path.python: "), err
    assert told in err
    assert not (tmp_path / "out").exists()


@pytest.mark.flight
def test_a_path_that_fails_in_flight_ends_it():
    class Broken(Line):
        broken = False

        def at(self, s):
            if self.broken:
                raise RuntimeError(f"lost at {s:g}")
            return super().at(s)

    path = Broken([0, 0, -8], [4, 0, -8])
    flight = cube_sim.Flight(HELIX, SHORT, path=path)
    flight.step()
    path.broken = True
    with pytest.raises(OwnCodeError, match=r"path: test_own_path.py:\d+: RuntimeError: lost at 0"):
        flight.step()
    assert flight.ended.startswith("path: test_own_path.py:")


def trefoil(size=1.0):
    """A knot that closes."""

    def derivative(u):
        return size * np.stack([np.cos(u) + 4 * np.cos(2 * u), 4 * np.sin(2 * u) - np.sin(u), -3 * np.cos(3 * u)], 1)

    return tabulate([0, -size, -8], [Piece(derivative, 2.0 * np.pi)], closed=True)


@pytest.mark.flight
@pytest.mark.parametrize(("path", "more"), [(wave, {}), (trefoil, {"path.laps": 1}), (trefoil(0.5), {"path.laps": 2})])
def test_both_loops_follow_a_table_the_same(path, more, monkeypatch):
    settings = {**SHORT, "duration_s": 6.0, "events": [thruster_event(3.0, ["T3"])], **more}
    assert assert_same_flight(HELIX, settings, monkeypatch, path=path) > 0.8
