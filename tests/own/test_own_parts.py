"""An attitude and a motion law of the user's own, under cube_sim's control law and under one's own."""

from __future__ import annotations

import numpy as np
import pytest
from support.command_line import call
from support.own_code import PID, scenario_with

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.spatial import quaternion_from_euler

HEADING = 0.5

PARTS = """\
import numpy as np


def heading(setup, rad=0.5):
    return lambda situation, dt: (2.0 * np.cos(rad / 2), 0.0, 0.0, 2.0 * np.sin(rad / 2))


class Turning:
    def __init__(self, setup, rate=0.3):
        self.rate, self.angle = rate, 0.0

    def attitude(self, situation, dt):
        self.angle += self.rate * dt
        return [np.cos(self.angle / 2), 0.0, 0.0, np.sin(self.angle / 2)], [0.0, 0.0, self.rate]


def towards(setup, time=2.0):
    speed = setup.scenario.guidance.speed_m_s
    return lambda view: view.point.rotation @ (np.array([speed, 0.0, 0.0]) - view.error / time)
"""


def flown(path, **changes):
    """All signals of a scenario with changes, to its end."""
    flight = cube_sim.Flight(path, {key.replace("__", "."): value for key, value in changes.items()})
    while not flight.over:
        flight.step()
    assert not flight.ended
    return flight.signals


@pytest.mark.flight
def test_an_attitude_of_ones_own_is_the_fixed_one_it_names(tmp_path):
    path = scenario_with(tmp_path, PARTS)
    own = {"mode": "python", "python": "own.py:heading", "options": {"rad": HEADING}}
    fixed = {"mode": "fixed", "attitude_deg": [0.0, 0.0, float(np.degrees(HEADING))]}
    one = flown(path, control__attitude=own, duration_s=4.0)
    other = flown(path, control__attitude=fixed, duration_s=4.0)
    for name in other:
        np.testing.assert_allclose(one[name], other[name], atol=1e-6, err_msg=name)
    wanted = one["reference.quaternion"][-1, 1:]
    np.testing.assert_allclose(wanted, quaternion_from_euler(0.0, 0.0, HEADING), atol=1e-12)
    assert one["path_error.attitude"][-1, 1] < 0.02


@pytest.mark.flight
def test_an_attitude_that_turns_is_followed_and_saved(tmp_path):
    path = scenario_with(tmp_path, PARTS)
    changes = {"control.attitude": {"mode": "python", "python": "own.py:Turning"}, "duration_s": 5.0}
    flight = cube_sim.Flight(path, changes)
    while flight.time_s < 3.0:
        flight.step()
    middle = flight.snapshot()
    while not flight.over:
        flight.step()
    signals = flight.signals
    assert signals["path_error.attitude"][-1, 1] < 0.05
    assert signals["velocity.angular"][-1, 3] == pytest.approx(0.3, abs=0.03)
    other = cube_sim.Flight(path, changes)
    other.restore(middle)
    while not other.over:
        other.step()
    assert other.signals["wrench.demanded"].tobytes() == signals["wrench.demanded"][150:].tobytes()


@pytest.mark.flight
@pytest.mark.parametrize("law", [None, {"python": "pid.py:pid"}])
def test_a_motion_law_of_ones_own_brings_the_vehicle_to_the_path(law, tmp_path):
    (tmp_path / "pid.py").write_text(PID)
    path = scenario_with(tmp_path, PARTS)
    start = {"initial__position_m": [0.0, 0.5, -5.0], "duration_s": 8.0, "control__law": law}
    signals = flown(path, guidance__law={"python": "own.py:towards", "options": {"time": 2.0}}, **start)
    across = signals["path_error.cross_track"]
    assert across[0, 1] == pytest.approx(0.5)
    assert across[-1, 1] < 0.02
    wanted = signals["reference.linear"][0, 1:]
    np.testing.assert_allclose(wanted, [0.4, -0.25, 0.0], atol=1e-9)


@pytest.mark.parametrize(
    ("source", "key", "told"),
    [
        ("def make(setup): return lambda s, dt: [1, 0, 0]", "control.attitude", "answers a quaternion of shape (3,)"),
        ("def make(setup): return lambda s, dt: [0, 0, 0, 0]", "control.attitude", "a quaternion without a direction"),
        (
            "def make(setup): return lambda s, dt: ([1, 0, 0, 0], [1])",
            "control.attitude",
            "angular velocity of shape",
        ),
        ("def make(setup): return lambda s: 1", "control.attitude", "own.py:make: TypeError: make.<locals>.<lambda>()"),
        (
            "def make(setup): return 3",
            "control.attitude",
            "a int; it takes a function, or an object with attitude",
        ),
        ("def make(setup): return lambda view: [1, 0]", "guidance.law", "answers a velocity of shape (); it takes 3"),
        ("def make(setup): return lambda view: view.nose", "guidance.law", "own.py:1: AttributeError: "),
        ("def make(setup): return {}", "guidance.law", "makes a dict; it takes a function, or an object with motion"),
    ],
)
def test_what_is_no_part_is_one_line(source, key, told, tmp_path, monkeypatch, capsys):
    path = scenario_with(tmp_path, source, control="{attitude: {mode: python, python: 'own.py:make'}}")
    if key == "guidance.law":
        text = path.read_text().replace("{speed_m_s: 0.4}", "{speed_m_s: 0.4, law: {python: 'own.py:make'}}")
        path.write_text(text[: text.index("control:")])
    code, out, err = call(monkeypatch, capsys, "run", path, "--out", tmp_path / "out", "--quiet")
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert f": {key}.python: " in err
    assert told in err


def test_the_planar_law_has_its_own_way(tmp_path):
    path = scenario_with(tmp_path, PARTS)
    with pytest.raises(ScenarioError, match=r"guidance\.law.*a planar law follows paths"):
        cube_sim.Flight(path, {"control.law": "planar_lapierre_2007", "guidance.law": {"python": "own.py:towards"}})
